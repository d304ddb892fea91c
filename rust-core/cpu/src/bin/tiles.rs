//! Tile lists of one band.

use super::BandEntry;

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

impl BandTiles {
    /// Makes the lists of a band's tiles, in an image `width` pixels wide: ranks of splats.
    pub fn fill(&mut self, entries: impl Iterator<Item = BandEntry>, width: u32, tile: TileSize) {
        self.clear(width, tile);
        for entry in entries {
            for list in &mut self.lists[entry.first_tile as usize..=entry.last_tile as usize] {
                list.push(entry.rank);
            }
        }
    }

    /// The same with the place of each splat in `entries` instead of its rank.
    pub(crate) fn fill_positions(&mut self, entries: &[BandEntry], width: u32, tile: TileSize) {
        self.clear(width, tile);
        for (position, entry) in (0u32..).zip(entries) {
            for list in &mut self.lists[entry.first_tile as usize..=entry.last_tile as usize] {
                list.push(position);
            }
        }
    }

    fn clear(&mut self, width: u32, tile: TileSize) {
        self.lists.iter_mut().for_each(Vec::clear);
        self.lists.resize_with(width.div_ceil(tile.width) as usize, Vec::new);
    }

    /// The list of each tile, left to right.
    pub fn lists(&self) -> impl Iterator<Item = &[u32]> {
        self.lists.iter().map(Vec::as_slice)
    }
}
