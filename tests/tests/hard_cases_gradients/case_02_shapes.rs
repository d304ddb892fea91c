//! Needles, discs without thickness, extreme scales, a splat that covers the screen.

use trapeze_scene::FrameSettings;
use trapeze_tests::{
    GRADIENT_TOLERANCE, Random, Splat, assert_finite_gradients, assert_gradients_agree,
    camera_at_origin, gradients, scene_of,
};

#[test]
fn needles_follow_the_specification_within_their_condition() {
    // 1 : 10⁶, 72 px per unit at depth 1. Gradients of the shape go through Σ'⁻¹, which is known to
    // ε·cond Σ' = ε·(m² + 0.3) / 0.3 for a length of m px, and some twenty roundings on the way.
    let camera = camera_at_origin(96, 72);
    let mut random = Random::new(3);
    for _ in 0..20 {
        let depth = random.between(1.0, 4.0);
        let splat = Splat {
            position: [random.signed() * 0.2, random.signed() * 0.2, depth],
            log_scale: [0.5f32.ln(), -14.5, -14.5],
            rotation: random.vector(1.0),
            logit: random.between(-2.0, 2.0),
            ..Splat::default()
        };
        let length = 36.0 / f64::from(depth);
        let tolerance = 40.0 * f64::from(f32::EPSILON) * (length * length / 0.3 + 1.0);
        assert_gradients_agree(&scene_of(&[splat]), &camera, &FrameSettings::default(), tolerance);
    }
}

#[test]
fn a_disc_without_thickness_has_gradients_and_its_missing_axis_has_none() {
    let disc = Splat {
        log_scale: [-1.5, -2.0, -200.0],
        rotation: [0.9, 0.2, -0.3, 0.1],
        ..Splat::default()
    };
    let scene = scene_of(&[disc, Splat { position: [0.1, 0.1, 2.5], ..Splat::default() }]);
    let settings = FrameSettings::default();
    let found =
        assert_gradients_agree(&scene, &camera_at_origin(64, 48), &settings, GRADIENT_TOLERANCE);
    for found in found {
        assert_eq!(found.log_scales[0][2], 0.0);
        assert!(found.log_scales[0][0] != 0.0);
    }
}

#[test]
fn log_scales_of_forty_give_finite_gradients() {
    for log_scale in [-40.0, 20.0, 40.0, 88.0] {
        for axes in [[log_scale; 3], [log_scale, -3.0, -3.0], [-2.0, -2.0, log_scale]] {
            let splat = Splat { log_scale: axes, ..Splat::default() };
            let behind = Splat { position: [0.1, 0.0, 3.0], ..Splat::default() };
            let scene = scene_of(&[splat, behind]);
            let camera = camera_at_origin(48, 36);
            let all = gradients(&scene, &camera, &FrameSettings::default());
            all.iter().for_each(assert_finite_gradients);
        }
    }
}

#[test]
fn a_splat_that_covers_the_screen_follows_the_specification() {
    let wide =
        Splat { log_scale: [5.0, 5.0, -4.0], position: [0.3, -0.2, 2.0], ..Splat::default() };
    let scene = scene_of(&[wide, Splat { position: [0.1, 0.1, 2.5], ..Splat::default() }]);
    // Its α is nearly constant: the gradient by its shape is 10⁻⁶ of that by its opacity, a sum of
    // terms of both signs over all pixels.
    assert_gradients_agree(&scene, &camera_at_origin(64, 48), &FrameSettings::default(), 1e-3);
}
