//! What the forward and the backward pass of a tile do alike: which pixels a splat reaches, and
//! how much of it each of them shows. Both passes go through this file, so both make the same
//! decisions from the same bits.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, mask32x16};

use super::exp2::exp2;
use crate::bin::LANES;
use crate::project::{LOG2_ALPHA_MIN, ProjectedSplat};
use crate::reference::{ALPHA_MAX, TRANSMITTANCE_MIN};

/// Rows of a block: blended together.
///
/// One vector of pixels is a long chain of dependent operations (about a hundred cycles); four
/// side by side fill the processor, and their sums still fit in its registers.
pub(crate) const ROWS: usize = 4;

/// Rows of a strip: what depends on the row alone is computed for all of them in one vector.
pub(crate) const STRIP: usize = LANES;

/// Splats between two looks at whether a block has been filled up.
pub(crate) const FULL_CHECK_INTERVAL: usize = 8;

/// What depends on a splat and the rows of a strip alone.
#[derive(Clone, Copy, Default)]
pub(crate) struct RowTerms {
    /// u12 dy of each row.
    shear: [f32; STRIP],
    /// log₂ o − (u22 dy)² of each row: the largest exponent of α in it.
    exponent: [f32; STRIP],
    /// Bit r: row r meets the ellipse.
    rows: u32,
}

impl RowTerms {
    /// The terms for rows at the distances `dy` from the splat's centre, pixels.
    #[inline(always)]
    pub(crate) fn fill<S: Simd>(&mut self, splat: &ProjectedSplat, dy: f32x16<S>) {
        let v2 = dy * splat.u22;
        let exponent = (-v2).mul_add(v2, splat.log2_opacity);
        (dy * splat.u12).store_array(&mut self.shear);
        exponent.store_array(&mut self.exponent);
        self.rows = exponent.simd_ge(LOG2_ALPHA_MIN).to_bitmask() as u32;
    }

    /// Whether it meets one of the rows of the block that begins with row `first_row`.
    #[inline(always)]
    pub(crate) fn meets_block(&self, first_row: usize) -> bool {
        self.rows & (((1 << ROWS) - 1) << first_row) != 0
    }
}

/// A splat on the pixels of a block.
pub(crate) struct Coverage<S: Simd> {
    /// First component of U d, u11 dx + u12 dy.
    pub v1: [f32x16<S>; ROWS],
    /// o·2^(−‖U d‖²), not yet limited; any number where the splat is not visible.
    pub unlimited_alpha: [f32x16<S>; ROWS],
    /// α ≥ 1/255, decided on the exponent: the same condition with less rounding.
    pub visible: [mask32x16<S>; ROWS],
}

/// Evaluates a splat in the block that begins with row `first_row` of the strip; `along` is u11 dx
/// of its columns. `None` where no pixel sees it.
#[inline(always)]
pub(crate) fn cover<S: Simd>(
    simd: S,
    terms: &RowTerms,
    along: f32x16<S>,
    first_row: usize,
) -> Option<Coverage<S>> {
    let zero = f32x16::splat(simd, 0.0);
    let shear = block_rows(&terms.shear, first_row);
    let row_exponent = block_rows(&terms.exponent, first_row);
    let mut v1 = [zero; ROWS];
    let mut exponent = [zero; ROWS];
    let mut visible = [mask32x16::splat(simd, false); ROWS];
    let mut any = mask32x16::splat(simd, false);
    for r in 0..ROWS {
        v1[r] = along + shear[r];
        exponent[r] = (-v1[r]).mul_add(v1[r], row_exponent[r]);
        visible[r] = exponent[r].simd_ge(LOG2_ALPHA_MIN);
        any |= visible[r];
    }
    if !any.any_true() {
        return None;
    }
    // Not in a closure, which would be compiled without the SIMD level's instructions.
    Some(Coverage { v1, unlimited_alpha: exp2(simd, exponent), visible })
}

/// The values of a block's rows among those of its strip.
#[inline(always)]
pub(crate) fn block_rows(values: &[f32; STRIP], first_row: usize) -> &[f32; ROWS] {
    values[first_row..][..ROWS].try_into().expect("ROWS elements")
}

/// What blending one splat does to a vector of pixels.
pub(crate) struct Step<S: Simd> {
    /// α T, 0 where the splat is not blended.
    pub weight: f32x16<S>,
    /// T (1 − α), also where that is too little.
    pub after: f32x16<S>,
    /// T after the splat; 0 once a blend would have left too little, after which nothing has
    /// weight.
    pub transmittance: f32x16<S>,
    /// Where T stays above its minimum.
    pub stays_open: mask32x16<S>,
}

/// Blends row `r` of a splat over pixels of transmittance `before`.
#[inline(always)]
pub(crate) fn step<S: Simd>(
    simd: S,
    coverage: &Coverage<S>,
    r: usize,
    before: f32x16<S>,
) -> Step<S> {
    let zero = f32x16::splat(simd, 0.0);
    let alpha = coverage.unlimited_alpha[r].min(ALPHA_MAX as f32);
    let full = coverage.visible[r].select(alpha * before, zero);
    let after = before - full;
    let stays_open = after.simd_gt(TRANSMITTANCE_MIN as f32);
    Step {
        weight: stays_open.select(full, zero),
        after,
        transmittance: stays_open.select(after, zero),
        stays_open,
    }
}

/// Whether a pixel of the block can still take weight.
#[inline(always)]
pub(crate) fn is_open<S: Simd>(simd: S, transmittance: &[f32x16<S>; ROWS]) -> bool {
    let mut left = transmittance[0];
    for &row in &transmittance[1..] {
        left = left.max(row);
    }
    left.simd_gt(f32x16::splat(simd, 0.0)).any_true()
}
