//! Quaternions of no, any and absurd length.

use trapeze_scene::FrameSettings;
use trapeze_tests::{
    GRADIENT_TOLERANCE, Splat, assert_finite_gradients, assert_gradients_agree, camera_at_origin,
    gradients, scene_of,
};

fn splat(rotation: [f32; 4]) -> Splat {
    Splat { rotation, log_scale: [-1.2, -2.0, -2.6], ..Splat::default() }
}

#[test]
fn quaternions_without_direction_or_of_vanishing_length_get_no_gradient() {
    for rotation in [
        [0.0; 4],
        [f32::NAN, 0.0, 0.0, 1.0],
        [f32::INFINITY, 1.0, 0.0, 0.0],
        [1e-20, 2e-20, 0.0, 1e-20],
        [1e-42, 0.0, 0.0, 1e-42],
    ] {
        let scene = scene_of(&[splat(rotation)]);
        for found in gradients(&scene, &camera_at_origin(40, 30), &FrameSettings::default()) {
            assert_finite_gradients(&found);
            assert_eq!(found.rotations[0], [0.0; 4], "{rotation:?}");
            assert!(found.log_scales[0][0] != 0.0);
        }
    }
}

#[test]
fn the_gradient_falls_with_the_length_and_is_across_the_quaternion() {
    for length in [1e-6, 1.0, 1e6, 1e18] {
        let rotation = [0.5, 0.3, -0.7, 0.2].map(|c: f32| c * length);
        let scene = scene_of(&[splat(rotation)]);
        let settings = FrameSettings::default();
        let camera = camera_at_origin(40, 30);
        for found in assert_gradients_agree(&scene, &camera, &settings, GRADIENT_TOLERANCE) {
            let along: f64 =
                (0..4).map(|c| f64::from(found.rotations[0][c]) * f64::from(rotation[c])).sum();
            let size: f64 =
                (0..4).map(|c| f64::from(found.rotations[0][c]).powi(2)).sum::<f64>().sqrt();
            assert!(along.abs() <= 1e-5 * size * f64::from(length), "{along} {size}");
        }
    }
}
