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
pub(super) struct TileRect {
    pub x: u32,
    /// First row, in the image. It is also the first row of the tile's band.
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

/// Rows that are blended together.
///
/// One vector of pixels is a long chain of dependent operations (about a hundred cycles); four
/// side by side fill the processor, and their sums still fit in its registers.
const ROWS: usize = 4;

/// A block of `ROWS` rows of sixteen pixels, in registers while it is blended.
struct Block<S: Simd> {
    transmittance: [f32x16<S>; ROWS],
    color: [[f32x16<S>; ROWS]; 3],
    /// Pixels that can still change.
    open: [mask32x16<S>; ROWS],
    weight: [f32x16<S>; ROWS],
    weighted_depth: [f32x16<S>; ROWS],
    median_depth: [f32x16<S>; ROWS],
    top_weight: [f32x16<S>; ROWS],
    top: [u32x16<S>; ROWS],
}

/// Blends the splats that touch a tile, in the order given, and writes the tile into its band.
///
/// Each pixel sees the operations of the reference in the reference's order: which block or tile
/// it is in changes nothing, so the image does not depend on the tile size.
#[simd]
pub(super) fn blend_tile<S: Simd, const DEPTH: bool, const TOP: bool>(
    simd: S,
    splats: &[ProjectedSplat],
    tile: TileRect,
    band: &mut Band<'_>,
) {
    let rows = tile.height as usize;
    let lanes = f32x16::from_fn(simd, |lane| lane as f32 + 0.5);
    for first_row in (0..rows).step_by(ROWS) {
        let y = (tile.y as usize + first_row) as f32 + 0.5;
        for column in (tile.x as usize..band.width).step_by(LANES).take(tile.width as usize / LANES)
        {
            let block = blend_block::<S, DEPTH, TOP>(simd, splats, lanes + column as f32, y);
            for r in 0..ROWS.min(rows - first_row) {
                let start = (first_row + r) * band.width + column;
                let count = LANES.min(band.width - column);
                store::<S, DEPTH, TOP>(simd, &block, r, start..start + count, band);
            }
        }
    }
}

/// Blends one block: `x` are its columns, `y` its first row, at the pixel centres.
#[inline(always)]
fn blend_block<S: Simd, const DEPTH: bool, const TOP: bool>(
    simd: S,
    splats: &[ProjectedSplat],
    x: f32x16<S>,
    y: f32,
) -> Block<S> {
    const HALF_HEIGHT: f32 = (ROWS - 1) as f32 / 2.0;
    let zero = f32x16::splat(simd, 0.0);
    let mut block = Block {
        transmittance: [f32x16::splat(simd, 1.0); ROWS],
        color: [[zero; ROWS]; 3],
        open: [mask32x16::splat(simd, true); ROWS],
        weight: [zero; ROWS],
        weighted_depth: [zero; ROWS],
        median_depth: [f32x16::splat(simd, f32::NAN); ROWS],
        top_weight: [zero; ROWS],
        top: [u32x16::splat(simd, NO_SPLAT); ROWS],
    };
    let mut centres = [f32x16::splat(simd, y); ROWS];
    for r in 0..ROWS {
        centres[r] += r as f32;
    }
    for splat in splats {
        // Outside the splat's box? A hundredth of a pixel covers the rounding of both sides.
        if (y + HALF_HEIGHT - splat.y).abs() > splat.half_height + (HALF_HEIGHT + 0.01) {
            continue;
        }
        let (power, visible) = power_and_visible(simd, splat, x, &centres, &block.open);
        let mut any = visible[0];
        for r in 1..ROWS {
            any |= visible[r];
        }
        if any.any_true() {
            let ended = blend::<S, DEPTH, TOP>(simd, splat, power, visible, &mut block);
            if ended && block.open.iter().all(|open| !open.any_true()) {
                break;
            }
        }
    }
    block
}

/// ‖U d‖² at the pixels of a block, and where the splat is visible in an open pixel.
///
/// α ≥ 1/255 is decided on the power, ‖U d‖² ≤ log₂(255 o): the same condition with less rounding.
#[inline(always)]
fn power_and_visible<S: Simd>(
    simd: S,
    splat: &ProjectedSplat,
    x: f32x16<S>,
    centres: &[f32x16<S>; ROWS],
    open: &[mask32x16<S>; ROWS],
) -> ([f32x16<S>; ROWS], [mask32x16<S>; ROWS]) {
    let mut power = *centres;
    let mut visible = *open;
    let along = (x - splat.x) * splat.u11;
    let (u12, u22) = (f32x16::splat(simd, splat.u12), f32x16::splat(simd, splat.u22));
    for r in 0..ROWS {
        let dy = centres[r] - splat.y;
        let v1 = dy.mul_add(u12, along);
        let v2 = dy * u22;
        power[r] = v1.mul_add(v1, v2 * v2);
        visible[r] = open[r] & power[r].simd_le(splat.cutoff());
    }
    (power, visible)
}

/// Blends one splat into the `visible` pixels of a block; returns whether that closed any of them.
/// Lanes that are not visible compute along and are left out of every sum.
#[inline(always)]
fn blend<S: Simd, const DEPTH: bool, const TOP: bool>(
    simd: S,
    splat: &ProjectedSplat,
    mut power: [f32x16<S>; ROWS],
    visible: [mask32x16<S>; ROWS],
    block: &mut Block<S>,
) -> bool {
    let zero = f32x16::splat(simd, 0.0);
    for r in 0..ROWS {
        power[r] = splat.log2_opacity - power[r];
    }
    let power_of_two = exp2(simd, power);
    let mut any_ended = mask32x16::splat(simd, false);
    for r in 0..ROWS {
        let before = block.transmittance[r];
        let full = power_of_two[r].min(ALPHA_MAX as f32) * before;
        let stays_open = (before - full).simd_gt(TRANSMITTANCE_MIN as f32);
        let weight = (visible[r] & stays_open).select(full, zero);
        let after = before - weight;
        block.transmittance[r] = after;
        for (channel, value) in block.color.iter_mut().zip(splat.color) {
            channel[r] = weight.mul_add(value, channel[r]);
        }
        if DEPTH {
            block.weight[r] += weight;
            block.weighted_depth[r] = weight.mul_add(splat.depth, block.weighted_depth[r]);
            let crosses = before.simd_gt(0.5) & after.simd_le(0.5);
            let depth = f32x16::splat(simd, splat.depth);
            block.median_depth[r] = crosses.select(depth, block.median_depth[r]);
        }
        if TOP {
            let wins = weight.simd_gt(block.top_weight[r]);
            block.top_weight[r] = wins.select(weight, block.top_weight[r]);
            block.top[r] = wins.select(u32x16::splat(simd, splat.index), block.top[r]);
        }
        let ended = visible[r] & !stays_open;
        block.open[r] &= !ended;
        any_ended |= ended;
    }
    any_ended.any_true()
}

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
    let alpha = f32x16::splat(simd, 1.0) - block.transmittance[r];
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
