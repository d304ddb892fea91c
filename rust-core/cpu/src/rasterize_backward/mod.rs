//! The mirror of stage 5: ∂L/∂image → sums over the pixels of each splat.
//!
//! A tile is blended once more, front to back, by the very operations of the forward pass, so both
//! make the same decisions. What is behind a contributor is not accumulated from the back: the
//! whole sum Σ w v of a pixel is known from the image (it is linear in what the pixel shows), and
//! each contributor is taken off it in turn. So nothing per contributor is stored between the
//! passes, their number has no bound, and T is never divided by 1 − α.
//!
//! Sums are made in a fixed order: pixels of a block in vector lanes, blocks of a tile top to
//! bottom, tiles of a band left to right, bands top to bottom. No order depends on the number of
//! threads, so neither does any bit of the result.

mod reduce;
mod stage;
mod sums;
mod tile;

pub use stage::{BackwardInput, BackwardMemory, rasterize_backward};
pub use sums::SplatSums;
