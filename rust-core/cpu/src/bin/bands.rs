//! Splats by band.

use rayon::prelude::*;

use super::TileSize;
use crate::project::ProjectedSplat;

/// Splats that one task bins: fixed, so that lists never depend on the number of threads.
const CHUNK: usize = 8192;

/// For every band of the image, the splats that may touch it, in drawing order.
#[derive(Debug, Default)]
pub struct BandLists {
    /// `chunks[c][b]`: ranks (positions in drawing order) of the splats of chunk c in band b.
    chunks: Vec<Vec<Vec<u32>>>,
}

impl BandLists {
    /// Ranks of the splats in a band, ascending.
    pub fn band(&self, band: usize) -> impl Iterator<Item = u32> + '_ {
        self.chunks.iter().flat_map(move |bands| bands[band].iter().copied())
    }
}

/// Sorts `splats`, which are in drawing order, into the bands of an image `height` pixels high.
#[must_use]
pub fn bin_bands(splats: &[ProjectedSplat], height: u32, tile: TileSize) -> BandLists {
    let bands = height.div_ceil(tile.height()) as usize;
    let chunks = splats
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(chunk, splats)| {
            let mut lists = vec![Vec::new(); bands];
            for (rank, splat) in (chunk * CHUNK..).zip(splats) {
                for band in bands_of(splat, bands, tile) {
                    lists[band].push(rank as u32);
                }
            }
            lists
        })
        .collect();
    BandLists { chunks }
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
        let splat =
            |y: f32, half_height: f32| ProjectedSplat { y, half_height, ..Default::default() };
        let splats = [splat(8.0, 3.0), splat(16.0, 1.0), splat(40.0, 1e9), splat(-50.0, 10.0)];
        let lists = bin_bands(&splats, 64, tile);
        let band = |b| lists.band(b).collect::<Vec<_>>();
        assert_eq!(band(0), [0, 1, 2]);
        assert_eq!(band(1), [1, 2]);
        assert_eq!(band(3), [2]);
    }
}
