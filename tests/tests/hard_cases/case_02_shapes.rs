//! Needles, discs without thickness, extreme scales, a splat that covers the screen.

use trapeze_tests::{
    Random, Splat, TOLERANCE, assert_agrees, assert_agrees_within, camera_at_origin, everything,
    rounding_bound, scene_of,
};

/// A needle 10 units long and 10⁻⁵ thick: 1 : 10⁶.
const NEEDLE: [f32; 3] = [std::f32::consts::LN_10, -11.512_925, -11.512_925];

/// Quaternion of a turn by `angle` about a unit axis.
fn turn([x, y, z]: [f32; 3], angle: f32) -> [f32; 4] {
    let (sin, cos) = (angle / 2.0).sin_cos();
    [cos, sin * x, sin * y, sin * z]
}

#[test]
fn needles_across_the_view_agree_with_the_reference_at_every_angle() {
    // The needle is 240 px per unit · 10 units long (one σ), 0.55 px thick after the low-pass.
    // Over a 160-pixel image the terms of U d reach 160 / 0.55 ≈ 300 and cancel down to at most
    // 3.3: an absolute error of about 4 · 2⁻²⁴ · 300 = 7e-5 in U d, 5e-5 in α.
    let camera = camera_at_origin(160, 120);
    for step in 0..24 {
        let splat = Splat {
            position: [0.03, -0.02, 0.5],
            log_scale: NEEDLE,
            rotation: turn([0.0, 0.0, 1.0], step as f32 * std::f32::consts::PI / 24.0),
            logit: 3.0,
            ..Splat::default()
        };
        let frame = assert_agrees_within(2e-4, &scene_of(&[splat]), &camera, &everything());
        let seen = frame.top_contributor.iter().filter(|&&top| top == 0).count();
        // From edge to edge, a few pixels wide.
        assert!((100..1200).contains(&seen), "step {step}: {seen} pixels");
    }
}

#[test]
fn needles_in_all_directions_agree_within_their_condition() {
    // Needles that point at the camera are foreshortened from 2400 px to a few: their width on the
    // image is known to ε · 2400 px only, which `rounding_bound` compares with the 0.55 px of the
    // low-pass.
    let camera = camera_at_origin(96, 72);
    let mut random = Random::new(3);
    for _ in 0..40 {
        let splat = Splat {
            position: [random.signed() * 0.2, random.signed() * 0.2, random.between(0.4, 4.0)],
            log_scale: NEEDLE,
            rotation: random.vector(1.0),
            logit: random.between(-2.0, 4.0),
            ..Splat::default()
        };
        let scene = scene_of(&[splat]);
        let bound = rounding_bound(&scene, &camera, &everything());
        assert!(bound < 0.05, "the comparison would say little: {bound}");
        let _ = assert_agrees_within(bound.max(TOLERANCE), &scene, &camera, &everything());
    }
}

#[test]
fn a_disc_without_thickness_is_drawn_from_the_front_and_edge_on() {
    let camera = camera_at_origin(80, 60);
    let disc = Splat {
        log_scale: [0.4f32.ln(), 0.4f32.ln(), f32::NEG_INFINITY],
        logit: 3.0,
        ..Splat::default()
    };
    let front = assert_agrees(&scene_of(&[disc]), &camera, &everything());
    let edge_on = Splat { rotation: turn([1.0, 0.0, 0.0], std::f32::consts::FRAC_PI_2), ..disc };
    let edge = assert_agrees(&scene_of(&[edge_on]), &camera, &everything());
    let area = |frame: &trapeze_scene::Frame| frame.color.iter().filter(|c| c[3] > 0.0).count();
    assert!(
        area(&front) > 1000 && (1..400).contains(&area(&edge)),
        "{} {}",
        area(&front),
        area(&edge)
    );
}

#[test]
fn a_splat_without_any_extent_is_a_dot_of_the_low_pass() {
    let point = Splat { log_scale: [f32::NEG_INFINITY; 3], logit: 20.0, ..Splat::default() };
    let frame = assert_agrees(&scene_of(&[point]), &camera_at_origin(31, 31), &everything());
    // The centre (15.5, 15.5) is a pixel centre; one pixel further α is exp(−1 / 0.6).
    let alpha = |x: usize, y: usize| f64::from(frame.color[y * 31 + x][3]);
    assert!((alpha(15, 15) - 0.99).abs() < 1e-6);
    assert!((alpha(16, 15) - (-1.0f64 / 0.6).exp()).abs() < 1e-5);
}

#[test]
fn log_scales_of_plus_and_minus_40_in_any_mix_stay_finite() {
    let camera = camera_at_origin(48, 36);
    for mask in 0..27 {
        let log_scale = [mask % 3, mask / 3 % 3, mask / 9].map(|m| [-40.0, -2.0, 40.0][m]);
        let splat = Splat { log_scale, rotation: [0.9, 0.3, -0.2, 0.4], ..Splat::default() };
        let scene = scene_of(&[splat, Splat { position: [0.3, 0.1, 3.0], ..Splat::default() }]);
        // e⁴⁰ is limited to 10¹², which seen from 2 units is 10¹³ px: next to a scale of e⁻²,
        // f32 does not know the direction of such an ellipse's axes. Agreement is asked for where
        // the axes' rounding leaves the image alone.
        let bound = rounding_bound(&scene, &camera, &everything());
        let _ = assert_agrees_within(bound.max(TOLERANCE), &scene, &camera, &everything());
    }
}

#[test]
fn an_even_splat_of_any_size_keeps_its_opacity() {
    for log_scale in [5.0, 20.0, 40.0, 80.0, f32::INFINITY] {
        let splat = Splat { log_scale: [log_scale; 3], ..Splat::default() };
        let frame = assert_agrees(&scene_of(&[splat]), &camera_at_origin(64, 48), &everything());
        assert!(frame.color.iter().all(|c| (c[3] - 0.5).abs() < 1e-3), "{log_scale}");
    }
}
