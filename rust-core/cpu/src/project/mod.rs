//! Stage 2: splats in the world → ellipses on the image.

mod color;
mod projected_splat;
mod projected_splats;
mod stage;

pub(crate) use color::{C1, C2, C3};
pub use color::{MAX_CHANNEL, flat_color, limit_channel, motion_reference, sh_basis_f32, sh_color};
pub(crate) use projected_splat::LOG2_ALPHA_MIN;
pub use projected_splat::{Outline, ProjectedSplat};
pub use projected_splats::ProjectedSplats;
pub use stage::{ProjectionStage, project};
pub(crate) use stage::{View, direction, multiply, rotation_matrix};
