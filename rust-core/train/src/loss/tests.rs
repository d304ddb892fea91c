//! The fast loss against its specification, and the specification against finite differences.

use fearless_simd::Level;
use proptest::prelude::*;

use super::reference::reference_loss;
use super::{Channels, ImageLoss, LossValue, TargetImage};
use crate::random::{Purpose, Stream, uniform};

const SSIM_WEIGHT: f32 = 0.2;

/// A view to compare: the render, the target and the background.
#[derive(Debug)]
struct Case {
    render: Vec<[f32; 4]>,
    target: TargetImage,
    background: [f32; 3],
}

impl Case {
    fn random(seed: u64, (width, height): (u32, u32), channels: Channels, masked: bool) -> Self {
        let stream = Stream::new(seed, Purpose::Initialisation, 0);
        let pixels = width * height;
        let byte = |i: u32| (stream.words(i)[0] >> 24) as u8;
        let count = pixels * channels as u32;
        let mut target =
            TargetImage::new(width, height, channels, (0..count).map(byte).collect()).unwrap();
        if masked {
            let mask = (0..pixels).map(|i| byte(count + i).saturating_mul(2)).collect();
            target = target.with_mask(mask).unwrap();
        }
        let render = (0..pixels)
            .map(|i| {
                let [r, g, b, a] = stream.more_words(i, 1).map(uniform);
                [r * a, g * a, b * a, a]
            })
            .collect();
        let [r, g, b, _] = stream.more_words(0, 2).map(uniform);
        Self { render, target, background: [r, g, b] }
    }

    fn fast(&self, level: Level) -> (LossValue, Vec<[f32; 4]>) {
        let mut gradient = vec![[f32::NAN; 4]; self.render.len()];
        let value = ImageLoss::with_level(level)
            .evaluate(&self.render, &self.target, self.background, SSIM_WEIGHT, &mut gradient)
            .unwrap();
        (value, gradient)
    }

    fn exact(&self) -> super::reference::ReferenceLoss {
        self.exact_at(&self.render.iter().map(|p| p.map(f64::from)).collect::<Vec<_>>())
    }

    fn exact_at(&self, render: &[[f64; 4]]) -> super::reference::ReferenceLoss {
        let background = self.background.map(f64::from);
        reference_loss(render, &self.target, background, f64::from(SSIM_WEIGHT)).unwrap()
    }

    fn assert_fast_is_exact(&self) {
        let exact = self.exact();
        for level in levels() {
            let (value, gradient) = self.fast(level);
            // The variances come from differences of windowed squares. These are sums of 22
            // products of values below 2 (rounding ≤ 22·ε·2, ε = 2⁻²⁴), divided by D₂ ≥ C₂ = 9e-4:
            // an error of 3e-3·(var / D₂ < 1 damps it) at the very worst, and on images that are
            // not constant (D₂ ~ 0.05 here) 5e-5. The mean over pixels averages it further.
            assert!((value.l1 - exact.l1).abs() <= 1e-6, "{value:?} {exact:?}");
            assert!((value.ssim - exact.ssim).abs() <= 2e-5, "{value:?} {}", exact.ssim);
            assert!((value.total - exact.total).abs() <= 5e-6);
            let largest = exact.gradient.iter().flatten().fold(0.0f64, |m, g| m.max(g.abs()));
            for (i, (found, expected)) in gradient.iter().zip(&exact.gradient).enumerate() {
                if self.sign_is_in_doubt(i) {
                    continue;
                }
                for c in 0..4 {
                    let error = (f64::from(found[c]) - expected[c]).abs();
                    assert!(error <= 1e-3 * largest, "{level:?} {i} {c}: {found:?} {expected:?}");
                }
            }
        }
    }

    /// Whether rounding decides the sign of render − target in a channel of this pixel.
    fn sign_is_in_doubt(&self, i: usize) -> bool {
        let background = self.background.map(f64::from);
        let (y, _) = self.target.over(i, background);
        let p = self.render[i].map(f64::from);
        (0..3).any(|c| (p[c] + (1.0 - p[3]) * background[c] - y[c]).abs() < 1e-6)
    }
}

/// The processor's best level and the narrowest that it can run.
fn levels() -> [Level; 2] {
    [Level::new(), Level::baseline()]
}

#[test]
fn the_reference_gradient_is_the_derivative_of_the_reference_loss() {
    for (seed, size, channels, masked) in [
        (1, (9, 14), Channels::Rgb, false),
        (2, (17, 3), Channels::Rgba, true),
        (3, (1, 1), Channels::Rgba, false),
        (4, (1, 12), Channels::Rgb, true),
    ] {
        let case = Case::random(seed, size, channels, masked);
        let exact = case.exact();
        let largest = exact.gradient.iter().flatten().fold(0.0f64, |m, g| m.max(g.abs()));
        let mut render: Vec<[f64; 4]> = case.render.iter().map(|p| p.map(f64::from)).collect();
        // h balances truncation (h²·third derivative, ~1/C₂ per pixel) and rounding (ε/h).
        let h = 1e-6;
        for i in 0..render.len() {
            for c in 0..4 {
                let at = render[i][c];
                render[i][c] = at + h;
                let above = case.exact_at(&render).total;
                render[i][c] = at - h;
                let below = case.exact_at(&render).total;
                render[i][c] = at;
                let difference = (above - below) / (2.0 * h);
                let error = (difference - exact.gradient[i][c]).abs() / largest;
                assert!(error <= 1e-6, "{size:?} pixel {i} component {c}: {error:e}");
            }
        }
    }
}

#[test]
fn the_fast_loss_agrees_with_the_reference() {
    for (seed, size) in
        [(0, 48), (1, 47), (2, 49), (3, 96), (4, 101), (5, 53)].into_iter().enumerate()
    {
        let (width, height) = (20 + size.0 as u32 * 7, size.1);
        for channels in [Channels::Rgb, Channels::Rgba] {
            Case::random(seed as u64, (width, height), channels, seed % 2 == 1)
                .assert_fast_is_exact();
        }
    }
}

#[test]
fn tiny_and_thin_images_have_the_loss_of_the_reference() {
    for size in [(1, 1), (1, 200), (200, 1), (2, 3), (16, 11), (15, 10), (17, 3), (33, 5)] {
        Case::random(7, size, Channels::Rgba, false).assert_fast_is_exact();
    }
}

#[test]
fn a_render_equal_to_the_target_has_exactly_no_loss_and_no_gradient() {
    for (size, constant) in
        [((70, 60), None), ((1, 1), None), ((40, 30), Some(77)), ((5, 50), Some(0))]
    {
        let mut case = Case::random(3, size, Channels::Rgb, false);
        if let Some(level) = constant {
            let pixels = vec![level; case.target.pixels().len()];
            case.target = TargetImage::new(size.0, size.1, Channels::Rgb, pixels).unwrap();
        }
        let unit = 1.0 / 255.0f32;
        case.render = case
            .target
            .pixels()
            .as_chunks::<3>()
            .0
            .iter()
            .map(|&[r, g, b]| [f32::from(r) * unit, f32::from(g) * unit, f32::from(b) * unit, 1.0])
            .collect();
        for level in levels() {
            let (value, gradient) = case.fast(level);
            assert_eq!(value, LossValue { l1: 0.0, ssim: 1.0, total: 0.0 });
            assert!(gradient.iter().flatten().all(|&g| g == 0.0));
        }
    }
}

#[test]
fn a_fully_masked_view_asks_for_nothing() {
    let case = Case::random(4, (30, 60), Channels::Rgba, false);
    let target = case.target.clone().with_mask(vec![0; 1800]).unwrap();
    let (value, gradient) = Case { target, ..case }.fast(Level::new());
    assert_eq!(value, LossValue { l1: 0.0, ssim: 1.0, total: 0.0 });
    assert!(gradient.iter().flatten().all(|&g| g == 0.0));
}

#[test]
fn constant_and_very_bright_images_have_finite_gradients() {
    for brightness in [0.0f32, 1.0, 1e3, 1e6] {
        let mut case = Case::random(5, (30, 20), Channels::Rgb, false);
        case.render.fill([brightness, brightness, brightness, 1.0]);
        for level in levels() {
            let (value, gradient) = case.fast(level);
            assert!(value.total.is_finite() && value.ssim.abs() <= 1.001, "{value:?}");
            assert!(gradient.iter().flatten().all(|g| g.is_finite()));
        }
    }
}

#[test]
fn a_pixel_that_is_not_a_number_makes_the_loss_not_a_number() {
    let mut case = Case::random(6, (60, 60), Channels::Rgb, false);
    case.render[1234][1] = f32::NAN;
    for level in levels() {
        assert!(case.fast(level).0.total.is_nan());
    }
}

#[test]
fn the_loss_is_bit_identical_for_any_number_of_threads() {
    let case = Case::random(8, (120, 203), Channels::Rgba, true);
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| case.fast(Level::new()))
    };
    let (value, gradient) = with_threads(1);
    for threads in [2, 3, 8] {
        let (other, other_gradient) = with_threads(threads);
        assert_eq!(value.total.to_bits(), other.total.to_bits());
        assert!(
            gradient
                .iter()
                .flatten()
                .zip(other_gradient.iter().flatten())
                .all(|(a, b)| a.to_bits() == b.to_bits())
        );
    }
}

#[test]
fn one_evaluator_serves_views_of_different_sizes() {
    let loss = ImageLoss::default();
    for size in [(96, 70), (90, 70), (5, 5), (112, 70), (96, 70), (200, 30)] {
        let case = Case::random(9, size, Channels::Rgb, false);
        let mut gradient = vec![[0.0; 4]; case.render.len()];
        let value = loss
            .evaluate(&case.render, &case.target, case.background, SSIM_WEIGHT, &mut gradient)
            .unwrap();
        assert_eq!((value, gradient), case.fast(Level::new()));
    }
}

#[test]
fn a_render_of_another_size_is_refused_by_name() {
    let case = Case::random(1, (4, 4), Channels::Rgb, false);
    let mut gradient = vec![[0.0; 4]; 16];
    let error = ImageLoss::default()
        .evaluate(&case.render[1..], &case.target, [0.0; 3], 0.2, &mut gradient)
        .unwrap_err();
    assert_eq!(error.to_string(), "rendered pixels: expected 16 values, found 15");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn any_size_agrees_with_the_reference(
        seed in any::<u64>(), width in 1u32..70, height in 1u32..70, masked: bool, alpha: bool,
    ) {
        let channels = if alpha { Channels::Rgba } else { Channels::Rgb };
        Case::random(seed, (width, height), channels, masked).assert_fast_is_exact();
    }
}
