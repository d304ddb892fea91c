//! The mirror of [`rasterize`](super::rasterize()): ∂L/∂image → ∂L/∂(projected splats).
//!
//! With w = αT the weights of a pixel's contributors in order, the pixel shows Σ w c, Σ w (alpha)
//! and Σ w z. Let v = g·c + g_alpha + g_depth·z be what a unit of weight adds to L. Then
//!
//! ∂L/∂αₖ = Tₖ vₖ − (Σ_{j>k} wⱼ vⱼ) / (1 − αₖ),
//!
//! because every later weight carries the factor 1 − αₖ. Contributors are visited back to front,
//! and there is no bound on their number.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::ProjectedSplat;
use super::project::{ALPHA_MAX, ALPHA_MIN, TRANSMITTANCE_MIN};
use super::rasterize::{TIE, visited_columns};
use crate::gradient::ImageGradient;

/// ∂L/∂ what the rasteriser reads of one splat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProjectedGradient {
    /// By the centre, 1/px.
    pub centre: DVec2,
    /// By the conic's xx, xy, yy, px²; xy counts once for both off-diagonal entries.
    pub conic: [f64; 3],
    /// By the opacity.
    pub opacity: f64,
    /// By r g b.
    pub color: DVec3,
    /// By view z, 1/world units.
    pub depth: f64,
}

impl ProjectedGradient {
    fn add(&mut self, other: &Self) {
        self.centre += other.centre;
        for (a, b) in self.conic.iter_mut().zip(other.conic) {
            *a += b;
        }
        self.opacity += other.opacity;
        self.color += other.color;
        self.depth += other.depth;
    }
}

/// A splat's part in one pixel.
struct Contribution {
    /// Index into the splats in drawing order.
    rank: usize,
    alpha: f64,
    /// T before it.
    transmittance: f64,
}

/// Rows that are summed by themselves before the parts are added in order: the result does not
/// depend on the number of threads.
const ROWS: usize = 32;

/// Gradients of `splats`, which must be in drawing order, for an image of `size` (width, height).
///
/// # Panics
/// When the gradient has another number of pixels than the image.
#[must_use]
pub fn rasterize_backward(
    splats: &[ProjectedSplat],
    size: (u32, u32),
    gradient: &ImageGradient<'_>,
) -> Vec<ProjectedGradient> {
    let (width, height) = (size.0 as usize, size.1 as usize);
    assert!(gradient.fits(width * height), "one gradient per pixel");
    let parts: Vec<Vec<ProjectedGradient>> = (0..height.div_ceil(ROWS))
        .into_par_iter()
        .map(|part| {
            let mut sums = vec![ProjectedGradient::default(); splats.len()];
            for y in part * ROWS..((part + 1) * ROWS).min(height) {
                for (x, contributions) in blend_row(splats, y, width).iter().enumerate() {
                    let pixel = PixelGradient::new(gradient, y * width + x, splats, contributions);
                    let centre = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                    pixel.add_to(&mut sums, splats, contributions, centre);
                }
            }
            sums
        })
        .collect();
    let mut total = vec![ProjectedGradient::default(); splats.len()];
    for part in &parts {
        total.iter_mut().zip(part).for_each(|(sum, part)| sum.add(part));
    }
    total
}

/// The contributors of every pixel of row `y`, by the rules of the forward pass.
fn blend_row(splats: &[ProjectedSplat], y: usize, width: usize) -> Vec<Vec<Contribution>> {
    let mut row: Vec<Vec<Contribution>> = (0..width).map(|_| Vec::new()).collect();
    // T of each pixel; `None` once a blend would have emptied it.
    let mut left = vec![Some(1.0); width];
    for (rank, splat) in splats.iter().enumerate() {
        for x in visited_columns(splat, y, width) {
            let Some(transmittance) = left[x] else { continue };
            let alpha = splat.alpha(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
            if alpha < ALPHA_MIN {
                continue;
            }
            let remaining = transmittance * (1.0 - alpha);
            left[x] = (remaining > TRANSMITTANCE_MIN * (1.0 + TIE)).then_some(remaining);
            if left[x].is_some() {
                row[x].push(Contribution { rank, alpha, transmittance });
            }
        }
    }
    row
}

/// ∂L/∂ the sums of one pixel.
struct PixelGradient {
    /// By Σ w c.
    color: DVec3,
    /// By Σ w.
    weight: f64,
    /// By Σ w z.
    weighted_depth: f64,
}

impl PixelGradient {
    fn new(
        gradient: &ImageGradient<'_>,
        pixel: usize,
        splats: &[ProjectedSplat],
        contributions: &[Contribution],
    ) -> Self {
        let [r, g, b, alpha] = gradient.color[pixel].map(f64::from);
        let mut sums = Self { color: DVec3::new(r, g, b), weight: alpha, weighted_depth: 0.0 };
        if let (Some(depth), false) = (gradient.expected_depth, contributions.is_empty()) {
            // Expected depth is Z / W with Z = Σ w z, W = Σ w.
            let depth = f64::from(depth[pixel]);
            let weights = contributions.iter().map(|c| (c.alpha * c.transmittance, c.rank));
            let (weight, weighted) = weights
                .fold((0.0, 0.0), |(sum, z), (w, rank)| (sum + w, z + w * splats[rank].depth));
            sums.weighted_depth = depth / weight;
            sums.weight -= depth * weighted / (weight * weight);
        }
        sums
    }

    fn add_to(
        &self,
        sums: &mut [ProjectedGradient],
        splats: &[ProjectedSplat],
        contributions: &[Contribution],
        centre: DVec2,
    ) {
        // Σ w v of all contributors behind the one at hand.
        let mut behind = 0.0;
        for &Contribution { rank, alpha, transmittance } in contributions.iter().rev() {
            let (splat, sum) = (&splats[rank], &mut sums[rank]);
            let weight = alpha * transmittance;
            let value =
                self.color.dot(splat.color) + self.weight + self.weighted_depth * splat.depth;
            sum.color += weight * self.color;
            sum.depth += weight * self.weighted_depth;
            let by_alpha = transmittance * value - behind / (1.0 - alpha);
            behind += weight * value;
            // At the clamp α is a constant.
            if alpha < ALPHA_MAX {
                let d = centre - splat.centre;
                let [xx, xy, yy] = splat.conic;
                // α = o·exp(p) with p = −½ dᵀΣ'⁻¹d.
                let by_power = by_alpha * alpha;
                sum.opacity += by_power / splat.opacity;
                sum.conic[0] -= 0.5 * d.x * d.x * by_power;
                sum.conic[1] -= d.x * d.y * by_power;
                sum.conic[2] -= 0.5 * d.y * d.y * by_power;
                sum.centre += by_power * DVec2::new(xx * d.x + xy * d.y, xy * d.x + yy * d.y);
            }
        }
    }
}
