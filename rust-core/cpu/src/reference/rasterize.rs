//! Front-to-back blending, pixel by pixel.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use trapeze_scene::{Frame, NO_SPLAT};

use super::ProjectedSplat;
use super::project::{ALPHA_MIN, TRANSMITTANCE_MIN};

/// Which pixels a splat visits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Visit {
    /// A rectangle that contains every pixel where α can reach 1/255.
    Rectangle,
    /// All pixels of the image.
    AllPixels,
}

/// A reference image, and how sure it is of its decisions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceFrame {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Premultiplied r g b, then alpha.
    pub color: Vec<[f64; 4]>,
    /// Σ w z / Σ w; NaN where nothing was hit.
    pub expected_depth: Vec<f64>,
    /// z of the splat at which transmittance first falls to ≤ 0.5; NaN where it never does.
    pub median_depth: Vec<f64>,
    /// Splat with the largest α·T; [`NO_SPLAT`] where nothing was hit.
    pub top_contributor: Vec<u32>,
    /// Smallest relative distance of any quantity in this pixel from a threshold that changes the
    /// image in a step: α from 1/255, T from 10⁻⁴, and the depths of two successive contributors
    /// from each other. A path in another precision may decide differently where this is small.
    pub margin: Vec<f64>,
}

impl ReferenceFrame {
    /// The image in single precision.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        let narrow = |values: &[f64]| values.iter().map(|&v| v as f32).collect();
        Frame {
            width: self.width,
            height: self.height,
            color: self.color.iter().map(|c| c.map(|v| v as f32)).collect(),
            expected_depth: narrow(&self.expected_depth),
            median_depth: narrow(&self.median_depth),
            top_contributor: self.top_contributor.clone(),
        }
    }
}

/// Relative slack of the comparison with [`TRANSMITTANCE_MIN`]. Two blends at the clamp leave
/// (1 − 0.99)² = 10⁻⁴, a tie that every overlap of two opaque splats makes; by the rule the second
/// of them is left out. 1 − 0.99 in f64 is larger than 0.01 by an ulp, in f32 it is smaller.
pub(super) const TIE: f64 = 1e-12;

/// What has been accumulated in one pixel.
#[derive(Clone, Copy, Debug)]
struct Pixel {
    transmittance: f64,
    color: DVec3,
    weight: f64,
    weighted_depth: f64,
    median_depth: f64,
    top_weight: f64,
    top: u32,
    last_depth: f64,
    margin: f64,
    finished: bool,
}

const EMPTY: Pixel = Pixel {
    transmittance: 1.0,
    color: DVec3::ZERO,
    weight: 0.0,
    weighted_depth: 0.0,
    median_depth: f64::NAN,
    top_weight: 0.0,
    top: NO_SPLAT,
    last_depth: f64::NEG_INFINITY,
    margin: f64::INFINITY,
    finished: false,
};

impl Pixel {
    fn blend(&mut self, splat: &ProjectedSplat, centre: DVec2) {
        if self.finished {
            return;
        }
        let alpha = splat.alpha(centre);
        self.margin = self.margin.min((alpha / ALPHA_MIN - 1.0).abs());
        if alpha < ALPHA_MIN {
            return;
        }
        self.margin = self.margin.min((splat.depth - self.last_depth) / splat.depth);
        self.last_depth = splat.depth;
        let remaining = self.transmittance * (1.0 - alpha);
        self.margin = self.margin.min((remaining / TRANSMITTANCE_MIN - 1.0).abs());
        if remaining <= TRANSMITTANCE_MIN * (1.0 + TIE) {
            self.finished = true;
            return;
        }
        let weight = alpha * self.transmittance;
        self.color += weight * splat.color;
        self.weight += weight;
        self.weighted_depth += weight * splat.depth;
        if weight > self.top_weight {
            self.top_weight = weight;
            self.top = splat.index;
        }
        if self.transmittance > 0.5 && remaining <= 0.5 {
            self.median_depth = splat.depth;
        }
        self.transmittance = remaining;
    }
}

/// Blends `splats`, which must be in drawing order, into an image of `size` (width, height).
#[must_use]
pub fn rasterize(splats: &[ProjectedSplat], size: (u32, u32), visit: Visit) -> ReferenceFrame {
    let (width, height) = (size.0 as usize, size.1 as usize);
    let mut pixels = vec![EMPTY; width * height];
    pixels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for splat in splats {
            let columns = match visit {
                Visit::AllPixels => 0..width,
                Visit::Rectangle => visited_columns(splat, y, width),
            };
            for x in columns {
                row[x].blend(splat, DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
            }
        }
    });
    ReferenceFrame {
        width: size.0,
        height: size.1,
        color: pixels.iter().map(|p| p.color.extend(1.0 - p.transmittance).to_array()).collect(),
        // An empty pixel gives 0/0, which is the NaN that is asked for.
        expected_depth: pixels.iter().map(|p| p.weighted_depth / p.weight).collect(),
        median_depth: pixels.iter().map(|p| p.median_depth).collect(),
        top_contributor: pixels.iter().map(|p| p.top).collect(),
        margin: pixels.iter().map(|p| p.margin).collect(),
    }
}

/// Columns of row `y` inside the splat's rectangle, one pixel wider on each side than it has to be.
pub(super) fn visited_columns(
    splat: &ProjectedSplat,
    y: usize,
    width: usize,
) -> std::ops::Range<usize> {
    let half = splat.half_extent();
    if (y as f64 + 0.5 - splat.centre.y).abs() > half.y + 1.0 {
        return 0..0;
    }
    let clamp = |x: f64| x.clamp(0.0, width as f64) as usize;
    clamp((splat.centre.x - half.x - 1.5).floor())..clamp((splat.centre.x + half.x + 1.5).ceil())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(index: u32, depth: f64, opacity: f64, color: DVec3) -> ProjectedSplat {
        ProjectedSplat {
            index,
            depth,
            centre: DVec2::splat(0.5),
            covariance: [1.0, 0.0, 1.0],
            conic: [1.0, 0.0, 1.0],
            opacity,
            color,
        }
    }

    fn one_pixel(splats: &[ProjectedSplat]) -> ReferenceFrame {
        rasterize(splats, (1, 1), Visit::Rectangle)
    }

    #[test]
    fn two_layers_blend_front_to_back() {
        let frame = one_pixel(&[dot(7, 1.0, 0.5, DVec3::X), dot(9, 3.0, 0.8, DVec3::Y)]);
        let [r, g, b, a] = frame.color[0];
        assert_eq!((r, g, b), (0.5, 0.4, 0.0));
        assert!((a - 0.9).abs() < 1e-15);
        assert!((frame.expected_depth[0] - (0.5 + 0.4 * 3.0) / 0.9).abs() < 1e-15);
        assert_eq!(frame.median_depth[0], 1.0);
        assert_eq!(frame.top_contributor[0], 7);
    }

    #[test]
    fn the_first_of_equal_contributors_is_on_top() {
        let frame = one_pixel(&[dot(4, 1.0, 0.5, DVec3::X), dot(2, 2.0, 0.99, DVec3::Y)]);
        assert_eq!(frame.top_contributor[0], 4, "0.5 and 0.495");
        let frame = one_pixel(&[dot(4, 1.0, 0.25, DVec3::X), dot(2, 2.0, 0.9, DVec3::Y)]);
        assert_eq!(frame.top_contributor[0], 2);
    }

    #[test]
    fn a_blend_that_would_empty_the_pixel_is_not_made() {
        // T: 1 → 0.01 → 0.0002; a third layer of 0.99 would leave 2·10⁻⁶.
        let opacities = [0.99, 0.98, 0.99];
        let layers: Vec<_> = (0u32..)
            .zip(opacities)
            .map(|(i, o)| dot(i, f64::from(i) + 1.0, o, DVec3::ONE))
            .collect();
        let frame = one_pixel(&layers);
        assert!((frame.color[0][3] - 0.9998).abs() < 1e-12, "{:?}", frame.color[0]);
    }

    #[test]
    fn of_two_splats_at_the_clamp_the_second_is_left_out() {
        let frame = one_pixel(&[dot(0, 1.0, 1.0, DVec3::X), dot(1, 2.0, 1.0, DVec3::Y)]);
        assert_eq!(frame.color[0], [0.99, 0.0, 0.0, 0.99]);
    }

    #[test]
    fn an_empty_pixel_has_no_depth_and_no_owner() {
        let frame = one_pixel(&[dot(0, 1.0, 0.003, DVec3::ONE)]);
        assert_eq!(frame.color[0], [0.0; 4]);
        assert!(frame.expected_depth[0].is_nan() && frame.median_depth[0].is_nan());
        assert_eq!(frame.top_contributor[0], NO_SPLAT);
    }
}
