//! Opacities at and beyond every limit.

use trapeze_scene::FrameSettings;
use trapeze_tests::{
    GRADIENT_TOLERANCE, Splat, assert_finite_gradients, assert_gradients_agree, camera_at_origin,
    gradients, scene_of,
};

#[test]
fn saturated_opacities_have_no_gradient_and_nan_is_not_drawn() {
    for logit in [1e4, -1e4, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        let scene = scene_of(&[
            Splat { logit, position: [0.1, 0.0, 1.8], ..Splat::default() },
            Splat::default(),
        ]);
        for found in gradients(&scene, &camera_at_origin(40, 30), &FrameSettings::default()) {
            assert_finite_gradients(&found);
            assert_eq!(found.opacity_logits[0], 0.0, "{logit}");
        }
    }
}

#[test]
fn where_alpha_is_clamped_it_is_a_constant() {
    // One pixel in the middle of a splat of opacity 0.9999: α = 0.99 there.
    let splat = Splat { logit: 9.2, log_scale: [2.0; 3], ..Splat::default() };
    let scene = scene_of(&[splat]);
    for found in gradients(&scene, &camera_at_origin(1, 1), &FrameSettings::default()) {
        assert_eq!((found.opacity_logits[0], found.positions[0]), (0.0, [0.0; 3]));
        assert!(found.sh_dc[0].iter().all(|&g| g != 0.0));
    }
}

#[test]
fn stacks_of_opaque_splats_divide_by_what_the_clamp_leaves() {
    let splats: Vec<Splat> = (0u8..60)
        .map(|i| Splat {
            position: [0.002 * f32::from(i), 0.0, 2.0 + 0.01 * f32::from(i)],
            logit: f32::from(i % 12) - 3.0,
            ..Splat::default()
        })
        .collect();
    let settings = FrameSettings::default();
    let camera = camera_at_origin(64, 48);
    assert_gradients_agree(&scene_of(&splats), &camera, &settings, GRADIENT_TOLERANCE);
}
