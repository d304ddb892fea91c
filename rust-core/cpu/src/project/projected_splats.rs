//! The splats of a frame after projection.

use rayon::prelude::*;

use super::ProjectedSplat;

/// Splats that one task projects; fixed, so that the order of the output never depends on the
/// number of threads.
const CHUNK: usize = 1024;

/// The visible splats of a frame in the order of the scene, as the tasks of the projection left
/// them: drawing order is made from here in one pass, so they are never brought together. Memory
/// is kept from frame to frame.
#[derive(Debug, Default)]
pub struct ProjectedSplats {
    /// At most `CHUNK` each.
    chunks: Vec<Vec<ProjectedSplat>>,
}

impl ProjectedSplats {
    /// Fills it with what `project` makes of the splats 0…count − 1; `None` leaves one out.
    pub(crate) fn fill(
        &mut self,
        count: usize,
        project: impl Fn(usize) -> Option<ProjectedSplat> + Sync,
    ) {
        self.chunks.resize_with(count.div_ceil(CHUNK), Vec::new);
        self.chunks.par_iter_mut().enumerate().for_each(|(chunk, splats)| {
            let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(count);
            splats.clear();
            splats.extend(range.filter_map(&project));
        });
    }

    /// Number of splats.
    #[must_use]
    pub fn len(&self) -> usize {
        self.chunks.iter().map(Vec::len).sum()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.chunks.iter().all(Vec::is_empty)
    }

    /// The splats in the order of the scene, each with a place that [`at`](Self::at) takes.
    /// Places ascend, not always by one.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &ProjectedSplat)> {
        (0u32..).step_by(CHUNK).zip(&self.chunks).flat_map(|(first, splats)| (first..).zip(splats))
    }

    /// The splat at a place.
    ///
    /// # Panics
    /// When `place` is not one that [`iter`](Self::iter) gave.
    #[must_use]
    #[inline(always)]
    pub fn at(&self, place: u32) -> &ProjectedSplat {
        &self.chunks[place as usize / CHUNK][place as usize % CHUNK]
    }
}
