//! How splats are cut into runs whose activations fit.

use super::BLOCK_STRIDE;
use super::network_layout::{NetworkLayout, STEP, TILE};

/// A run of splats that are evaluated together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunk {
    pub(super) index: u32,
    pub(super) first: u32,
    pub(super) splats: u32,
    /// Columns that are computed: a multiple of [`TILE`].
    pub(super) columns: u32,
}

impl Chunk {
    /// Offset of its uniform block.
    pub(super) fn offset(self) -> u32 {
        self.index * BLOCK_STRIDE
    }

    pub(super) fn steps(self) -> u32 {
        self.columns / STEP
    }
}

/// Columns of the activations: as many splats as there may be, or as fit.
pub(super) fn columns_within(layout: &NetworkLayout, capacity: u32, bytes: u64) -> u32 {
    let wanted = u64::from(capacity.max(1)).next_multiple_of(u64::from(TILE));
    let tiles = bytes / (layout.column_bytes() * u64::from(TILE));
    wanted.min(tiles.max(1) * u64::from(TILE)) as u32
}

/// The splats in runs of at most `columns`; an empty run when there are none.
pub(super) fn chunks(splats: u32, columns: u32) -> Vec<Chunk> {
    let chunk = |index: u32| {
        let first = index * columns;
        let splats = (splats - first).min(columns);
        Chunk { index, first, splats, columns: splats.max(1).next_multiple_of(TILE) }
    };
    (0..splats.div_ceil(columns).max(1)).map(chunk).collect()
}
