//! The mirror of stage 2: sums over pixels → ∂L/∂(pose, opacity, colour coefficients).

mod color;
mod ellipse;
mod splat;

pub(crate) use splat::{BackwardView, SplatInput, project_backward};
