//! Splats by band.

use fearless_simd::{Level, Simd, dispatch};
use fearless_simd_macros::simd;
use rayon::prelude::*;

use super::TileSize;
use crate::project::{Outline, ProjectedSplat};

/// A splat in a band.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BandEntry {
    /// Position of the splat in drawing order.
    pub rank: u32,
    /// First tile of the band that it touches.
    pub first_tile: u16,
    /// Last tile that it touches.
    pub last_tile: u16,
}

/// For every band of the image, the splats that touch it, in drawing order.
#[derive(Debug, Default)]
pub struct BandLists {
    /// `chunks[c][b]`: the splats of chunk c in band b.
    chunks: Vec<Vec<Vec<BandEntry>>>,
}

impl BandLists {
    /// Splats that one task bins, and later adds up the sums of: fixed, so that lists never depend on
    /// the number of threads, and few enough to share ten thousand splats out.
    pub(crate) const CHUNK: usize = 1024;

    /// The entries of the splats of one chunk (ranks from `chunk * CHUNK`), by band.
    pub(crate) fn chunk(&self, chunk: usize) -> &[Vec<BandEntry>] {
        &self.chunks[chunk]
    }

    /// The splats in a band, ascending in rank.
    pub fn band(&self, band: usize) -> impl Iterator<Item = BandEntry> + '_ {
        self.chunks.iter().flat_map(move |bands| bands[band].iter().copied())
    }
}

impl BandLists {
    /// Sorts `splats`, which are in drawing order, into the bands of an image of `size` (width,
    /// height). Memory is kept from frame to frame.
    pub fn fill(
        &mut self,
        level: Level,
        splats: &[ProjectedSplat],
        size: (u32, u32),
        tile: TileSize,
    ) {
        self.chunks.resize_with(splats.len().div_ceil(Self::CHUNK), Vec::new);
        let tasks = self.chunks.par_iter_mut().zip(splats.par_chunks(Self::CHUNK)).enumerate();
        tasks.for_each(|(chunk, (lists, splats))| {
            let first_rank = (chunk * Self::CHUNK) as u32;
            dispatch!(level, simd => bin_chunk(simd, splats, first_rank, size, tile, lists));
        });
    }
}

/// Bins consecutive splats, the first of which has rank `first_rank`. Scalar code, compiled for
/// each SIMD level.
#[simd]
fn bin_chunk<S: Simd>(
    _simd: S,
    splats: &[ProjectedSplat],
    first_rank: u32,
    (width, height): (u32, u32),
    tile: TileSize,
    lists: &mut Vec<Vec<BandEntry>>,
) {
    let bands = height.div_ceil(tile.height()) as usize;
    lists.iter_mut().for_each(Vec::clear);
    lists.resize_with(bands, Vec::new);
    for (rank, splat) in (first_rank..).zip(splats) {
        let outline = splat.outline();
        for band in bands_of(splat, bands, tile) {
            let y_min = (band as u32 * tile.height()) as f32 + 0.5;
            let y_max = y_min + (tile.height() - 1) as f32;
            if let Some((first_tile, last_tile)) = tiles_of(&outline, (y_min, y_max), width, tile) {
                lists[band].push(BandEntry { rank, first_tile, last_tile });
            }
        }
    }
}

/// Slack in pixels on all sides of an ellipse's exact interval: rounding in the interval, which is
/// relative to the distances involved, must not lose a pixel that the α test would keep.
const SLACK: f32 = 0.01;

/// First and last tile of a band that the ellipse touches, by the exact interval of x in which it
/// meets the strip between the band's first and last pixel centres.
#[inline(always)]
fn tiles_of(
    outline: &Outline,
    (y_min, y_max): (f32, f32),
    width: u32,
    tile: TileSize,
) -> Option<(u16, u16)> {
    let (left, right) = outline.x_interval(y_min - SLACK, y_max + SLACK)?;
    // Relative slack for splats that reach far; absolute for the rest.
    let slack = SLACK + 1e-5 * (right - left);
    let last_tile = (width - 1) / tile.width();
    let inverse_width = 1.0 / tile.width() as f32;
    // Tile t holds pixel centres from t·w + 0.5 to (t + 1)·w − 0.5.
    let first = ((left - slack - 0.5) * inverse_width).max(0.0);
    let last = (right + slack - 0.5) * inverse_width;
    let touches = last >= 0.0 && first < (last_tile + 1) as f32;
    touches.then(|| (first as u16, last.min(last_tile as f32) as u16))
}

/// Bands that hold a pixel centre inside the splat's box, one more where rounding could matter.
fn bands_of(splat: &ProjectedSplat, bands: usize, tile: TileSize) -> std::ops::Range<usize> {
    // A pixel row r has its centre at r + 0.5. Casting saturates, so any finite box is in range.
    let height = tile.height() as f32;
    let first = ((splat.y - splat.half_height - 0.5).floor() / height).floor().max(0.0) as usize;
    let last = ((splat.y + splat.half_height - 0.5).ceil() / height).floor();
    if last < 0.0 { 0..0 } else { first.min(bands)..(last as usize + 1).min(bands) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_band_that_the_box_meets_lists_the_splat_in_drawing_order() {
        let tile = TileSize::new(16, 16).unwrap();
        // Circles of a given radius: ‖U d‖ = 1 there, at the cutoff.
        let splat = |y: f32, radius: f32| ProjectedSplat {
            x: 8.0,
            y,
            u11: 1.0 / radius,
            u22: 1.0 / radius,
            log2_opacity: 1.0 - 255.0f32.log2(),
            half_width: radius,
            half_height: radius,
            ..Default::default()
        };
        let splats = [splat(8.0, 3.0), splat(16.0, 1.0), splat(40.0, 1e9), splat(-50.0, 10.0)];
        let mut lists = BandLists::default();
        lists.fill(Level::new(), &splats, (64, 64), tile);
        let band = |b| lists.band(b).map(|entry| entry.rank).collect::<Vec<_>>();
        assert_eq!(band(0), [0, 1, 2]);
        assert_eq!(band(1), [1, 2]);
        assert_eq!(band(3), [2]);
        let tiles: Vec<_> = lists.band(0).map(|e| (e.first_tile, e.last_tile)).collect();
        assert_eq!(tiles, [(0, 0), (0, 0), (0, 3)]);
    }
}
