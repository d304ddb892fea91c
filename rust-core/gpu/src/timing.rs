//! What each stage costs on the GPU, by timestamp queries.

use std::time::Duration;

use crate::stage_pass::STAGES;
use crate::{Gpu, GpuError, readback};

/// Time that each stage of a frame took on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageTimes {
    /// Deformation network and mask.
    pub deform: Duration,
    /// World → image.
    pub project: Duration,
    /// Drawing order.
    pub sort: Duration,
    /// Splats × tiles, and their sort.
    pub bin: Duration,
    /// Blending.
    pub rasterize: Duration,
    /// From the start of the first stage to the end of the last.
    pub total: Duration,
}

const QUERIES: u32 = 2 * STAGES as u32;

/// Queries at the start and the end of each stage.
#[derive(Debug)]
pub(crate) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    nanoseconds: f32,
}

impl Timer {
    /// `None` where the device has no timestamps.
    pub(crate) fn new(gpu: &Gpu) -> Result<Option<Self>, GpuError> {
        if !gpu.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Ok(None);
        }
        let queries = gpu.device().create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("stages"),
            ty: wgpu::QueryType::Timestamp,
            count: QUERIES,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = gpu.buffer("timestamps", u64::from(QUERIES) * 8, usage)?;
        let nanoseconds = gpu.queue().get_timestamp_period();
        Ok(Some(Self { queries, resolved, nanoseconds }))
    }

    pub(crate) fn queries(&self) -> &wgpu::QuerySet {
        &self.queries
    }

    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..QUERIES, &self.resolved, 0);
    }

    /// Resolves the deformation stage alone, when nothing else was recorded.
    pub(crate) fn resolve_deform(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
    }

    /// Time of the deformation stage alone.
    pub(crate) fn read_deform(&self, gpu: &Gpu) -> Result<Option<Duration>, GpuError> {
        let ticks: Vec<u64> = readback::read(gpu, &self.resolved, 2)?;
        Ok(self.between(ticks[0], ticks[1]))
    }

    fn between(&self, from: u64, to: u64) -> Option<Duration> {
        let ticks = to.checked_sub(from)? as f64;
        Some(Duration::from_nanos((ticks * f64::from(self.nanoseconds)) as u64))
    }

    /// Times of the last frame; `None` when a clock has run backwards.
    pub(crate) fn read(&self, gpu: &Gpu) -> Result<Option<StageTimes>, GpuError> {
        let ticks: Vec<u64> = readback::read(gpu, &self.resolved, u64::from(QUERIES))?;
        let between = |from, to| self.between(from, to);
        let times = || {
            Some(StageTimes {
                deform: between(ticks[0], ticks[1])?,
                project: between(ticks[2], ticks[3])?,
                sort: between(ticks[4], ticks[5])?,
                bin: between(ticks[6], ticks[7])?,
                rasterize: between(ticks[8], ticks[9])?,
                total: between(ticks[0], ticks[9])?,
            })
        };
        Ok(times())
    }
}
