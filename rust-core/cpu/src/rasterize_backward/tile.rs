//! The backward pass of one tile.

use fearless_simd::f32x16;
use fearless_simd::prelude::*;
use fearless_simd_macros::simd;

use super::reduce::sum_lanes;
use super::sums::LANES;
use crate::bin::BandEntry;
use crate::project::ProjectedSplat;
use crate::rasterize::TileRect;
use crate::rasterize::strip::{
    FULL_CHECK_INTERVAL, ROWS, RowTerms, STRIP, block_rows, cover, is_open, step,
};
use crate::reference::ALPHA_MAX;

/// What a band of tiles is computed from: rows of the frame and of the gradient.
#[derive(Clone, Copy)]
pub(super) struct BandPixels<'a> {
    /// Pixels per row.
    pub width: usize,
    /// What the forward pass showed: premultiplied r g b, alpha.
    pub color: &'a [[f32; 4]],
    /// Expected depth; empty where no gradient by it is given.
    pub depth: &'a [f32],
    /// ∂L/∂(r, g, b, alpha).
    pub by_color: &'a [[f32; 4]],
    /// ∂L/∂(expected depth); empty where it is zero.
    pub by_depth: &'a [f32],
}

/// A splat as one strip sees it.
#[derive(Clone, Copy, Default)]
pub(super) struct StripSplat {
    splat: ProjectedSplat,
    terms: RowTerms,
    /// Distance of each row from the centre.
    dy: [f32; STRIP],
    /// Where its sums are.
    position: u32,
}

/// The pixels of a block.
struct Block<S: Simd> {
    /// T, as in the forward pass.
    transmittance: [f32x16<S>; ROWS],
    /// Σ w v of the contributors that are still to come.
    behind: [f32x16<S>; ROWS],
    /// ∂L/∂ the sums Σ w r, Σ w g, Σ w b, Σ w.
    by_sums: [[f32x16<S>; ROWS]; 4],
    /// ∂L/∂ Σ w z.
    by_weighted_depth: [f32x16<S>; ROWS],
}

/// Adds what the pixels of a tile say to `sums`, the lanes of every splat of the band. `positions`
/// are the tile's splats by their place in `entries`.
#[simd]
pub(super) fn backward_tile<S: Simd, const DEPTH: bool>(
    simd: S,
    splats: &[ProjectedSplat],
    (entries, positions): (&[BandEntry], &[u32]),
    tile: TileRect,
    strip: &mut Vec<StripSplat>,
    pixels: &BandPixels<'_>,
    sums: &mut [[f32; LANES]],
) {
    let rows = tile.height as usize;
    let lanes = f32x16::from_fn(simd, |lane| lane as f32 + 0.5);
    for first_row in (0..rows).step_by(STRIP) {
        let y = lanes + (tile.y as usize + first_row) as f32;
        let strip = fill_strip(splats, entries, positions, y, strip);
        for block_row in (0..STRIP.min(rows - first_row)).step_by(ROWS) {
            let columns = (tile.x as usize..pixels.width).step_by(LANES);
            for column in columns.take(tile.width as usize / LANES) {
                let x = lanes + column as f32;
                let row = first_row + block_row;
                let block = load_block::<S, DEPTH>(simd, pixels, (row, rows), column);
                backward_block::<S, DEPTH>(simd, strip, x, block_row, block, sums);
            }
        }
    }
}

/// The splats of a tile for a strip with row centres `y`, with what depends on the row alone.
#[inline(always)]
fn fill_strip<'a, S: Simd>(
    splats: &[ProjectedSplat],
    entries: &[BandEntry],
    positions: &[u32],
    y: f32x16<S>,
    strip: &'a mut Vec<StripSplat>,
) -> &'a [StripSplat] {
    if strip.len() < positions.len() {
        strip.resize(positions.len(), StripSplat::default());
    }
    for (entry, &position) in strip.iter_mut().zip(positions) {
        entry.splat = splats[entries[position as usize].rank as usize];
        entry.position = position;
        let dy = y - entry.splat.y;
        dy.store_array(&mut entry.dy);
        entry.terms.fill(&entry.splat, dy);
    }
    &strip[..positions.len()]
}

/// Reads a block of the frame and of the gradient; pixels outside have T = 0 and so no part.
#[inline(always)]
fn load_block<S: Simd, const DEPTH: bool>(
    simd: S,
    pixels: &BandPixels<'_>,
    (first_row, rows): (usize, usize),
    column: usize,
) -> Block<S> {
    let zero = f32x16::splat(simd, 0.0);
    let mut block = Block {
        transmittance: [zero; ROWS],
        behind: [zero; ROWS],
        by_sums: [[zero; ROWS]; 4],
        by_weighted_depth: [zero; ROWS],
    };
    let count = LANES.min(pixels.width - column);
    let inside = f32x16::from_fn(simd, |lane| f32::from(u8::from(lane < count)));
    for r in 0..ROWS.min(rows - first_row) {
        let start = (first_row + r) * pixels.width + column;
        let [red, green, blue, alpha] = load_pixels(simd, &pixels.color[start..start + count]);
        let by = load_pixels(simd, &pixels.by_color[start..start + count]);
        let behind = by[0].mul_add(red, by[3] * alpha);
        block.behind[r] = by[2].mul_add(blue, by[1].mul_add(green, behind));
        block.transmittance[r] = inside;
        for (plane, by) in block.by_sums.iter_mut().zip(by) {
            plane[r] = by;
        }
        if DEPTH {
            // D = Z / W with Z = Σ w z and W = Σ w: ∂L/∂Z = g / W, ∂L/∂W = −g D / W. Together
            // they add nothing to Σ w v. Where nothing was hit D is not a number.
            let hit = alpha.simd_gt(zero);
            let depth = hit.select(load_row(simd, &pixels.depth[start..start + count]), zero);
            let by_depth = load_row(simd, &pixels.by_depth[start..start + count]);
            let by_weighted = hit.select(by_depth / alpha, zero);
            block.by_weighted_depth[r] = by_weighted;
            block.by_sums[3][r] -= by_weighted * depth;
        }
    }
    block
}

/// Up to sixteen pixels as planes; lanes beyond them are zero.
#[inline(always)]
fn load_pixels<S: Simd>(simd: S, pixels: &[[f32; 4]]) -> [f32x16<S>; 4] {
    let mut padded = [[0.0; 4]; LANES];
    let pixels: &[[f32; 4]; LANES] = match pixels.try_into() {
        Ok(whole) => whole,
        Err(_) => {
            padded[..pixels.len()].copy_from_slice(pixels);
            &padded
        }
    };
    let values = pixels.as_flattened();
    let quarter = |i: usize| f32x16::from_slice(simd, &values[i * LANES..(i + 1) * LANES]);
    // Two rounds turn pixels into planes: first red and blue from green and alpha.
    let (red_blue_0, green_alpha_0) = quarter(0).deinterleave(quarter(1));
    let (red_blue_1, green_alpha_1) = quarter(2).deinterleave(quarter(3));
    let (red, blue) = red_blue_0.deinterleave(red_blue_1);
    let (green, alpha) = green_alpha_0.deinterleave(green_alpha_1);
    [red, green, blue, alpha]
}

/// Up to sixteen values; lanes beyond them are zero.
#[inline(always)]
fn load_row<S: Simd>(simd: S, values: &[f32]) -> f32x16<S> {
    let mut padded = [0.0; LANES];
    padded[..values.len()].copy_from_slice(values);
    f32x16::load_array(simd, padded)
}

#[inline(always)]
fn backward_block<S: Simd, const DEPTH: bool>(
    simd: S,
    splats: &[StripSplat],
    x: f32x16<S>,
    first_row: usize,
    mut block: Block<S>,
    sums: &mut [[f32; LANES]],
) {
    for splats in splats.chunks(FULL_CHECK_INTERVAL) {
        for splat in splats {
            if splat.terms.meets_block(first_row) {
                backward_splat::<S, DEPTH>(simd, splat, x, first_row, &mut block, sums);
            }
        }
        if !is_open(simd, &block.transmittance) {
            break;
        }
    }
}

/// Blends one splat as the forward pass did, and adds up what its pixels say.
#[inline(always)]
fn backward_splat<S: Simd, const DEPTH: bool>(
    simd: S,
    strip: &StripSplat,
    x: f32x16<S>,
    first_row: usize,
    block: &mut Block<S>,
    sums: &mut [[f32; LANES]],
) {
    let splat = &strip.splat;
    let zero = f32x16::splat(simd, 0.0);
    let along = (x - splat.x) * splat.u11;
    let Some(coverage) = cover(simd, &strip.terms, along, first_row) else { return };
    let (v1, dy) = (&coverage.v1, block_rows(&strip.dy, first_row));
    let mut total = [zero; 10];
    for r in 0..ROWS {
        let step = step(simd, &coverage, r, block.transmittance[r]);
        let weight = step.weight;
        block.transmittance[r] = step.transmittance;

        let [by_red, by_green, by_blue, by_weight] = &block.by_sums;
        let mut value = by_red[r].mul_add(splat.color[0], by_weight[r]);
        value = by_green[r].mul_add(splat.color[1], value);
        value = by_blue[r].mul_add(splat.color[2], value);
        if DEPTH {
            value = block.by_weighted_depth[r].mul_add(splat.depth, value);
            total[9] = weight.mul_add(block.by_weighted_depth[r], total[9]);
        }
        let behind = block.behind[r] - weight * value;
        block.behind[r] = behind;
        // α·∂L/∂α = T α v − α·behind / (1 − α) = w·(v − behind / T after), since w = T α and
        // T after = T (1 − α).
        let inverse = reciprocal(simd, step.after);
        let q = weight * (value - behind * inverse);
        // Pixels that are not hit have no T after to divide by; at the clamp α is a constant.
        let below_clamp = coverage.unlimited_alpha[r].simd_lt(ALPHA_MAX as f32);
        let counts = coverage.visible[r] & step.stays_open & below_clamp;
        let q = counts.select(q, zero);

        total[0] = weight.mul_add(by_red[r], total[0]);
        total[1] = weight.mul_add(by_green[r], total[1]);
        total[2] = weight.mul_add(by_blue[r], total[2]);
        total[3] += q;
        total[4] = q.mul_add(dy[r], total[4]);
        total[5] = q.mul_add(dy[r] * dy[r], total[5]);
        let q_v = q * v1[r];
        total[6] += q_v;
        total[7] = q_v.mul_add(dy[r], total[7]);
        total[8] = q_v.mul_add(v1[r], total[8]);
    }
    let lanes = &mut sums[strip.position as usize];
    (f32x16::load_array(simd, *lanes) + sum_lanes(simd, total)).store_array(lanes);
}

/// 1 / x to about 2⁻²³ on x86 and 2⁻¹⁵ on Arm: the hardware's estimate and a Newton step. A division
/// takes as long as a third of everything else.
#[inline(always)]
fn reciprocal<S: Simd>(simd: S, x: f32x16<S>) -> f32x16<S> {
    let estimate = x.approximate_recip();
    let error = f32x16::splat(simd, 1.0) - x * estimate;
    error.mul_add(estimate, estimate)
}
