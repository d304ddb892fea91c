//! Extreme opacities, and stacks of splats on one pixel.

use trapeze_cpu::reference::{ALPHA_MAX, TRANSMITTANCE_MIN};
use trapeze_scene::NO_SPLAT;
use trapeze_tests::{Splat, assert_agrees, camera_at_origin, everything, scene_of};

/// Centre of the 33 × 33 images used here.
const CENTRE: usize = 16 * 33 + 16;

/// Logit of an opacity.
fn logit(opacity: f64) -> f32 {
    (opacity / (1.0 - opacity)).ln() as f32
}

#[test]
fn extreme_logits_saturate_and_nan_is_invisible() {
    let camera = camera_at_origin(33, 33);
    for (logit, alpha) in [
        (1e4, ALPHA_MAX),
        (f32::INFINITY, ALPHA_MAX),
        (f32::MAX, ALPHA_MAX),
        (-1e4, 0.0),
        (f32::NEG_INFINITY, 0.0),
        (f32::NAN, 0.0),
        (f32::from_bits(1), 0.5),
    ] {
        let scene = scene_of(&[Splat { logit, ..Splat::default() }]);
        let frame = assert_agrees(&scene, &camera, &everything());
        let found = f64::from(frame.color[CENTRE][3]);
        assert!((found - alpha).abs() < 1e-6, "logit {logit}: alpha {found}");
    }
}

#[test]
fn alpha_is_clamped_at_099_over_the_whole_opaque_core() {
    // o = 1, σ = 6.6 px: α ≥ 0.99 within σ √(2 ln(1/0.99)) = 0.94 px of the centre.
    let splat = Splat { log_scale: [0.4f32.ln(); 3], logit: 30.0, ..Splat::default() };
    let frame = assert_agrees(&scene_of(&[splat]), &camera_at_origin(33, 33), &everything());
    let largest = frame.color.iter().fold(0.0f32, |m, c| m.max(c[3]));
    assert!((largest - 0.99).abs() < 1e-6, "{largest}");
}

#[test]
fn opacity_just_below_and_above_one_255th() {
    let camera = camera_at_origin(33, 33);
    for (opacity, visible) in [(1.0 / 255.0 * 0.999, false), (1.0 / 255.0 * 1.001, true)] {
        let scene = scene_of(&[Splat { logit: logit(opacity), ..Splat::default() }]);
        let frame = assert_agrees(&scene, &camera, &everything());
        assert_eq!(frame.top_contributor[CENTRE] != NO_SPLAT, visible, "opacity {opacity}");
    }
}

/// `n` splats one behind the other, each covering the image.
fn stack(n: usize, opacity: f64) -> Vec<Splat> {
    (0..n)
        .map(|i| Splat {
            position: [0.0, 0.0, 2.0 + i as f32 * 1e-3],
            log_scale: [2.0f32.ln(); 3],
            logit: logit(opacity),
            dc: [(i % 7) as f32 * 0.2, (i % 5) as f32 * 0.3, 0.5],
            ..Splat::default()
        })
        .collect()
}

#[test]
fn ten_thousand_stacked_splats_end_before_transmittance_does() {
    let camera = camera_at_origin(33, 33);
    // From barely visible to opaque: 2300 layers, 90, 13 and 1 use the transmittance up.
    for opacity in [0.004, 0.1, 0.5, 0.999_9] {
        let frame = assert_agrees(&scene_of(&stack(10_000, opacity)), &camera, &everything());
        for color in &frame.color {
            let transmittance = 1.0 - f64::from(color[3]);
            // 1 − α rounds to a multiple of 2⁻²⁴.
            assert!(transmittance > TRANSMITTANCE_MIN - 6e-8, "{opacity}: {color:?}");
        }
    }
}

#[test]
fn ten_thousand_identical_opaque_splats_show_the_first() {
    let splats = vec![Splat { logit: 1e4, ..Splat::default() }; 10_000];
    let frame = assert_agrees(&scene_of(&splats), &camera_at_origin(33, 33), &everything());
    assert_eq!(frame.top_contributor[CENTRE], 0);
    assert_eq!(frame.median_depth[CENTRE], 2.0);
}

#[test]
fn the_blend_that_would_reach_the_threshold_is_left_out() {
    // T = 1 → 0.01 → 2e-4; one more layer of 0.99 would leave 2e-6, so the third is not made.
    let layer = |i: u16, opacity: f64| Splat {
        position: [0.0, 0.0, 2.0 + f32::from(i)],
        log_scale: [20.0f32.ln(); 3],
        logit: logit(opacity),
        dc: [-1.772_453_9, -1.772_453_9, if i == 2 { 100.0 } else { -1.772_453_9 }],
        ..Splat::default()
    };
    let scene = scene_of(&[layer(0, 0.99), layer(1, 0.98), layer(2, 0.99)]);
    let frame = assert_agrees(&scene, &camera_at_origin(33, 33), &everything());
    let [_, _, blue, alpha] = frame.color[CENTRE];
    assert!(blue < 1e-6, "the layer behind is not seen: {blue}");
    assert!((alpha - 0.9998).abs() < 1e-5, "{alpha}");
}
