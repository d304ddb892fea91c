//! How far an image is from the reference, and where it decided differently.

use trapeze_cpu::reference::ReferenceFrame;
use trapeze_scene::Frame;

/// Largest |Δ| of a channel or of alpha, for pixel values up to 1; relative for brighter ones.
///
/// One blend is exact to a few 2⁻²⁴ of its operands and the exponent ‖U d‖² ≤ 8 to a few 2⁻²⁴ of
/// itself and of the two terms of U d, so well-conditioned images agree to about 1e-5. What is
/// left up to half a level of an 8-bit image covers splats of some hundred pixels' length whose
/// ellipse is two pixels wide: the terms of U d are then a hundred times their sum.
pub const TOLERANCE: f64 = 2e-3;

/// Pixels in which the reference itself was closer than this (relative) to a threshold or to a
/// near-tie in depth may be decided differently in f32. View depths are sums of three products, so
/// exact to a few 2⁻²⁴ of the distance; α and T carry a few 2⁻²⁴ per blend.
pub const MARGIN: f64 = 1e-4;

/// The result of comparing an image with the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Pixels compared.
    pub pixels: usize,
    /// Largest |Δ| where the reference was sure of its decisions.
    pub worst: f64,
    /// Where that was.
    pub worst_pixel: usize,
    /// Pixels above the tolerance where it was not: a threshold or a near-tie flipped.
    pub flips: usize,
}

impl Comparison {
    /// Whether the image agrees: `worst` within the tolerance, at most one pixel in 10 000 (and
    /// one in small images) flipped.
    #[must_use]
    pub fn agrees(&self, tolerance: f64) -> bool {
        self.worst <= tolerance && self.flips <= (self.pixels / 10_000).max(1)
    }
}

/// Compares colour and alpha with the reference.
///
/// # Panics
/// When the sizes differ.
#[must_use]
pub fn compare(frame: &Frame, reference: &ReferenceFrame, tolerance: f64) -> Comparison {
    assert_eq!((frame.width, frame.height), (reference.width, reference.height));
    let mut result = Comparison { pixels: frame.color.len(), ..Comparison::default() };
    for (i, (ours, exact)) in frame.color.iter().zip(&reference.color).enumerate() {
        let size = exact.iter().fold(1.0, |m: f64, c| m.max(c.abs()));
        let difference = ours
            .iter()
            .zip(exact)
            .map(|(&a, b)| (f64::from(a) - b).abs() / size)
            // `f64::max` would pass over NaN.
            .fold(0.0, |m: f64, d| if d <= m { m } else { d });
        if reference.margin[i] >= MARGIN {
            if !(difference <= result.worst) {
                result.worst = difference;
                result.worst_pixel = i;
            }
        } else if !(difference <= tolerance) {
            result.flips += 1;
        }
    }
    result
}
