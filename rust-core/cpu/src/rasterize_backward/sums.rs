//! What the pixels of one splat add up to.

/// Sums over the pixels that a splat contributed to.
///
/// With w = αT its weight in a pixel, g the pixel's ∂L/∂rgb, q = α·∂L/∂α where α is below its
/// clamp (else 0), v₁ = u11 dx + u12 dy and dy the distance from the centre in rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SplatSums {
    /// Σ w g, per channel.
    pub color: [f32; 3],
    /// Σ q.
    pub q: f32,
    /// Σ q dy.
    pub q_dy: f32,
    /// Σ q dy².
    pub q_dy_dy: f32,
    /// Σ q v₁.
    pub q_v: f32,
    /// Σ q v₁ dy.
    pub q_v_dy: f32,
    /// Σ q v₁². The part of ∂L/∂u11 that is left once u12 follows it, as it does: for a needle
    /// Σ q v₁ dx and Σ q v₁ dy are large and all but cancel, this sum does not.
    pub q_v_v: f32,
    /// Σ w ∂L/∂(Σ w z).
    pub depth: f32,
}

/// Sums of a splat.
pub(super) const SUMS: usize = 10;

/// Floats of a [`SplatSums`] as one vector.
pub(super) const LANES: usize = 16;

impl SplatSums {
    /// From the lanes that the tile loop accumulates, in the order of the fields.
    pub(super) fn from_lanes(lanes: &[f32; LANES]) -> Self {
        let &[r, g, b, q, q_dy, q_dy_dy, q_v, q_v_dy, q_v_v, depth, ..] = lanes;
        Self { color: [r, g, b], q, q_dy, q_dy_dy, q_v, q_v_dy, q_v_v, depth }
    }
}
