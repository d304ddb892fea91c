//! PSNR and SSIM of held-out views, in double precision, on colours clamped to [0, 1].
//!
//! Both are also given after rounding to 8 bits, which is what a saved image holds. The figure of a
//! set of views is the mean of the views' figures, not the figure of the pooled error.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::reference::{compared_planes, similarity};
use super::target::{TargetError, TargetImage, expect_length};

/// How close a render is to a photograph.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewMetrics {
    /// Peak signal-to-noise ratio in dB; infinite for equal images.
    pub psnr: f64,
    /// Mean structural similarity.
    pub ssim: f64,
    /// PSNR after an 8-bit round trip.
    pub psnr_8bit: f64,
    /// SSIM after an 8-bit round trip.
    pub ssim_8bit: f64,
}

impl ViewMetrics {
    /// Metrics of `render` (premultiplied r g b, alpha) against `target`, both over `background`.
    /// Masked pixels count by their weight; without any weight, or with a pixel that is not a number,
    /// the metrics are NaN.
    ///
    /// # Errors
    /// [`TargetError::Length`] when the render has another number of pixels.
    pub fn of(
        render: &[[f32; 4]],
        target: &TargetImage,
        background: [f64; 3],
    ) -> Result<Self, TargetError> {
        expect_length("rendered pixels", target.len(), render.len())?;
        let render: Vec<[f64; 4]> = render.iter().map(|pixel| pixel.map(f64::from)).collect();
        let (psnr, ssim) = compare(&render, target, background, |c| c);
        let (psnr_8bit, ssim_8bit) = compare(&render, target, background, eight_bits);
        Ok(Self { psnr, ssim, psnr_8bit, ssim_8bit })
    }

    /// The mean over views, figure by figure; `None` without views.
    #[must_use]
    pub fn mean(views: &[Self]) -> Option<Self> {
        if views.is_empty() {
            return None;
        }
        let mean =
            |figure: fn(&Self) -> f64| views.iter().map(figure).sum::<f64>() / views.len() as f64;
        Some(Self {
            psnr: mean(|v| v.psnr),
            ssim: mean(|v| v.ssim),
            psnr_8bit: mean(|v| v.psnr_8bit),
            ssim_8bit: mean(|v| v.ssim_8bit),
        })
    }
}

/// The nearest of the 256 levels of an 8-bit image.
fn eight_bits(color: f64) -> f64 {
    (color * 255.0).round() / 255.0
}

/// PSNR and SSIM after clamping and `store`.
fn compare(
    render: &[[f64; 4]],
    target: &TargetImage,
    background: [f64; 3],
    store: fn(f64) -> f64,
) -> (f64, f64) {
    let weights: Vec<f64> = (0..target.len()).map(|i| target.over(i, background).1).collect();
    let total = 3.0 * weights.iter().sum::<f64>();
    let sums: Vec<(f64, f64)> = (0..3)
        .into_par_iter()
        .map(|channel| {
            let (mut x, mut y) = compared_planes(render, target, background, channel);
            for color in x.iter_mut().chain(&mut y) {
                *color = store(color.clamp(0.0, 1.0));
            }
            let ssim = similarity(&x, &y, target.width(), target.height()).value;
            // In x the target already stands in for what does not count; the error of a pixel that
            // counts in part is that of the pixel itself.
            let squares = (0..x.len()).map(|i| {
                let over = render[i][channel] + (1.0 - render[i][3]) * background[channel];
                weights[i] * (store(over.clamp(0.0, 1.0)) - y[i]).powi(2)
            });
            let squares = squares.sum::<f64>();
            (squares, (0..x.len()).map(|i| weights[i] * ssim[i]).sum())
        })
        .collect();
    let squares: f64 = sums.iter().map(|(squares, _)| squares).sum();
    let similarity: f64 = sums.iter().map(|(_, similarity)| similarity).sum();
    (-10.0 * (squares / total).log10(), similarity / total)
}

#[cfg(test)]
mod tests {
    use super::super::target::Channels;
    use super::*;

    fn image(pixels: Vec<u8>) -> TargetImage {
        TargetImage::new(pixels.len() as u32 / 3, 1, Channels::Rgb, pixels).unwrap()
    }

    #[test]
    fn psnr_follows_its_definition_on_clamped_colours() {
        let target = image(vec![255, 0, 0, 0, 0, 0]);
        // Errors 0 (2.0 clamps to 1), 0.5, 0 and 0, 0, 0.1: mse = 0.26 / 6.
        let render = [[2.0, 0.5, 0.0, 1.0], [0.0, -3.0, 0.1, 1.0]];
        let metrics = ViewMetrics::of(&render, &target, [0.0; 3]).unwrap();
        let expected = -10.0 * (0.26f64 / 6.0).log10();
        // 0.1 is not a single-precision number.
        assert!((metrics.psnr - expected).abs() < 1e-6, "{}", metrics.psnr);
        // 8 bits round 0.5 to 128/255 and 0.1 to 26/255.
        let mse = ((128.0f64 / 255.0).powi(2) + (26.0f64 / 255.0).powi(2)) / 6.0;
        assert!((metrics.psnr_8bit + 10.0 * mse.log10()).abs() < 1e-9);
    }

    #[test]
    fn equal_images_have_infinite_psnr_and_similarity_one() {
        let target = image((0..30).map(|i| i * 8).collect());
        let render: Vec<[f32; 4]> = (0..10)
            .map(|i| {
                let ([r, g, b], _) = target.over(i, [1.0; 3]);
                [r as f32, g as f32, b as f32, 1.0]
            })
            .collect();
        let metrics = ViewMetrics::of(&render, &target, [1.0; 3]).unwrap();
        assert!(metrics.psnr > 140.0 && metrics.psnr_8bit == f64::INFINITY);
        assert!((metrics.ssim - 1.0).abs() < 1e-9 && (metrics.ssim_8bit - 1.0).abs() < 1e-12);
    }

    #[test]
    fn masked_pixels_do_not_count() {
        let target = image(vec![100, 100, 100, 0, 0, 0]).with_mask(vec![255, 0]).unwrap();
        let render = [[0.5, 0.5, 0.5, 1.0], [1.0, 1.0, 1.0, 1.0]];
        let metrics = ViewMetrics::of(&render, &target, [0.0; 3]).unwrap();
        let expected = -20.0 * (0.5f64 - 100.0 / 255.0).log10();
        assert!((metrics.psnr - expected).abs() < 1e-12);
    }

    #[test]
    fn the_mean_is_over_views_not_over_pixels() {
        let view = |psnr| ViewMetrics { psnr, ssim: 0.5, psnr_8bit: psnr, ssim_8bit: 0.5 };
        let mean = ViewMetrics::mean(&[view(20.0), view(30.0)]).unwrap();
        assert_eq!((mean.psnr, mean.ssim), (25.0, 0.5));
        assert_eq!(ViewMetrics::mean(&[]), None);
    }
}
