//! Stage 4: which tiles each splat touches.
//!
//! The image is cut into tiles, a row of tiles is a *band*. [`bin_bands`] lists for every band the
//! splats whose box meets it; [`fill_tiles`] then makes the list of every tile of one band by
//! the exact ellipse–strip test, just before that band is rasterised. Lists of tiles exist for the
//! bands in flight only, so memory is bounded by splats × bands, not by splats × tiles.

mod bands;
mod tiles;

pub use bands::{BandLists, bin_bands};
pub(crate) use tiles::LANES;
pub use tiles::{BandTiles, TileSize, fill_tiles};
