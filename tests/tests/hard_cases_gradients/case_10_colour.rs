//! Harmonics that drive colours out of range.

use trapeze_scene::{FrameSettings, ShDegree};
use trapeze_tests::{
    GRADIENT_TOLERANCE, Splat, assert_finite_gradients, assert_gradients_agree, camera_at_origin,
    cloud, cloud_camera, gradients, scene_of,
};

#[test]
fn channels_below_zero_have_no_gradient() {
    let scene = scene_of(&[Splat { dc: [-4.0, 0.5, -1e30], ..Splat::default() }]);
    let settings = FrameSettings::default();
    let found =
        assert_gradients_agree(&scene, &camera_at_origin(32, 24), &settings, GRADIENT_TOLERANCE);
    for found in found {
        assert_eq!((found.sh_dc[0][0], found.sh_dc[0][2]), (0.0, 0.0));
        assert!(found.sh_dc[0][1] != 0.0);
    }
}

#[test]
fn bright_harmonics_follow_the_specification() {
    let mut scene = cloud(60, ShDegree::Three, 8);
    for c in &mut scene.splats.sh_rest {
        *c *= 300.0;
    }
    let settings = FrameSettings::default();
    assert_gradients_agree(&scene, &cloud_camera(48, 36), &settings, GRADIENT_TOLERANCE);
}

#[test]
fn coefficients_that_are_no_numbers_leave_all_other_gradients_finite() {
    let mut scene = cloud(60, ShDegree::One, 8);
    scene.splats.sh_rest[5] = f32::NAN;
    scene.splats.sh_rest[20] = f32::INFINITY;
    scene.splats.sh_dc[7] = [f32::NEG_INFINITY, f32::NAN, f32::INFINITY];
    let all = gradients(&scene, &cloud_camera(48, 36), &FrameSettings::default());
    all.iter().for_each(assert_finite_gradients);
}
