//! Harmonics that leave the range of colours.

use trapeze_cpu::project::MAX_CHANNEL;
use trapeze_scene::{FrameSettings, SH_C0, ShDegree};
use trapeze_tests::{
    Splat, assert_agrees, camera_at_origin, cloud, cloud_camera, everything, scene_of,
};

const CENTRE: usize = 16 * 33 + 16;

/// The colour at the centre of one opaque splat, divided by its alpha.
fn shown(dc: [f32; 3]) -> [f64; 3] {
    let scene = scene_of(&[Splat { dc, logit: 20.0, ..Splat::default() }]);
    let frame = assert_agrees(&scene, &camera_at_origin(33, 33), &everything());
    let [r, g, b, a] = frame.color[CENTRE].map(f64::from);
    [r / a, g / a, b / a]
}

#[test]
fn negative_colours_are_black_and_bright_ones_stay_bright() {
    assert_eq!(shown([-1e3, -2.0, f32::MIN]), [0.0; 3]);
    let [r, g, b] = shown([100.0, 1e4, 0.0]);
    for (found, dc) in [(r, 100.0), (g, 1e4), (b, 0.0)] {
        let exact = 0.5 + SH_C0 * dc;
        assert!((found / exact - 1.0).abs() < 1e-5, "{found} {exact}");
    }
}

#[test]
fn coefficients_that_are_not_finite_end_at_black_or_the_largest_value() {
    let max = f64::from(MAX_CHANNEL);
    let [r, g, b] = shown([f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
    assert_eq!((r, b), (0.0, 0.0));
    assert!((g / max - 1.0).abs() < 1e-5, "{g}");
    let [r, _, _] = shown([f32::MAX, 0.0, 0.0]);
    assert!((r / max - 1.0).abs() < 1e-5, "{r}");
}

#[test]
fn every_band_may_hold_what_is_not_a_number() {
    let poison = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38, -3e38, 1e-42];
    for degree in [ShDegree::One, ShDegree::Two, ShDegree::Three] {
        let mut scene = cloud(400, degree, 13);
        let stride = scene.splats.sh_rest_stride();
        for (i, rest) in scene.splats.sh_rest.chunks_exact_mut(stride).enumerate() {
            if i % 3 == 0 {
                rest[i * 7 % stride] = poison[i / 3 % poison.len()];
            }
        }
        for max_sh_degree in ShDegree::ALL {
            let settings = FrameSettings { max_sh_degree, ..everything() };
            let _ = assert_agrees(&scene, &cloud_camera(64, 48), &settings);
        }
    }
}

#[test]
fn the_brightest_splats_stacked_do_not_overflow() {
    let splats = vec![Splat { dc: [f32::INFINITY; 3], logit: -2.0, ..Splat::default() }; 2000];
    let frame = assert_agrees(&scene_of(&splats), &camera_at_origin(33, 33), &everything());
    // Weights sum to alpha ≤ 1, so nothing is brighter than one splat may be.
    assert!(frame.color.iter().flatten().all(|&c| c <= MAX_CHANNEL * 1.0001));
}
