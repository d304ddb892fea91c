//! Recording a stage: one compute pass, timed when the device can.

/// Where a dispatch's size comes from.
#[derive(Clone, Copy, Debug)]
pub enum Groups<'a> {
    /// Known on the host.
    Direct(u32),
    /// Written by an earlier dispatch, at this byte offset.
    Indirect(&'a wgpu::Buffer, u64),
}

/// Dispatches with the pipeline and bind group that are set.
pub fn dispatch(pass: &mut wgpu::ComputePass<'_>, groups: Groups<'_>) {
    match groups {
        Groups::Direct(count) => {
            let (x, y, z) = crate::kernel::folded(count);
            pass.dispatch_workgroups(x, y, z);
        }
        Groups::Indirect(buffer, offset) => pass.dispatch_workgroups_indirect(buffer, offset),
    }
}

/// The stages of a frame, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    Deform,
    Project,
    Sort,
    Bin,
    Rasterize,
}

/// Number of stages.
pub(crate) const STAGES: usize = 5;

/// Begins the pass of a stage. With `timestamps` its start and end are written to queries 2·stage
/// and 2·stage + 1.
pub(crate) fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    stage: Stage,
    timestamps: Option<&wgpu::QuerySet>,
) -> wgpu::ComputePass<'a> {
    let label = match stage {
        Stage::Deform => "deform",
        Stage::Project => "project",
        Stage::Sort => "sort",
        Stage::Bin => "bin",
        Stage::Rasterize => "rasterize",
    };
    begin_pass(encoder, label, stage as u32, timestamps)
}

/// Begins a pass by its place among those that are timed.
pub(crate) fn begin_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    stage: u32,
    timestamps: Option<&wgpu::QuerySet>,
) -> wgpu::ComputePass<'a> {
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some(label),
        timestamp_writes: timestamps.map(|query_set| wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(2 * stage),
            end_of_pass_write_index: Some(2 * stage + 1),
        }),
    })
}
