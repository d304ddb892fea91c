//! Blending the splats of one tile.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, u32x16};
use fearless_simd_macros::simd;
use trapeze_scene::NO_SPLAT;

use super::strip::{BATCH, Contributors, Lanes, ROWS, STRIP, Step, StripSplat, is_open, step};
use crate::bin::LANES;
use crate::project::ProjectedSplat;

/// The part of every image that one band of tiles covers; empty where an image is not wanted.
pub(super) struct Band<'a> {
    /// Pixels per row.
    pub width: usize,
    /// Premultiplied r g b and alpha.
    pub color: &'a mut [[f32; 4]],
    pub expected_depth: &'a mut [f32],
    pub median_depth: &'a mut [f32],
    pub top_contributor: &'a mut [u32],
}

/// Position and size of a tile, in pixels; `width` is a multiple of 16 and may reach over the edge
/// of the image.
#[derive(Clone, Copy)]
pub(crate) struct TileRect {
    pub x: u32,
    /// First row, in the image. It is also the first row of the tile's band.
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

/// A block of `ROWS` rows of sixteen pixels, in registers while it is blended.
struct Block<S: Simd> {
    /// T; 0 in pixels that are closed.
    transmittance: [f32x16<S>; ROWS],
    color: [[f32x16<S>; ROWS]; 3],
    /// Σ w, the alpha of the image.
    weight: [f32x16<S>; ROWS],
    weighted_depth: [f32x16<S>; ROWS],
    median_depth: [f32x16<S>; ROWS],
    top_weight: [f32x16<S>; ROWS],
    top: [u32x16<S>; ROWS],
}

/// Blends the splats that touch a tile, in the order given, and writes the tile into its band.
///
/// Each pixel sees the operations of the reference in the reference's order: which block, strip or
/// tile it is in changes nothing, so the image does not depend on the tile size.
#[simd]
pub(super) fn blend_tile<S: Simd, const DEPTH: bool, const TOP: bool>(
    simd: S,
    splats: &[ProjectedSplat],
    ranks: &[u32],
    tile: TileRect,
    strip: &mut Vec<StripSplat>,
    band: &mut Band<'_>,
) {
    let rows = tile.height as usize;
    let lanes = f32x16::from_fn(simd, |lane| lane as f32 + 0.5);
    let mut contributors = Contributors::default();
    for first_row in (0..rows).step_by(STRIP) {
        let y = lanes + (tile.y as usize + first_row) as f32;
        let strip = fill_strip(splats, ranks, y, strip);
        for block_row in (0..STRIP.min(rows - first_row)).step_by(ROWS) {
            let columns = (tile.x as usize..band.width).step_by(LANES);
            for column in columns.take(tile.width as usize / LANES) {
                let x = lanes + column as f32;
                let block =
                    blend_block::<S, DEPTH, TOP>(simd, strip, x, block_row, &mut contributors);
                let first_row = first_row + block_row;
                for r in 0..ROWS.min(rows - first_row) {
                    let start = (first_row + r) * band.width + column;
                    let count = LANES.min(band.width - column);
                    store::<S, DEPTH, TOP>(simd, &block, r, start..start + count, band);
                }
            }
        }
    }
}

/// The splats of a tile for a strip with row centres `y`, with what depends on the row alone.
///
/// All of them: the few that miss the strip are passed over by every block. Leaving them out here
/// would make the place of each entry wait for the one before it.
#[inline(always)]
fn fill_strip<'a, S: Simd>(
    splats: &[ProjectedSplat],
    ranks: &[u32],
    y: f32x16<S>,
    strip: &'a mut Vec<StripSplat>,
) -> &'a [StripSplat] {
    if strip.len() < ranks.len() {
        strip.resize(ranks.len(), StripSplat::default());
    }
    for (entry, &rank) in strip.iter_mut().zip(ranks) {
        let splat = &splats[rank as usize];
        entry.fill(splat, splat.index, y - splat.y);
    }
    &strip[..ranks.len()]
}

/// Blends one block: `x` are its columns, `first_row` its first row in the strip.
#[inline(always)]
fn blend_block<S: Simd, const DEPTH: bool, const TOP: bool>(
    simd: S,
    splats: &[StripSplat],
    x: f32x16<S>,
    first_row: usize,
    contributors: &mut Contributors,
) -> Block<S> {
    let zero = f32x16::splat(simd, 0.0);
    let mut block = Block {
        transmittance: [f32x16::splat(simd, 1.0); ROWS],
        color: [[zero; ROWS]; 3],
        weight: [zero; ROWS],
        weighted_depth: [zero; ROWS],
        median_depth: [f32x16::splat(simd, f32::NAN); ROWS],
        top_weight: [zero; ROWS],
        top: [u32x16::splat(simd, NO_SPLAT); ROWS],
    };
    for batch in splats.chunks(BATCH) {
        contributors.find(simd, batch, x, first_row);
        for (place, alphas) in contributors.iter() {
            blend::<S, DEPTH, TOP>(simd, &batch[place], alphas, &mut block);
        }
        if !is_open(simd, &block.transmittance) {
            break;
        }
    }
    block
}

/// Blends one splat into a block. Lanes that do not see it compute along and get the weight 0.
#[inline(always)]
fn blend<S: Simd, const DEPTH: bool, const TOP: bool>(
    simd: S,
    splat: &StripSplat,
    alphas: &[Lanes; ROWS],
    block: &mut Block<S>,
) {
    for r in 0..ROWS {
        let before = block.transmittance[r];
        let Step { weight, after, transmittance, stays_open } =
            step(simd, alphas[r].load(simd), before);
        block.transmittance[r] = transmittance;
        block.weight[r] += weight;
        for (channel, value) in block.color.iter_mut().zip(splat.color) {
            channel[r] = weight.mul_add(value, channel[r]);
        }
        if DEPTH {
            block.weighted_depth[r] = weight.mul_add(splat.depth, block.weighted_depth[r]);
            // A pixel that this splat closes keeps its T; it does not cross anything.
            let crosses = stays_open & before.simd_gt(0.5) & after.simd_le(0.5);
            let depth = f32x16::splat(simd, splat.depth);
            block.median_depth[r] = crosses.select(depth, block.median_depth[r]);
        }
        if TOP {
            let wins = weight.simd_gt(block.top_weight[r]);
            block.top_weight[r] = wins.select(weight, block.top_weight[r]);
            block.top[r] = wins.select(u32x16::splat(simd, splat.index), block.top[r]);
        }
    }
}

/// Largest alpha of a pixel: 1 − 10⁻⁴, rounded down.
const MAX_IMAGE_ALPHA: f32 = 0.999_9;

/// Writes row `r` of a block to the pixels `range` of a band.
#[inline(always)]
fn store<S: Simd, const DEPTH: bool, const TOP: bool>(
    simd: S,
    block: &Block<S>,
    r: usize,
    range: std::ops::Range<usize>,
    band: &mut Band<'_>,
) {
    let count = range.len();
    // T stays above its minimum by rule; rounding in the sum of weights must not say otherwise.
    let alpha = block.weight[r].min(f32x16::splat(simd, MAX_IMAGE_ALPHA));
    // Two rounds of interleaving turn four planes into pixels.
    let [red, green, blue] = [block.color[0][r], block.color[1][r], block.color[2][r]];
    let (red_blue, green_alpha) = (red.interleave(blue), green.interleave(alpha));
    let (a, b) = red_blue.0.interleave(green_alpha.0);
    let (c, d) = red_blue.1.interleave(green_alpha.1);
    let out = band.color[range.clone()].as_flattened_mut();
    for (quarter, vector) in out.chunks_mut(LANES).zip([a, b, c, d]) {
        if quarter.len() == LANES {
            vector.store_slice(quarter);
        } else {
            quarter.copy_from_slice(&vector.as_slice()[..quarter.len()]);
        }
    }
    if DEPTH {
        // Where nothing was hit this is 0 / 0, the NaN that is asked for.
        let expected = block.weighted_depth[r] / block.weight[r];
        band.expected_depth[range.clone()].copy_from_slice(&expected.as_slice()[..count]);
        let median = block.median_depth[r];
        band.median_depth[range.clone()].copy_from_slice(&median.as_slice()[..count]);
    }
    if TOP {
        band.top_contributor[range].copy_from_slice(&block.top[r].as_slice()[..count]);
    }
}
