//! Blending the splats of one tile.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, mask32x16, u32x16};
use fearless_simd_macros::simd;
use trapeze_scene::NO_SPLAT;

use super::exp2::exp2;
use crate::bin::LANES;
use crate::project::ProjectedSplat;
use crate::reference::{ALPHA_MAX, TRANSMITTANCE_MIN};

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

/// Rows of a block: blended together.
///
/// One vector of pixels is a long chain of dependent operations (about a hundred cycles); four
/// side by side fill the processor, and their sums still fit in its registers.
const ROWS: usize = 4;

/// Rows of a strip: what depends on the row alone is computed for all of them in one vector.
const STRIP: usize = LANES;

/// A block of `ROWS` rows of sixteen pixels, in registers while it is blended.
struct Block<S: Simd> {
    /// T; 0 once a blend would have left too little, after which nothing has weight.
    transmittance: [f32x16<S>; ROWS],
    color: [[f32x16<S>; ROWS]; 3],
    /// Σ w, the alpha of the image.
    weight: [f32x16<S>; ROWS],
    weighted_depth: [f32x16<S>; ROWS],
    median_depth: [f32x16<S>; ROWS],
    top_weight: [f32x16<S>; ROWS],
    top: [u32x16<S>; ROWS],
}

/// A splat as one strip sees it.
#[derive(Clone, Copy, Default)]
pub(super) struct StripSplat {
    splat: ProjectedSplat,
    /// u12 dy of each row.
    shear: [f32; STRIP],
    /// (u22 dy)² of each row.
    across: [f32; STRIP],
    /// Bit r: row r meets the ellipse.
    rows: u32,
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
    for first_row in (0..rows).step_by(STRIP) {
        let y = lanes + (tile.y as usize + first_row) as f32;
        let strip = fill_strip(splats, ranks, y, strip);
        for block_row in (0..STRIP.min(rows - first_row)).step_by(ROWS) {
            let columns = (tile.x as usize..band.width).step_by(LANES);
            for column in columns.take(tile.width as usize / LANES) {
                let x = lanes + column as f32;
                let block = blend_block::<S, DEPTH, TOP>(simd, strip, x, block_row);
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

/// Collects the splats that meet a strip with row centres `y`, with what depends on the row alone.
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
    let mut used = 0;
    for &rank in ranks {
        // Written in place, and kept by moving on: entries are too large to be copied about.
        let entry = &mut strip[used];
        entry.splat = splats[rank as usize];
        let dy = y - entry.splat.y;
        let v2 = dy * entry.splat.u22;
        let across = v2 * v2;
        (dy * entry.splat.u12).store_array(&mut entry.shear);
        across.store_array(&mut entry.across);
        entry.rows = across.simd_le(entry.splat.cutoff()).to_bitmask() as u32;
        used += usize::from(entry.rows != 0);
    }
    &strip[..used]
}

/// Splats between two looks at whether a block has been filled up.
const FULL_CHECK_INTERVAL: usize = 8;

/// Blends one block: `x` are its columns, `first_row` its first row in the strip.
#[inline(always)]
fn blend_block<S: Simd, const DEPTH: bool, const TOP: bool>(
    simd: S,
    splats: &[StripSplat],
    x: f32x16<S>,
    first_row: usize,
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
    let row_bits = ((1 << ROWS) - 1) << first_row;
    for splats in splats.chunks(FULL_CHECK_INTERVAL) {
        for splat in splats {
            if splat.rows & row_bits != 0 {
                blend::<S, DEPTH, TOP>(simd, splat, x, first_row, &mut block);
            }
        }
        let mut left = block.transmittance[0];
        for r in 1..ROWS {
            left = left.max(block.transmittance[r]);
        }
        if !left.simd_gt(zero).any_true() {
            break;
        }
    }
    block
}

/// Blends one splat into a block.
///
/// α ≥ 1/255 is decided on the power, ‖U d‖² ≤ log₂(255 o): the same condition with less rounding.
/// Lanes where it does not hold compute along and get the weight 0.
#[inline(always)]
fn blend<S: Simd, const DEPTH: bool, const TOP: bool>(
    simd: S,
    strip: &StripSplat,
    x: f32x16<S>,
    first_row: usize,
    block: &mut Block<S>,
) {
    let splat = &strip.splat;
    let zero = f32x16::splat(simd, 0.0);
    let shear: &[f32; ROWS] = strip.shear[first_row..][..ROWS].try_into().expect("ROWS elements");
    let across: &[f32; ROWS] = strip.across[first_row..][..ROWS].try_into().expect("ROWS elements");
    let along = (x - splat.x) * splat.u11;
    let mut power = [zero; ROWS];
    let mut visible = [mask32x16::splat(simd, false); ROWS];
    let mut any = mask32x16::splat(simd, false);
    for r in 0..ROWS {
        let v1 = along + shear[r];
        power[r] = v1.mul_add(v1, across[r]);
        visible[r] = power[r].simd_le(splat.cutoff());
        any |= visible[r];
    }
    if !any.any_true() {
        return;
    }
    for r in 0..ROWS {
        power[r] = splat.log2_opacity - power[r];
    }
    let power_of_two = exp2(simd, power);
    for r in 0..ROWS {
        let before = block.transmittance[r];
        let alpha = power_of_two[r].min(ALPHA_MAX as f32);
        let full = visible[r].select(alpha * before, zero);
        let after = before - full;
        let stays_open = after.simd_gt(TRANSMITTANCE_MIN as f32);
        let weight = stays_open.select(full, zero);
        block.transmittance[r] = stays_open.select(after, zero);
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
