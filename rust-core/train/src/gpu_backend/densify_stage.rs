//! Changes of the set on the GPU: the dead move, then the set grows; every hundred steps.

use trapeze_gpu::compute::{Groups, dispatch, whole};
use trapeze_gpu::{Gpu, GpuError};

use super::kernels::TrainingKernels;
use super::layout::{Densification, widths};
use super::splats::ResidentSplats;
use crate::densify::OpacityUnits;
use crate::schedule::DensifyPlan;

/// Working memory and bind groups for one set of splats.
pub(super) struct DensifyStage {
    copies: wgpu::Buffer,
    relocation: Change,
    growth: Change,
}

/// One of the two changes: the same kernels with another uniform block.
struct Change {
    uniform: wgpu::Buffer,
    weigh_pipeline: wgpu::ComputePipeline,
    weigh: wgpu::BindGroup,
    relocate: wgpu::BindGroup,
    copies: Vec<ArrayCopy>,
}

struct ArrayCopy {
    width: u32,
    pipeline: wgpu::ComputePipeline,
    bind_group: wgpu::BindGroup,
}

/// Buffers that both changes use, one after the other.
struct Working<'a> {
    table: &'a wgpu::Buffer,
    sums: &'a wgpu::Buffer,
    block_sums: &'a wgpu::Buffer,
    hosts: &'a wgpu::Buffer,
    copies: &'a wgpu::Buffer,
    counts: &'a wgpu::Buffer,
}

impl DensifyStage {
    /// Bytes of working memory.
    pub(super) fn bytes(capacity: u32) -> u64 {
        3 * 4 * u64::from(capacity) + 4 * u64::from(capacity.div_ceil(256))
    }

    pub(super) fn new(
        gpu: &Gpu,
        kernels: &mut TrainingKernels,
        splats: &ResidentSplats,
        counts: &wgpu::Buffer,
    ) -> Result<Self, GpuError> {
        let capacity = u64::from(splats.parameters.capacity);
        // Four entries to a vector of the uniform block.
        let mut table = OpacityUnits::new().table().to_vec();
        table.resize(table.len().next_multiple_of(4), 0);
        let copies = gpu.storage("copies", 4 * capacity)?;
        let working = Working {
            table: &gpu.uniform_of("opacity units", bytemuck::cast_slice(&table)),
            sums: &gpu.storage("sums of weights", 4 * capacity)?,
            block_sums: &gpu.storage("sums of blocks", 4 * (capacity.div_ceil(256) + 1))?,
            hosts: &gpu.storage("hosts", 4 * capacity)?,
            copies: &copies,
            counts,
        };
        let relocation = Change::new(gpu, kernels, splats, &working);
        let growth = Change::new(gpu, kernels, splats, &working);
        Ok(Self { copies, relocation, growth })
    }

    /// Records a change of `splats` splats after `step` steps. The uniform blocks are written at
    /// once, so that a change has a submission of its own.
    pub(super) fn record(
        &self,
        gpu: &Gpu,
        kernels: &TrainingKernels,
        encoder: &mut wgpu::CommandEncoder,
        plan: &DensifyPlan,
        (splats, step): (u32, u32),
    ) {
        let relocation = Densification::relocation(plan, splats, step);
        self.relocation.record(gpu, kernels, encoder, &self.copies, &relocation);
        if plan.count > splats {
            let growth = Densification::growth(plan, splats, step);
            self.growth.record(gpu, kernels, encoder, &self.copies, &growth);
        }
    }
}

impl Change {
    fn new(
        gpu: &Gpu,
        kernels: &mut TrainingKernels,
        splats: &ResidentSplats,
        working: &Working<'_>,
    ) -> Self {
        let uniform = gpu.uniform_of("densification", &[0; size_of::<Densification>()]);
        let widths = widths(splats.degree());
        let parameters = &splats.parameters;
        let weigh = kernels.weigh_interface.bind(
            gpu,
            &[
                whole(&uniform),
                whole(working.table),
                whole(&parameters.positions),
                whole(&parameters.log_scales),
                whole(&parameters.rotations),
                whole(&parameters.opacity_logits),
                whole(&parameters.sh_dc),
                whole(&parameters.sh_rest),
                whole(working.sums),
                whole(working.block_sums),
                whole(working.hosts),
            ],
        );
        let relocate = kernels.relocate_interface.bind(
            gpu,
            &[
                whole(&uniform),
                whole(working.sums),
                whole(working.block_sums),
                whole(working.hosts),
                whole(working.copies),
                whole(&parameters.opacity_logits),
                whole(&parameters.log_scales),
                whole(working.counts),
            ],
        );
        let arrays = [parameters, &splats.first_moments, &splats.second_moments]
            .map(trapeze_gpu::ParameterBuffers::arrays);
        let copy = |i: usize| ArrayCopy {
            width: widths[i],
            pipeline: kernels.copy(gpu, widths[i]),
            bind_group: kernels.copy_interface.bind(
                gpu,
                &[
                    whole(&uniform),
                    whole(working.hosts),
                    whole(working.copies),
                    whole(arrays[0][i].buffer),
                    whole(arrays[1][i].buffer),
                    whole(arrays[2][i].buffer),
                ],
            ),
        };
        let copies = (0..6).filter(|&i| widths[i] > 0).map(copy).collect();
        Self { weigh_pipeline: kernels.weigh(gpu, widths[5]), uniform, weigh, relocate, copies }
    }

    fn record(
        &self,
        gpu: &Gpu,
        kernels: &TrainingKernels,
        encoder: &mut wgpu::CommandEncoder,
        copies: &wgpu::Buffer,
        numbers: &Densification,
    ) {
        gpu.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(numbers));
        encoder.clear_buffer(copies, 0, None);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("densify"),
            timestamp_writes: None,
        });
        let (splats, count) = (numbers.splats.div_ceil(256), numbers.count.div_ceil(256));
        pass.set_pipeline(&self.weigh_pipeline);
        pass.set_bind_group(0, &self.weigh, &[]);
        dispatch(&mut pass, Groups::Direct(splats));
        pass.set_bind_group(0, &self.relocate, &[]);
        pass.set_pipeline(&kernels.sum_blocks);
        dispatch(&mut pass, Groups::Direct(1));
        pass.set_pipeline(&kernels.draw);
        dispatch(&mut pass, Groups::Direct(count));
        pass.set_pipeline(&kernels.correct);
        dispatch(&mut pass, Groups::Direct(splats));
        for array in &self.copies {
            pass.set_pipeline(&array.pipeline);
            pass.set_bind_group(0, &array.bind_group, &[]);
            dispatch(&mut pass, Groups::Direct((numbers.count * array.width).div_ceil(256)));
        }
    }
}
