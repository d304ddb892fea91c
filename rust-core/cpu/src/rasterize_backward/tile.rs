//! The backward pass of one tile.

use fearless_simd::f32x16;
use fearless_simd::prelude::*;
use fearless_simd_macros::simd;

use super::reduce::sum_lanes;
use super::sums::{LANES, SUMS};
use crate::bin::BandEntry;
use crate::project::ProjectedSplat;
use crate::rasterize::TileRect;
use crate::rasterize::strip::{
    BATCH, Contributors, Lanes, ROWS, STRIP, StripSplat, block_rows, is_open, step,
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

/// A block of `ROWS` rows of sixteen pixels.
#[derive(Debug, Default)]
struct Block {
    /// First row in the strip.
    first_row: usize,
    /// First column in the image.
    column: usize,
    /// Whether a pixel can still take weight.
    is_open: bool,
    /// T, as in the forward pass.
    transmittance: [Lanes; ROWS],
    /// Σ w v of the contributors that are still to come.
    behind: [Lanes; ROWS],
    /// ∂L/∂ the sums Σ w r, Σ w g, Σ w b, Σ w.
    by_sums: [[Lanes; ROWS]; 4],
    /// ∂L/∂ Σ w z.
    by_weighted_depth: [Lanes; ROWS],
}

/// What the pixels of a tile say about one splat, a sum in each lane: the fields of
/// [`SplatSums`](super::SplatSums) in their order.
type Totals = [Lanes; SUMS];

/// Working memory of a tile: what its blocks and a batch of splats need fits into a first-level
/// cache.
#[derive(Default)]
pub(super) struct TileMemory {
    batch: [StripSplat; BATCH],
    /// Distance of each row from the centre of each splat.
    dy: [[f32; STRIP]; BATCH],
    /// Zero between batches.
    totals: [Totals; BATCH],
    contributors: Contributors,
    blocks: Vec<Block>,
}

/// Adds what the pixels of a tile say to `sums`, the lanes of every splat of the band. `positions`
/// are the tile's splats by their place in `entries`.
///
/// A batch of splats goes over all blocks of a strip before the next one is looked at, so that the
/// lanes of a splat are summed once for all of them.
#[simd]
pub(super) fn backward_tile<S: Simd, const DEPTH: bool>(
    simd: S,
    splats: &[ProjectedSplat],
    (entries, positions): (&[BandEntry], &[u32]),
    tile: TileRect,
    memory: &mut TileMemory,
    pixels: &BandPixels<'_>,
    sums: &mut [[f32; LANES]],
) {
    let rows = tile.height as usize;
    let lanes = f32x16::from_fn(simd, |lane| lane as f32 + 0.5);
    for first_row in (0..rows).step_by(STRIP) {
        let y = lanes + (tile.y as usize + first_row) as f32;
        let TileMemory { batch, dy, totals, contributors, blocks } = &mut *memory;
        blocks.clear();
        for block_row in (0..STRIP.min(rows - first_row)).step_by(ROWS) {
            let columns = (tile.x as usize..pixels.width).step_by(LANES);
            for column in columns.take(tile.width as usize / LANES) {
                let at = (first_row + block_row, rows);
                let block = load_block::<S, DEPTH>(simd, pixels, at, column);
                blocks.push(Block { first_row: block_row, ..block });
            }
        }
        for positions in positions.chunks(BATCH) {
            for ((entry, dy), &position) in batch.iter_mut().zip(&mut *dy).zip(positions) {
                let splat = &splats[entries[position as usize].rank as usize];
                let distance = y - splat.y;
                distance.store_array(dy);
                entry.fill(splat, position, distance);
            }
            let batch = &batch[..positions.len()];
            let mut any_open = false;
            for block in blocks.iter_mut().filter(|block| block.is_open) {
                let x = lanes + block.column as f32;
                contributors.find(simd, batch, x, block.first_row);
                backward_block::<S, DEPTH>(simd, (batch, dy), contributors, x, block, totals);
                any_open |= block.is_open;
            }
            for (splat, totals) in batch.iter().zip(&mut *totals) {
                let lanes = &mut sums[splat.index as usize];
                (f32x16::load_array(simd, *lanes) + take_sums(simd, totals)).store_array(lanes);
            }
            if !any_open {
                break;
            }
        }
    }
}

/// The sums across the lanes, in the order of the vectors; leaves zeros.
#[inline(always)]
fn take_sums<S: Simd>(simd: S, totals: &mut Totals) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let mut vectors = [zero; SUMS];
    for i in 0..SUMS {
        vectors[i] = totals[i].load(simd);
        totals[i].store(zero);
    }
    sum_lanes(simd, vectors)
}

/// Reads a block of the frame and of the gradient; pixels outside have T = 0 and so no part.
#[inline(always)]
fn load_block<S: Simd, const DEPTH: bool>(
    simd: S,
    pixels: &BandPixels<'_>,
    (first_row, rows): (usize, usize),
    column: usize,
) -> Block {
    let zero = f32x16::splat(simd, 0.0);
    let mut block = Block { column, is_open: true, ..Block::default() };
    let count = LANES.min(pixels.width - column);
    let inside = f32x16::from_fn(simd, |lane| f32::from(u8::from(lane < count)));
    for r in 0..ROWS.min(rows - first_row) {
        let start = (first_row + r) * pixels.width + column;
        let [red, green, blue, alpha] = load_pixels(simd, &pixels.color[start..start + count]);
        let mut by = load_pixels(simd, &pixels.by_color[start..start + count]);
        let behind = by[0].mul_add(red, by[3] * alpha);
        block.behind[r].store(by[2].mul_add(blue, by[1].mul_add(green, behind)));
        block.transmittance[r].store(inside);
        if DEPTH {
            // D = Z / W with Z = Σ w z and W = Σ w: ∂L/∂Z = g / W, ∂L/∂W = −g D / W. Together
            // they add nothing to Σ w v. Where nothing was hit D is not a number.
            let hit = alpha.simd_gt(zero);
            let depth = hit.select(load_row(simd, &pixels.depth[start..start + count]), zero);
            let by_depth = load_row(simd, &pixels.by_depth[start..start + count]);
            let by_weighted = hit.select(by_depth / alpha, zero);
            block.by_weighted_depth[r].store(by_weighted);
            by[3] -= by_weighted * depth;
        }
        for (plane, by) in block.by_sums.iter_mut().zip(by) {
            plane[r].store(by);
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

/// Blends the contributors of a batch as the forward pass did, and adds up what their pixels say.
#[inline(always)]
fn backward_block<S: Simd, const DEPTH: bool>(
    simd: S,
    (batch, dy): (&[StripSplat], &[[f32; STRIP]; BATCH]),
    contributors: &Contributors,
    x: f32x16<S>,
    block: &mut Block,
    totals: &mut [Totals; BATCH],
) {
    let zero = f32x16::splat(simd, 0.0);
    let mut transmittance = [zero; ROWS];
    let mut behind = [zero; ROWS];
    for r in 0..ROWS {
        transmittance[r] = block.transmittance[r].load(simd);
        behind[r] = block.behind[r].load(simd);
    }
    for (place, alphas) in contributors.iter() {
        let (splat, totals) = (&batch[place], &mut totals[place]);
        let v1 = splat.first_component(x, block.first_row);
        let dy = block_rows(&dy[place], block.first_row);
        let mut total = [zero; SUMS];
        for i in 0..SUMS {
            total[i] = totals[i].load(simd);
        }
        for r in 0..ROWS {
            let alpha = alphas[r].load(simd);
            let step = step(simd, alpha, transmittance[r]);
            let weight = step.weight;
            transmittance[r] = step.transmittance;

            let [by_red, by_green, by_blue, by_weight] =
                block.by_sums.each_ref().map(|plane| plane[r].load(simd));
            let mut value = by_red.mul_add(splat.color[0], by_weight);
            value = by_green.mul_add(splat.color[1], value);
            value = by_blue.mul_add(splat.color[2], value);
            if DEPTH {
                let by_weighted_depth = block.by_weighted_depth[r].load(simd);
                value = by_weighted_depth.mul_add(splat.depth, value);
                total[9] = weight.mul_add(by_weighted_depth, total[9]);
            }
            behind[r] = (-weight).mul_add(value, behind[r]);
            // α·∂L/∂α = T α v − α·behind / (1 − α) = w·(v − behind / T after), since w = T α and
            // T after = T (1 − α).
            let inverse = reciprocal(simd, step.after);
            let q = weight * (-behind[r]).mul_add(inverse, value);
            // Pixels that are full have no T after to divide by; at the clamp α is a constant.
            let counts = step.stays_open & alpha.simd_lt(ALPHA_MAX as f32);
            let q = counts.select(q, zero);

            total[0] = weight.mul_add(by_red, total[0]);
            total[1] = weight.mul_add(by_green, total[1]);
            total[2] = weight.mul_add(by_blue, total[2]);
            total[3] += q;
            let q_dy = q * dy[r];
            total[4] += q_dy;
            total[5] = q_dy.mul_add(dy[r], total[5]);
            let q_v = q * v1[r];
            total[6] += q_v;
            total[7] = q_v.mul_add(dy[r], total[7]);
            total[8] = q_v.mul_add(v1[r], total[8]);
        }
        for i in 0..SUMS {
            if DEPTH || i != 9 {
                totals[i].store(total[i]);
            }
        }
    }
    for r in 0..ROWS {
        block.transmittance[r].store(transmittance[r]);
        block.behind[r].store(behind[r]);
    }
    block.is_open = is_open(simd, &transmittance);
}

/// 1 / x to about 2⁻²³ on x86 and 2⁻¹⁵ on Arm: the hardware's estimate and a Newton step. A division
/// takes as long as a third of everything else.
#[inline(always)]
fn reciprocal<S: Simd>(simd: S, x: f32x16<S>) -> f32x16<S> {
    let estimate = x.approximate_recip();
    let error = (-x).mul_add(estimate, f32x16::splat(simd, 1.0));
    error.mul_add(estimate, estimate)
}
