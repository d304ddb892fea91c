//! Stage 5: blending. Front to back, one tile at a time, sixteen pixels of a row at a time.

mod exp2;
mod stage;
pub(crate) mod strip;
mod tile;

pub use stage::{Outputs, Target, rasterize};
pub(crate) use tile::TileRect;
