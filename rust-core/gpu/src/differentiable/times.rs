//! What each stage of the two passes takes on the GPU.

use std::time::Duration;

/// Time that each stage of the two passes took on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PassTimes {
    /// Stored parameters → image, and colours.
    pub project: Duration,
    /// Drawing order.
    pub sort: Duration,
    /// Splats × tiles, and their sort.
    pub bin: Duration,
    /// Blending.
    pub rasterize: Duration,
    /// ∂L/∂image → sums of tile entries.
    pub rasterize_backward: Duration,
    /// Sums of entries → sums of splats.
    pub sum_slots: Duration,
    /// Sums of splats → ∂L/∂(stored parameters).
    pub project_backward: Duration,
}

impl PassTimes {
    /// From the times by their places.
    pub(super) fn of_stages(times: &[Duration]) -> Self {
        Self {
            project: times[PROJECT as usize],
            sort: times[SORT as usize],
            bin: times[BIN as usize],
            rasterize: times[RASTERIZE as usize],
            rasterize_backward: times[RASTERIZE_BACKWARD as usize],
            sum_slots: times[SUM_SLOTS as usize],
            project_backward: times[PROJECT_BACKWARD as usize],
        }
    }

    /// The sum of the stages.
    #[must_use]
    pub fn total(&self) -> Duration {
        let forward = self.project + self.sort + self.bin + self.rasterize;
        forward + self.rasterize_backward + self.sum_slots + self.project_backward
    }
}

/// Places of the stages among the timestamps.
pub(super) const PROJECT: u32 = 0;
pub(super) const SORT: u32 = 1;
pub(super) const BIN: u32 = 2;
pub(super) const RASTERIZE: u32 = 3;
pub(super) const RASTERIZE_BACKWARD: u32 = 4;
pub(super) const SUM_SLOTS: u32 = 5;
pub(super) const PROJECT_BACKWARD: u32 = 6;
pub(super) const TIMED_STAGES: u32 = 7;
