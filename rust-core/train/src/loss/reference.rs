//! The loss in double precision, plane by plane, without fusing: the specification of the fast one.

use super::target::{TargetError, TargetImage, expect_length};
use super::window::blur;

/// SSIM's stabiliser of the means: (0.01)² for a dynamic range of 1.
pub const C1: f64 = 0.01 * 0.01;
/// SSIM's stabiliser of the variances: (0.03)².
pub const C2: f64 = 0.03 * 0.03;

/// The loss of one view and its gradient.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceLoss {
    /// Mean of |render − target| over pixels and channels.
    pub l1: f64,
    /// Mean structural similarity over pixels and channels.
    pub ssim: f64,
    /// (1 − λ)·L1 + λ·(1 − SSIM).
    pub total: f64,
    /// ∂total / ∂(r, g, b premultiplied, alpha) of every rendered pixel.
    pub gradient: Vec<[f64; 4]>,
}

/// Loss of `render` (premultiplied r g b, alpha) against `target`, both over `background`.
///
/// With m the weight of a pixel, what is compared is x = m·(rgb + (1 − α)·background) + (1 − m)·y:
/// a pixel that does not count is taken as equal to the target, so that it neither adds to the loss
/// nor draws an edge into the windows of its neighbours. Means are over all pixels, masked or not.
///
/// # Errors
/// [`TargetError::Length`] when the render has another number of pixels.
pub fn reference_loss(
    render: &[[f64; 4]],
    target: &TargetImage,
    background: [f64; 3],
    ssim_weight: f64,
) -> Result<ReferenceLoss, TargetError> {
    expect_length("rendered pixels", target.len(), render.len())?;
    let (width, height) = (target.width(), target.height());
    let values = (3 * render.len()) as f64;
    let mut loss =
        ReferenceLoss { l1: 0.0, ssim: 0.0, total: 0.0, gradient: vec![[0.0; 4]; render.len()] };
    for channel in 0..3 {
        let (x, y) = compared_planes(render, target, background, channel);
        let ssim = similarity(&x, &y, width, height);
        for (i, g_ssim) in ssim.gradient(&x, &y, width, height).into_iter().enumerate() {
            let difference = x[i] - y[i];
            loss.l1 += difference.abs() / values;
            loss.ssim += ssim.value[i] / values;
            // The subgradient of |0| is 0.
            let sign = if difference == 0.0 { 0.0 } else { difference.signum() };
            let (_, weight) = target.over(i, background);
            let g = weight * ((1.0 - ssim_weight) * sign - ssim_weight * g_ssim) / values;
            loss.gradient[i][channel] = g;
            loss.gradient[i][3] -= g * background[channel];
        }
    }
    loss.total = (1.0 - ssim_weight) * loss.l1 + ssim_weight * (1.0 - loss.ssim);
    Ok(loss)
}

/// One channel of the render and of the target, over the background, masked.
pub(super) fn compared_planes(
    render: &[[f64; 4]],
    target: &TargetImage,
    background: [f64; 3],
    channel: usize,
) -> (Vec<f64>, Vec<f64>) {
    render
        .iter()
        .enumerate()
        .map(|(i, pixel)| {
            let (color, weight) = target.over(i, background);
            let y = color[channel];
            let over = pixel[channel] + (1.0 - pixel[3]) * background[channel];
            (weight * over + (1.0 - weight) * y, y)
        })
        .unzip()
}

/// SSIM of every pixel, and its derivatives by the windowed means of x, x² and xy.
pub(super) struct Similarity {
    pub(super) value: Vec<f64>,
    derivatives: [Vec<f64>; 3],
}

/// SSIM of two planes.
///
/// Wang et al. 2004: S = N₁N₂ / (D₁D₂) with N₁ = 2μₓμᵧ + C₁, N₂ = 2σₓᵧ + C₂, D₁ = μₓ² + μᵧ² + C₁,
/// D₂ = σₓ² + σᵧ² + C₂ and windowed means.
pub(super) fn similarity(x: &[f64], y: &[f64], width: usize, height: usize) -> Similarity {
    let mean_of = |f: fn(f64, f64) -> f64| -> Vec<f64> {
        let plane: Vec<f64> = x.iter().zip(y).map(|(&x, &y)| f(x, y)).collect();
        blur(&plane, width, height)
    };
    let (mean_x, mean_y) = (mean_of(|x, _| x), mean_of(|_, y| y));
    let (mean_xx, mean_yy) = (mean_of(|x, _| x * x), mean_of(|_, y| y * y));
    let mean_xy = mean_of(|x, y| x * y);
    let zeros = || vec![0.0; x.len()];
    let mut result = Similarity { value: zeros(), derivatives: [zeros(), zeros(), zeros()] };
    let [by_mean, by_square, by_product] = &mut result.derivatives;
    for i in 0..x.len() {
        let (mx, my) = (mean_x[i], mean_y[i]);
        let n1 = 2.0 * mx * my + C1;
        let n2 = 2.0 * (mean_xy[i] - mx * my) + C2;
        let d1 = mx * mx + my * my + C1;
        let d2 = mean_xx[i] - mx * mx + mean_yy[i] - my * my + C2;
        let s = n1 * n2 / (d1 * d2);
        result.value[i] = s;
        by_mean[i] = 2.0 * my * (n2 - n1) / (d1 * d2) - 2.0 * mx * s * (1.0 / d1 - 1.0 / d2);
        by_square[i] = -s / d2;
        by_product[i] = 2.0 * n1 / (d1 * d2);
    }
    result
}

impl Similarity {
    /// ∂ΣS/∂x of every pixel. With A, B and C the derivatives by the windowed means of x, x² and
    /// xy, the chain rule through the symmetric window W gives W·A + 2x·W·B + y·W·C.
    fn gradient(&self, x: &[f64], y: &[f64], width: usize, height: usize) -> Vec<f64> {
        let [a, b, c] = self.derivatives.each_ref().map(|plane| blur(plane, width, height));
        (0..x.len()).map(|i| a[i] + 2.0 * x[i] * b[i] + y[i] * c[i]).collect()
    }
}
