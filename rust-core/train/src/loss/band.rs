//! The loss over one band of rows: everything between the render and its gradient.
//!
//! A gradient row needs the SSIM derivatives of the 5 rows above and below it, and these need the
//! images 5 rows further out, so a band of `n` rows reads n + 20 image rows and evaluates SSIM on
//! n + 10. In the buffers, plane row i is image row `first − 10 + i` and derivative row j is image
//! row `first − 5 + j`.

use std::ops::Range;

use fearless_simd::Simd;

use super::composite::{TargetRow, composite_row, join_row, mask_row, target_row};
use super::kernels::{
    COLUMN_BLOCK, GradientScale, PAD, ROWS, SimilarityRow, TILE, TILE_ROW, TileRows, WINDOW_ROWS,
    Window, derivatives_down, gradient_across, similarity_across, statistics_down, sum,
    sum_of_differences,
};
use super::plane::Plane;
use super::target::TargetImage;
use super::window::{RADIUS, TAPS};

/// Rows of a band. The halo costs 10 of 58 SSIM rows; the buffers of a 504-pixel wide image take
/// 1.0 MB. It does not depend on the number of threads, so neither does any sum.
pub(super) const BAND_ROWS: usize = 48;

/// What a band is computed from.
pub(super) struct BandInput<'a> {
    pub(super) render: &'a [[f32; 4]],
    pub(super) target: &'a TargetImage,
    pub(super) background: [f32; 3],
    pub(super) scale: GradientScale,
    pub(super) weights: &'a [f32; TAPS],
}

/// What a band adds to the loss.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BandSums {
    /// Σ|x − y| over the band's pixels and channels.
    pub(super) difference: f64,
    /// Σ(1 − SSIM).
    pub(super) dissimilarity: f64,
}

/// Working memory of one band, reused from step to step.
#[derive(Default)]
pub(super) struct BandBuffers {
    /// Width of the image that the planes are laid out, and their padding is zero, for.
    width: usize,
    /// Floats of a plane row.
    stride: usize,
    /// The render by channel, then its gradient: `BAND_ROWS` + 20 rows, and what the last block
    /// of a vertical pass reads beyond them.
    render: [Plane; 3],
    /// The target, likewise.
    target: [Plane; 3],
    /// Derivatives of SSIM of one channel: `BAND_ROWS` + 10 rows, likewise.
    derivatives: [Plane; 3],
    tile: Box<TileBuffers>,
}

/// What a tile needs between the planes, on cache lines as they are.
#[repr(align(64))]
struct TileBuffers {
    /// What a vertical pass writes, of up to four planes.
    rows: [TileRows; 4],
    /// 1 − SSIM of one row.
    dissimilarity: [f32; TILE],
}

impl Default for TileBuffers {
    fn default() -> Self {
        Self { rows: [[[0.0; TILE_ROW]; _]; 4], dissimilarity: [0.0; TILE] }
    }
}

/// A tile of columns.
#[derive(Clone, Copy)]
struct Tile {
    /// First column.
    start: usize,
    /// Columns, a multiple of [`COLUMN_BLOCK`].
    columns: usize,
    /// Columns that are inside the image.
    inside: usize,
}

impl BandBuffers {
    fn prepare(&mut self, width: usize) {
        if width == self.width {
            return;
        }
        let mut stride = width.next_multiple_of(COLUMN_BLOCK) + 2 * PAD;
        if stride.is_multiple_of(2 * COLUMN_BLOCK) {
            // Rows an even number of cache lines apart crowd into a part of the cache's sets.
            stride += COLUMN_BLOCK;
        }
        // The last tile of the last row is read to its full width.
        let plane = |rows: usize| Plane::zeros(rows * stride + TILE_ROW);
        let rows_read = |rows: usize| rows.next_multiple_of(ROWS) - ROWS + WINDOW_ROWS;
        let derivative_rows = rows_read(BAND_ROWS).next_multiple_of(ROWS);
        *self = Self {
            width,
            stride,
            render: std::array::from_fn(|_| plane(rows_read(derivative_rows))),
            target: std::array::from_fn(|_| plane(rows_read(derivative_rows))),
            derivatives: std::array::from_fn(|_| plane(derivative_rows)),
            tile: Box::default(),
        };
    }

    /// Loss and gradient of the image rows `band`; `out` holds these rows.
    pub(super) fn process<S: Simd>(
        &mut self,
        simd: S,
        input: &BandInput<'_>,
        band: Range<usize>,
        out: &mut [[f32; 4]],
    ) -> BandSums {
        self.prepare(input.target.width());
        self.split(simd, input, &band);
        let mut sums = BandSums::default();
        for channel in 0..3 {
            sums.difference += self.sum_differences(simd, band.len(), channel);
            for tile in tiles(input.target.width()) {
                sums.dissimilarity += self.similarity(simd, input, &band, channel, tile);
            }
            for tile in tiles(input.target.width()) {
                self.differentiate(simd, input, band.len(), channel, tile);
            }
        }
        self.join(simd, input, band, out);
        sums
    }

    /// Fills the planes of the render and of the target; rows outside the image are zero.
    fn split<S: Simd>(&mut self, simd: S, input: &BandInput<'_>, band: &Range<usize>) {
        let (width, height) = (input.target.width(), input.target.height());
        for i in 0..band.len() + 4 * RADIUS {
            let row = i * self.stride..(i + 1) * self.stride;
            let image = (band.start + i).checked_sub(2 * RADIUS).filter(|&image| image < height);
            let Some(image) = image else {
                for plane in self.render.iter_mut().chain(&mut self.target) {
                    plane[row.clone()].fill(0.0);
                }
                continue;
            };
            let pixels = image * width..(image + 1) * width;
            let target = row_of_target(input.target, pixels.clone());
            let own = row.start + PAD..row.start + PAD + width;
            // The gradient of the band before this one reached beyond the image.
            for plane in &mut self.render {
                plane[own.end..row.end].fill(0.0);
            }
            let planes = self.render.each_mut().map(|plane| &mut plane[own.clone()]);
            composite_row(simd, &input.render[pixels], input.background, planes);
            for channel in 0..3 {
                let y = &mut self.target[channel][own.clone()];
                target_row(simd, target, channel, input.background[channel], y);
                if let Some(mask) = target.mask {
                    mask_row(simd, mask, &mut self.render[channel][own.clone()], y);
                }
            }
        }
    }

    /// Σ|x − y| of one channel; the padding is zero in both.
    fn sum_differences<S: Simd>(&self, simd: S, rows: usize, channel: usize) -> f64 {
        let own = 2 * RADIUS * self.stride..(2 * RADIUS + rows) * self.stride;
        let x = self.render[channel][own.clone()].chunks_exact(self.stride);
        let y = self.target[channel][own].chunks_exact(self.stride);
        x.zip(y).map(|(x, y)| sum_of_differences(simd, x, y)).sum()
    }

    /// SSIM of one tile of the band and of the rows around it, and its derivatives; returns
    /// Σ(1 − SSIM) over the band itself.
    fn similarity<S: Simd>(
        &mut self,
        simd: S,
        input: &BandInput<'_>,
        band: &Range<usize>,
        channel: usize,
        tile: Tile,
    ) -> f64 {
        let mut total = 0.0;
        for block in (0..band.len() + 2 * RADIUS).step_by(ROWS) {
            let x = window(&self.render[channel], self.stride, block, tile);
            let y = window(&self.target[channel], self.stride, block, tile);
            let out = &mut self.tile.rows.each_mut();
            statistics_down(simd, input.weights, [x, y], out);
            for r in 0..ROWS {
                let j = block + r;
                let image = (band.start + j).checked_sub(RADIUS);
                let is_inside = image.is_some_and(|image| image < input.target.height());
                let is_own = (RADIUS..band.len() + RADIUS).contains(&j);
                let dissimilarity = self.similarity_row(simd, input, r, j, tile, is_inside);
                total += if is_own { dissimilarity } else { 0.0 };
            }
        }
        total
    }

    /// Row `r` of a block, derivative row `j`. Outside the image there is no SSIM to derive.
    fn similarity_row<S: Simd>(
        &mut self,
        simd: S,
        input: &BandInput<'_>,
        r: usize,
        j: usize,
        tile: Tile,
        is_inside: bool,
    ) -> f64 {
        let start = j * self.stride + PAD + tile.start;
        let [a, b, c] =
            self.derivatives.each_mut().map(|plane| &mut plane[start..start + tile.columns]);
        if !is_inside {
            for row in [a, b, c] {
                row.fill(0.0);
            }
            return 0.0;
        }
        let TileBuffers { rows, dissimilarity, .. } = &mut *self.tile;
        let dissimilarity = &mut dissimilarity[..tile.columns];
        let out = SimilarityRow {
            dissimilarity: &mut *dissimilarity,
            derivatives: [&mut *a, &mut *b, &mut *c],
        };
        similarity_across(simd, input.weights, rows.each_ref().map(|plane| &plane[r]), out);
        for row in [a, b, c, &mut *dissimilarity] {
            row[tile.inside..].fill(0.0);
        }
        sum(simd, dissimilarity)
    }

    /// The gradient of one tile of one channel of the band, in place of the render.
    fn differentiate<S: Simd>(
        &mut self,
        simd: S,
        input: &BandInput<'_>,
        rows: usize,
        channel: usize,
        tile: Tile,
    ) {
        for block in (0..rows).step_by(ROWS) {
            let planes = self.derivatives.each_ref();
            let windows = planes.map(|plane| window(plane, self.stride, block, tile));
            let [a, b, c, _] = &mut self.tile.rows;
            derivatives_down(simd, input.weights, windows, &mut [a, b, c]);
            for r in 0..ROWS {
                let start = (block + r + 2 * RADIUS) * self.stride + PAD + tile.start;
                let own = start..start + tile.columns;
                let x = &mut self.render[channel][own.clone()];
                let y = &self.target[channel][own];
                let [a, b, c, _] = &self.tile.rows;
                let blurred = [&a[r], &b[r], &c[r]];
                gradient_across(simd, input.weights, blurred, x, y, input.scale);
            }
        }
    }

    fn join<S: Simd>(
        &self,
        simd: S,
        input: &BandInput<'_>,
        band: Range<usize>,
        out: &mut [[f32; 4]],
    ) {
        let width = input.target.width();
        for (k, out) in out.chunks_exact_mut(width).enumerate() {
            let image = band.start + k;
            let mask = input.target.mask().map(|mask| &mask[image * width..][..width]);
            let start = (k + 2 * RADIUS) * self.stride + PAD;
            let rows = self.render.each_ref().map(|plane| &plane[start..start + width]);
            join_row(simd, rows, mask, input.background, out);
        }
    }
}

fn row_of_target(target: &TargetImage, pixels: Range<usize>) -> TargetRow<'_> {
    let bytes = target.channels() as usize;
    TargetRow {
        channels: target.channels(),
        pixels: &target.pixels()[pixels.start * bytes..pixels.end * bytes],
        mask: target.mask().map(|mask| &mask[pixels]),
    }
}

/// The tiles of an image.
fn tiles(width: usize) -> impl Iterator<Item = Tile> {
    let padded = width.next_multiple_of(COLUMN_BLOCK);
    (0..padded).step_by(TILE).map(move |start| Tile {
        start,
        columns: TILE.min(padded - start),
        inside: TILE.min(width - start),
    })
}

/// The rows of a plane from `first` on, in the columns of a tile and around it.
fn window(plane: &[f32], stride: usize, first: usize, tile: Tile) -> Window<'_> {
    std::array::from_fn(|i| {
        let start = (first + i) * stride + tile.start;
        plane[start..].first_chunk().expect("planes end with a spare tile row")
    })
}
