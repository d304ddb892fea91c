//! The row kernels of the loss, at the processor's own vector width.
//!
//! A *plane* row holds [`PAD`] zeros, the image row, zeros up to a multiple of [`COLUMN_BLOCK`], and
//! [`PAD`] zeros again, so that windows read past the ends without a branch. The passes work on a
//! *tile* of columns at a time, going down: a vertical pass reads a [`Window`] of rows, the tile and
//! [`PAD`] columns on both sides, and writes [`TileRows`], which a horizontal pass reads. Their
//! sizes are constants, so nothing is checked in the inner loops, and at 128 columns they stay in a
//! first-level cache of 32 KiB.
//!
//! Inside these kernels there are no closures and no iterator adaptors around vector operations:
//! what the compiler does not inline loses the instruction set, and then every operation is a call.
//!
//! Where the render equals the target the loss and its gradient are exactly zero: every expression
//! that cancels there is built from products and sums in the same order on both sides, without
//! fused multiply-adds.

use fearless_simd::prelude::*;
use fearless_simd::{Select, Simd};
use fearless_simd_macros::simd;

use super::reference::{C1, C2};
use super::window::{RADIUS, TAPS};

/// Rows that one vertical pass produces: each loaded value serves up to four windows.
pub(super) const ROWS: usize = 4;
/// Rows that one vertical pass reads.
pub(super) const WINDOW_ROWS: usize = TAPS + ROWS - 1;
/// Columns on each side of a tile: at least the window's radius, and a whole vector.
pub(super) const PAD: usize = 16;
/// Columns of a tile.
pub(super) const TILE: usize = 128;
/// Floats of a tile row.
pub(super) const TILE_ROW: usize = TILE + 2 * PAD;

/// Multiple of every vector width, and the lanes of a row sum.
pub(super) const COLUMN_BLOCK: usize = 16;

/// The rows of one plane that a vertical pass reads.
pub(super) type Window<'a> = [&'a [f32; TILE_ROW]; WINDOW_ROWS];
/// What a vertical pass writes for one plane.
pub(super) type TileRows = [[f32; TILE_ROW]; ROWS];

/// Runs a block for each row of a vertical pass: apart for the first rows, which are not in all
/// windows yet, for those that are in all, and for the last. With fixed trip counts the compiler
/// unrolls each part, drops the conditions of [`add_row`] and keeps the sums in registers.
macro_rules! for_each_window_row {
    ($i:ident => $body:block) => {
        for $i in 0..ROWS - 1 $body
        for $i in ROWS - 1..TAPS $body
        for $i in TAPS..WINDOW_ROWS $body
    };
}

/// Vertical windows of x, y, x² + y² and xy for [`ROWS`] rows. Only the sum of the squares enters
/// SSIM.
#[simd]
pub(super) fn statistics_down<S: Simd>(
    simd: S,
    weights: &[f32; TAPS],
    [x, y]: [Window<'_>; 2],
    out: &mut [&mut TileRows; 4],
) {
    let weights = splat_all(simd, weights);
    for column in (0..TILE_ROW).step_by(S::f32s::LEN) {
        let mut sums = [[S::f32s::splat(simd, 0.0); 4]; ROWS];
        for_each_window_row!(i => {
            let x = load(simd, x[i], column);
            let y = load(simd, y[i], column);
            add_row(&mut sums, [x, y, x * x + y * y, x * y], &weights, i);
        });
        store_rows(&sums, column, out);
    }
}

/// Vertical windows of three planes, likewise.
#[simd]
pub(super) fn derivatives_down<S: Simd>(
    simd: S,
    weights: &[f32; TAPS],
    [a, b, c]: [Window<'_>; 3],
    out: &mut [&mut TileRows; 3],
) {
    let weights = splat_all(simd, weights);
    for column in (0..TILE_ROW).step_by(S::f32s::LEN) {
        let mut sums = [[S::f32s::splat(simd, 0.0); 3]; ROWS];
        for_each_window_row!(i => {
            let a = load(simd, a[i], column);
            let b = load(simd, b[i], column);
            let c = load(simd, c[i], column);
            add_row(&mut sums, [a, b, c], &weights, i);
        });
        store_rows(&sums, column, out);
    }
}

/// Adds row `i` of a vertical pass to the windows that it belongs to.
#[inline(always)]
fn add_row<S: Simd, V: SimdFloat<S, Element = f32>, const PLANES: usize>(
    sums: &mut [[V; PLANES]; ROWS],
    values: [V; PLANES],
    weights: &[V; RADIUS + 1],
    i: usize,
) {
    for r in 0..ROWS {
        if r <= i && i < r + TAPS {
            for plane in 0..PLANES {
                sums[r][plane] = values[plane].mul_add(weights[mirrored(i - r)], sums[r][plane]);
            }
        }
    }
}

/// Writes the windows of a vertical pass at `column` to their tile rows.
#[inline(always)]
fn store_rows<S: Simd, V: SimdFloat<S, Element = f32>, const PLANES: usize>(
    sums: &[[V; PLANES]; ROWS],
    column: usize,
    out: &mut [&mut TileRows; PLANES],
) {
    for r in 0..ROWS {
        for plane in 0..PLANES {
            sums[r][plane].store_slice(&mut out[plane][r][column..column + V::LEN]);
        }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, plane: &[f32], at: usize) -> S::f32s {
    S::f32s::from_slice(simd, &plane[at..at + S::f32s::LEN])
}

/// The distinct weights, outermost first: the window is symmetric, and registers are scarce.
#[inline(always)]
fn splat_all<S: Simd>(simd: S, weights: &[f32; TAPS]) -> [S::f32s; RADIUS + 1] {
    let mut all = [S::f32s::splat(simd, 0.0); RADIUS + 1];
    for tap in 0..=RADIUS {
        all[tap] = S::f32s::splat(simd, weights[tap]);
    }
    all
}

/// Index of the weight of `tap` among the distinct ones.
#[inline(always)]
fn mirrored(tap: usize) -> usize {
    if tap <= RADIUS { tap } else { TAPS - 1 - tap }
}

/// The horizontal window at `column` of the tile of a tile row.
#[inline(always)]
fn blur_across<S: Simd>(
    simd: S,
    weights: &[S::f32s; RADIUS + 1],
    row: &[f32; TILE_ROW],
    column: usize,
) -> S::f32s {
    let window = &row[PAD - RADIUS + column..][..S::f32s::LEN + 2 * RADIUS];
    // Two sums: one chain of eleven dependent additions would set the pace.
    let mut even = load(simd, window, 0) * weights[0];
    let mut odd = load(simd, window, 1) * weights[1];
    for tap in 1..=RADIUS {
        even = load(simd, window, 2 * tap).mul_add(weights[mirrored(2 * tap)], even);
    }
    for tap in 1..RADIUS {
        odd = load(simd, window, 2 * tap + 1).mul_add(weights[mirrored(2 * tap + 1)], odd);
    }
    even + odd
}

/// What [`similarity_across`] writes for one row of a tile.
pub(super) struct SimilarityRow<'a> {
    /// 1 − SSIM.
    pub(super) dissimilarity: &'a mut [f32],
    /// Derivatives of SSIM by the windowed means of x, x² and xy.
    pub(super) derivatives: [&'a mut [f32]; 3],
}

/// SSIM of one row of a tile from the tile rows of its four statistics; see
/// [`reference`](super::reference) for the formulas.
#[simd]
pub(super) fn similarity_across<S: Simd>(
    simd: S,
    weights: &[f32; TAPS],
    statistics: [&[f32; TILE_ROW]; 4],
    out: SimilarityRow<'_>,
) {
    let weights = splat_all(simd, weights);
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let (c1, c2) = (S::f32s::splat(simd, C1 as f32), S::f32s::splat(simd, C2 as f32));
    let [of_x, of_y, of_squares, of_product] = statistics;
    let [out_a, out_b, out_c] = out.derivatives;
    for column in (0..out.dissimilarity.len()).step_by(S::f32s::LEN) {
        let mx = blur_across(simd, &weights, of_x, column);
        let my = blur_across(simd, &weights, of_y, column);
        let squares = blur_across(simd, &weights, of_squares, column);
        let product = blur_across(simd, &weights, of_product, column);
        let (mxx, myy, mxy) = (mx * mx, my * my, mx * my);
        let means = mxx + myy;
        // Rounding can break 0 ≤ 2|cov| ≤ var by a little; without these bounds a bright enough
        // pair of windows would divide by zero.
        let variance = (squares - means).max(zero);
        let half = variance * 0.5;
        let covariance = (product - mxy).max(-half).min(half);
        let n1 = mxy + mxy + c1;
        let n2 = covariance + covariance + c2;
        let d1 = means + c1;
        let d2 = variance + c2;
        let (numerator, denominator) = (n1 * n2, d1 * d2);
        let inverse = one / denominator;
        // Exactly 0, and so S exactly 1, where x = y.
        let dissimilarity = (denominator - numerator) * inverse;
        let s = one - dissimilarity;
        let twice = inverse + inverse;
        let lanes = column..column + S::f32s::LEN;
        dissimilarity.store_slice(&mut out.dissimilarity[lanes.clone()]);
        (twice * (my * (n2 - n1) - mx * (s * (d2 - d1)))).store_slice(&mut out_a[lanes.clone()]);
        (-(s * d1) * inverse).store_slice(&mut out_b[lanes.clone()]);
        (twice * n1).store_slice(&mut out_c[lanes]);
    }
}

/// What each part of the loss adds to the gradient per pixel and channel.
#[derive(Clone, Copy)]
pub(super) struct GradientScale {
    /// (1 − λ) / (3·W·H).
    pub(super) l1: f32,
    /// λ / (3·W·H).
    pub(super) ssim: f32,
}

/// The gradient by x of one row of a tile, from the tile rows of the three blurred derivatives.
/// It takes the place of x, which is not needed any more.
#[simd]
pub(super) fn gradient_across<S: Simd>(
    simd: S,
    weights: &[f32; TAPS],
    derivatives: [&[f32; TILE_ROW]; 3],
    x_to_gradient: &mut [f32],
    y: &[f32],
    scale: GradientScale,
) {
    let weights = splat_all(simd, weights);
    let zero = S::f32s::splat(simd, 0.0);
    let (l1, ssim) = (S::f32s::splat(simd, scale.l1), S::f32s::splat(simd, scale.ssim));
    let [by_mean, by_square, by_product] = derivatives;
    for column in (0..y.len()).step_by(S::f32s::LEN) {
        let (x, y) = (load(simd, x_to_gradient, column), load(simd, y, column));
        let a = blur_across(simd, &weights, by_mean, column);
        let b = blur_across(simd, &weights, by_square, column);
        let c = blur_across(simd, &weights, by_product, column);
        let by_similarity = a + (x * (b + b) + y * c);
        let difference = x - y;
        let falling = difference.simd_lt(zero).select(-l1, zero);
        let by_l1 = difference.simd_gt(zero).select(l1, falling);
        (by_l1 - ssim * by_similarity)
            .store_slice(&mut x_to_gradient[column..column + S::f32s::LEN]);
    }
}

/// Σ|x − y| over a row, in [`COLUMN_BLOCK`] partial sums whatever the vector width.
#[simd]
pub(super) fn sum_of_differences<S: Simd>(_: S, x: &[f32], y: &[f32]) -> f64 {
    let mut sums = [0.0f32; COLUMN_BLOCK];
    for (x, y) in x.chunks_exact(COLUMN_BLOCK).zip(y.chunks_exact(COLUMN_BLOCK)) {
        for lane in 0..COLUMN_BLOCK {
            sums[lane] += (x[lane] - y[lane]).abs();
        }
    }
    sums.iter().copied().map(f64::from).sum()
}

/// Σ values, as [`sum_of_differences`].
#[simd]
pub(super) fn sum<S: Simd>(_: S, values: &[f32]) -> f64 {
    let mut sums = [0.0f32; COLUMN_BLOCK];
    for values in values.chunks_exact(COLUMN_BLOCK) {
        for lane in 0..COLUMN_BLOCK {
            sums[lane] += values[lane];
        }
    }
    sums.iter().copied().map(f64::from).sum()
}
