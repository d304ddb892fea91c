//! Stage 5: blending. Front to back, one tile at a time, sixteen pixels of a row at a time.

mod exp2;
mod stage;
mod tile;

pub(crate) use exp2::exp2;
pub use stage::{Outputs, Target, rasterize};
pub(crate) use tile::TileRect;
