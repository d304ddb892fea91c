//! Tile lists of one band.

use fearless_simd::Simd;
use fearless_simd_macros::simd;

use crate::project::ProjectedSplat;

/// Lanes of the rasteriser's vectors: one vector is a run of 16 pixels of a row.
pub(crate) const LANES: usize = 16;

/// Size of a tile in pixels: a multiple of 16 wide, at most 256 × 256.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileSize {
    width: u32,
    height: u32,
}

impl TileSize {
    /// A tile size, or `None` when the rasteriser cannot use it. The image does not depend on it.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Option<Self> {
        let fits = width.is_multiple_of(LANES as u32)
            && (16..=64).contains(&width)
            && (1..=64).contains(&height);
        fits.then_some(Self { width, height })
    }

    /// Pixels per row of a tile.
    #[must_use]
    pub fn width(self) -> u32 {
        self.width
    }

    /// Rows of a tile.
    #[must_use]
    pub fn height(self) -> u32 {
        self.height
    }
}

impl Default for TileSize {
    fn default() -> Self {
        Self { width: 16, height: 16 }
    }
}

/// The lists of one band's tiles; reused from band to band.
#[derive(Debug, Default)]
pub struct BandTiles {
    lists: Vec<Vec<u32>>,
}

/// Slack in pixels on both sides of an ellipse's exact interval: rounding in the interval, which
/// is relative to the distances involved, must not lose a pixel that the α test would keep.
const SLACK: f32 = 0.01;

impl BandTiles {
    /// Ranks of the splats of each tile, left to right.
    pub fn lists(&self) -> impl Iterator<Item = &[u32]> {
        self.lists.iter().map(Vec::as_slice)
    }
}

/// Makes the lists of the tiles of a band whose first pixel row is `y_start`, from the ranks of the
/// splats in the band. Scalar code, compiled for each SIMD level.
#[simd]
pub fn fill_tiles<S: Simd>(
    _simd: S,
    band: &mut BandTiles,
    splats: &[ProjectedSplat],
    ranks: &mut dyn Iterator<Item = u32>,
    y_start: u32,
    (width, tile): (u32, TileSize),
) {
    let tiles = width.div_ceil(tile.width) as usize;
    band.lists.iter_mut().for_each(Vec::clear);
    band.lists.resize_with(tiles, Vec::new);
    let y_min = y_start as f32 + 0.5;
    let y_max = y_min + (tile.height - 1) as f32;
    let inverse_width = 1.0 / tile.width as f32;
    for rank in ranks {
        let splat = &splats[rank as usize];
        let Some((left, right)) = splat.x_interval(y_min - SLACK, y_max + SLACK) else {
            continue;
        };
        // Relative slack for splats that reach far; absolute for the rest.
        let slack = SLACK + 1e-5 * (right - left);
        // Tile t holds pixel centres from t·w + 0.5 to (t + 1)·w − 0.5.
        let first = ((left - slack - 0.5) * inverse_width).max(0.0);
        let last = (right + slack - 0.5) * inverse_width;
        if last < 0.0 || first >= tiles as f32 {
            continue;
        }
        let range = first as usize..(last as usize + 1).min(tiles);
        for list in &mut band.lists[range] {
            list.push(rank);
        }
    }
}
