//! Splats at the near plane, and outside the frustum with extents inside it.

use trapeze_scene::FrameSettings;
use trapeze_tests::{
    GRADIENT_TOLERANCE, Splat, assert_gradients_agree, camera_at_origin, scene_of,
};

#[test]
fn splats_at_and_behind_the_near_plane_get_no_gradient() {
    let at = |z: f32| Splat { position: [0.001, 0.0, z], log_scale: [-6.0; 3], ..Splat::default() };
    let scene = scene_of(&[at(0.01), at(0.0), at(-1.0), at(0.011), at(2.0)]);
    let settings = FrameSettings::default();
    let found =
        assert_gradients_agree(&scene, &camera_at_origin(40, 30), &settings, GRADIENT_TOLERANCE);
    for found in found {
        for i in 0..3 {
            assert_eq!(found.positions[i], [0.0; 3]);
            assert_eq!(found.opacity_logits[i], 0.0);
        }
        assert!(found.opacity_logits[3] != 0.0);
    }
}

#[test]
fn splats_with_centres_far_outside_the_frustum_follow_the_clamped_jacobian() {
    let splats: Vec<Splat> =
        [[4.0, 0.1, 2.0], [-0.2, 6.0, 1.5], [-9.0, -7.0, 2.0], [0.1, 0.2, 3.0]]
            .map(|position| Splat { position, log_scale: [1.0, 0.7, 0.4], ..Splat::default() })
            .to_vec();
    // Far out, a centre is known to 10⁻⁷ of 1 000 px: a few digits less than for centres inside.
    let settings = FrameSettings::default();
    assert_gradients_agree(&scene_of(&splats), &camera_at_origin(64, 48), &settings, 1e-3);
}
