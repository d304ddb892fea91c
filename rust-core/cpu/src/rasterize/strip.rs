//! What the forward and the backward pass of a tile do alike: which pixels a splat reaches, and
//! how much of it each of them shows. Both passes go through this file, so both make the same
//! decisions from the same bits.
//!
//! A block takes its splats in batches, and a batch in short loops: exponents of all its splats,
//! alphas of those that are seen, then one splat after another over the pixels. A splat on a row is a
//! chain of thirty dependent operations, and the processor looks ahead about a hundred: in one
//! loop over everything it would have two rows under way, in these it has as many as it can work on.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, mask32x16};

use super::exp2::exp2;
use crate::bin::LANES;
use crate::project::{LOG2_ALPHA_MIN, ProjectedSplat};
use crate::reference::{ALPHA_MAX, TRANSMITTANCE_MIN};

/// Rows of a block: blended together.
pub(crate) const ROWS: usize = 4;

/// Rows of a strip: what depends on the row alone is computed for all of them in one vector.
pub(crate) const STRIP: usize = LANES;

/// Splats that a block takes together. After a batch it looks whether it has been filled up.
pub(crate) const BATCH: usize = 16;

/// A vector of pixels in memory, on a cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct Lanes([f32; LANES]);

impl Lanes {
    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S) -> f32x16<S> {
        f32x16::load_array(simd, self.0)
    }

    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, values: f32x16<S>) {
        values.store_array(&mut self.0);
    }
}

/// A splat as one strip sees it: what both passes need of it, with what depends on the row alone.
#[derive(Clone, Copy, Default)]
#[repr(C, align(64))]
pub(crate) struct StripSplat {
    /// u12 dy of each row.
    shear: [f32; STRIP],
    /// log₂ o − (u22 dy)² of each row: the largest exponent of α in it.
    exponent: [f32; STRIP],
    x: f32,
    u11: f32,
    pub(crate) color: [f32; 3],
    pub(crate) depth: f32,
    /// What the pass knows it by.
    pub(crate) index: u32,
}

impl StripSplat {
    /// A splat on rows at the distances `dy` from its centre, pixels.
    #[inline(always)]
    pub(crate) fn fill<S: Simd>(&mut self, splat: &ProjectedSplat, index: u32, dy: f32x16<S>) {
        let v2 = dy * splat.u22;
        (dy * splat.u12).store_array(&mut self.shear);
        (-v2).mul_add(v2, splat.log2_opacity).store_array(&mut self.exponent);
        self.x = splat.x;
        self.u11 = splat.u11;
        self.color = splat.color;
        self.depth = splat.depth;
        self.index = index;
    }

    /// First component of U d, u11 dx + u12 dy, in the block that begins with row `first_row` of the
    /// strip and whose columns are `x`.
    #[inline(always)]
    pub(crate) fn first_component<S: Simd>(
        &self,
        x: f32x16<S>,
        first_row: usize,
    ) -> [f32x16<S>; ROWS] {
        let along = (x - self.x) * self.u11;
        let shear = block_rows(&self.shear, first_row);
        let mut v1 = [along; ROWS];
        for r in 0..ROWS {
            v1[r] += shear[r];
        }
        v1
    }
}

/// The splats of a batch that a block sees, in drawing order.
#[derive(Debug, Default)]
pub(crate) struct Contributors {
    /// Place of each in the batch; the first `count` are meant.
    places: [u8; BATCH],
    count: usize,
    /// α of each, limited; 0 where a pixel does not see it.
    alphas: [[Lanes; ROWS]; BATCH],
}

impl Contributors {
    /// Evaluates a batch in the block that begins with row `first_row` of the strip; `x` are its
    /// columns.
    ///
    /// A pixel sees a splat where α ≥ 1/255. That is decided on the exponent: the same condition
    /// with less rounding.
    #[inline(always)]
    pub(crate) fn find<S: Simd>(
        &mut self,
        simd: S,
        batch: &[StripSplat],
        x: f32x16<S>,
        first_row: usize,
    ) {
        let batch = &batch[..batch.len().min(BATCH)];
        let mut count = 0;
        for (place, splat) in (0u8..).zip(batch) {
            let v1 = splat.first_component(x, first_row);
            let row_exponent = block_rows(&splat.exponent, first_row);
            let exponents = &mut self.alphas[count];
            let mut any = mask32x16::splat(simd, false);
            for r in 0..ROWS {
                let exponent = (-v1[r]).mul_add(v1[r], row_exponent[r]);
                any |= exponent.simd_ge(LOG2_ALPHA_MIN);
                exponents[r].store(exponent);
            }
            // Written in any case, kept by counting on: a branch would be mispredicted for every
            // seventh splat, which costs more than the operations.
            self.places[count] = place;
            count += usize::from(any.any_true());
        }
        self.count = count;
        let zero = f32x16::splat(simd, 0.0);
        for rows in &mut self.alphas[..count] {
            let mut exponents = [zero; ROWS];
            for r in 0..ROWS {
                exponents[r] = rows[r].load(simd);
            }
            let unlimited = exp2(simd, exponents);
            for r in 0..ROWS {
                let alpha = unlimited[r].min(ALPHA_MAX as f32);
                rows[r].store(exponents[r].simd_ge(LOG2_ALPHA_MIN).select(alpha, zero));
            }
        }
    }

    /// Place in the batch and α of each row.
    #[inline(always)]
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, &[Lanes; ROWS])> {
        self.places[..self.count].iter().map(|&place| usize::from(place)).zip(&self.alphas)
    }
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

/// Blends a splat of a given α over pixels of transmittance `before`.
#[inline(always)]
pub(crate) fn step<S: Simd>(simd: S, alpha: f32x16<S>, before: f32x16<S>) -> Step<S> {
    let zero = f32x16::splat(simd, 0.0);
    let full = alpha * before;
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
