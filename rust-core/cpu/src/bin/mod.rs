//! Stage 4: which tiles each splat touches.
//!
//! The image is cut into tiles, a row of tiles is a *band*. [`BandLists`] hold for every band the
//! splats that touch it, each with its run of tiles by the exact ellipse–strip test;
//! [`BandTiles::fill`] deals them out to the tiles of one band, just before that band is rasterised.
//! Lists of tiles exist for the bands in flight only, so memory is bounded by splats × bands, not by
//! splats × tiles.

mod bands;
mod tiles;

pub use bands::{BandEntry, BandLists};
pub(crate) use tiles::LANES;
pub use tiles::{BandTiles, TileSize};
