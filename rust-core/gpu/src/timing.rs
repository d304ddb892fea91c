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

/// Queries at the start and the end of each stage.
#[derive(Debug)]
pub(crate) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    nanoseconds: f32,
    /// Two per stage.
    count: u32,
}

impl Timer {
    /// For the stages of a frame; `None` where the device has no timestamps.
    pub(crate) fn new(gpu: &Gpu) -> Result<Option<Self>, GpuError> {
        Self::of_stages(gpu, STAGES as u32)
    }

    /// For so many stages.
    pub(crate) fn of_stages(gpu: &Gpu, stages: u32) -> Result<Option<Self>, GpuError> {
        if !gpu.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Ok(None);
        }
        let count = 2 * stages;
        let queries = gpu.device().create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("stages"),
            ty: wgpu::QueryType::Timestamp,
            count,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = gpu.buffer("timestamps", u64::from(count) * 8, usage)?;
        let nanoseconds = gpu.queue().get_timestamp_period();
        Ok(Some(Self { queries, resolved, nanoseconds, count }))
    }

    pub(crate) fn queries(&self) -> &wgpu::QuerySet {
        &self.queries
    }

    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..self.count, &self.resolved, 0);
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

    /// Time of each stage that was resolved; `None` when a clock has run backwards.
    pub(crate) fn read_stages(&self, gpu: &Gpu) -> Result<Option<Vec<Duration>>, GpuError> {
        let ticks: Vec<u64> = readback::read(gpu, &self.resolved, u64::from(self.count))?;
        Ok(ticks.chunks_exact(2).map(|pair| self.between(pair[0], pair[1])).collect())
    }

    /// Times of the last frame; `None` when a clock has run backwards.
    pub(crate) fn read(&self, gpu: &Gpu) -> Result<Option<StageTimes>, GpuError> {
        let ticks: Vec<u64> = readback::read(gpu, &self.resolved, u64::from(self.count))?;
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
