//! What goes into a backward pass and what comes out of it.

use trapeze_scene::Splats;

/// ∂L/∂image, for any loss L of a rendered frame.
#[derive(Clone, Copy, Debug)]
pub struct ImageGradient<'a> {
    /// ∂L/∂(r, g, b premultiplied over black, alpha), one entry per pixel, rows top to bottom.
    ///
    /// A loss on the image over a background b, rgb + (1 − alpha)·b, has −Σ b·∂L/∂rgb as its part
    /// of the derivative by alpha.
    pub color: &'a [[f32; 4]],
    /// ∂L/∂(expected depth), one entry per pixel. Pixels where nothing was hit have no depth;
    /// their entry is not read.
    pub expected_depth: Option<&'a [f32]>,
}

impl ImageGradient<'_> {
    /// Whether the arrays belong to an image of this many pixels.
    pub(crate) fn fits(&self, pixels: usize) -> bool {
        self.color.len() == pixels && self.expected_depth.is_none_or(|d| d.len() == pixels)
    }
}

/// ∂L/∂(pose): by what the deformation stage hands to the projection, one entry per splat; zero
/// for splats that no pixel saw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoseGradients {
    /// By the centre, 1/world units.
    pub positions: Vec<[f32; 3]>,
    /// By the quaternion (w, x, y, z) that enters the covariance, each component taken as free.
    pub rotations: Vec<[f32; 4]>,
    /// By the standard deviations (linear, not their logarithms), 1/world units.
    pub scales: Vec<[f32; 3]>,
}

/// Splats whose every entry is zero, in the shape of `splats`: a place for gradients.
pub(crate) fn reset_like(gradients: &mut Splats, splats: &Splats) {
    fn zero<T: Clone + Default>(values: &mut Vec<T>, length: usize) {
        values.clear();
        values.resize(length, T::default());
    }
    let n = splats.len();
    zero(&mut gradients.positions, n);
    zero(&mut gradients.log_scales, n);
    zero(&mut gradients.rotations, n);
    zero(&mut gradients.opacity_logits, n);
    zero(&mut gradients.sh_dc, n);
    zero(&mut gradients.sh_rest, splats.sh_rest.len());
    gradients.sh_degree = splats.sh_degree;
}
