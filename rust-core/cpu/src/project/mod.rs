//! Stage 2: splats in the world → ellipses on the image.

mod color;
mod projected_splat;
mod stage;

pub use color::{MAX_CHANNEL, flat_color, limit_channel, motion_reference, sh_basis_f32, sh_color};
pub use projected_splat::ProjectedSplat;
pub use stage::{ProjectionStage, project};
pub(crate) use stage::{View, direction, multiply, rotation_matrix};
