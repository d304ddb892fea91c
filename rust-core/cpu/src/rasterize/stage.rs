//! Rasterising all tiles of a frame.

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;
use trapeze_scene::Frame;

use super::strip::StripSplat;
use super::tile::{Band, TileRect, blend_tile};
use crate::bin::{BandLists, BandTiles, TileSize};
use crate::project::ProjectedSplat;

/// Which images a frame holds besides colour and alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outputs {
    /// Expected and median depth.
    pub depth: bool,
    /// Index of the splat with the largest weight.
    pub top_contributor: bool,
}

/// What is drawn into: a size, and how to get there. The image does not depend on `tile`.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Tile size.
    pub tile: TileSize,
    /// Which images are wanted.
    pub outputs: Outputs,
    /// SIMD level.
    pub level: Level,
}

/// Working memory of one task.
#[derive(Default)]
struct Scratch {
    tiles: BandTiles,
    /// The splats of the strip at hand, side by side: fetched once in a row, where the processor
    /// can have many fetches under way, they are then read block after block from the cache.
    strip: Vec<StripSplat>,
}

/// Blends `splats` (in drawing order) into `frame`, whose buffers are reused.
pub fn rasterize(splats: &[ProjectedSplat], bands: &BandLists, target: &Target, frame: &mut Frame) {
    prepare(frame, target);
    let tile_size = target.tile;
    split_bands(frame, target).into_par_iter().enumerate().for_each_init(
        Scratch::default,
        |Scratch { tiles, strip }, (index, mut band)| {
            let y = index as u32 * tile_size.height();
            let height = tile_size.height().min(target.height - y);
            tiles.fill(bands.band(index), target.width, tile_size);
            for (ranks, x) in tiles.lists().zip((0..).step_by(tile_size.width() as usize)) {
                let tile = TileRect { x, y, width: tile_size.width(), height };
                blend(splats, ranks, tile, target, strip, &mut band);
            }
        },
    );
}

fn blend(
    splats: &[ProjectedSplat],
    ranks: &[u32],
    tile: TileRect,
    target: &Target,
    strip: &mut Vec<StripSplat>,
    band: &mut Band<'_>,
) {
    let Outputs { depth, top_contributor } = target.outputs;
    dispatch!(target.level, simd => match (depth, top_contributor) {
        (false, false) => blend_tile::<_, false, false>(simd, splats, ranks, tile, strip, band),
        (true, false) => blend_tile::<_, true, false>(simd, splats, ranks, tile, strip, band),
        (false, true) => blend_tile::<_, false, true>(simd, splats, ranks, tile, strip, band),
        (true, true) => blend_tile::<_, true, true>(simd, splats, ranks, tile, strip, band),
    });
}

fn prepare(frame: &mut Frame, target: &Target) {
    let count = target.width as usize * target.height as usize;
    let Outputs { depth, top_contributor } = target.outputs;
    frame.width = target.width;
    frame.height = target.height;
    frame.color.resize(count, [0.0; 4]);
    frame.expected_depth.resize(if depth { count } else { 0 }, 0.0);
    frame.median_depth.resize(if depth { count } else { 0 }, 0.0);
    frame.top_contributor.resize(if top_contributor { count } else { 0 }, 0);
}

/// Cuts the images into bands; images that are not wanted give empty slices.
fn split_bands<'a>(frame: &'a mut Frame, target: &Target) -> Vec<Band<'a>> {
    let width = target.width as usize;
    let band_pixels = width * target.tile.height() as usize;
    let mut expected = frame.expected_depth.chunks_mut(band_pixels);
    let mut median = frame.median_depth.chunks_mut(band_pixels);
    let mut top = frame.top_contributor.chunks_mut(band_pixels);
    frame
        .color
        .chunks_mut(band_pixels)
        .map(|color| Band {
            width,
            color,
            expected_depth: expected.next().unwrap_or_default(),
            median_depth: median.next().unwrap_or_default(),
            top_contributor: top.next().unwrap_or_default(),
        })
        .collect()
}
