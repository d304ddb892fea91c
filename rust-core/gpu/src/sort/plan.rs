//! The passes of one sort over one set of buffers.

use super::SortKernels;
use crate::kernel::{part, whole};
use crate::layout::SortPass;
use crate::stage_pass::{Groups, dispatch};
use crate::{Gpu, GpuError};

/// Keys and values, twice: a pass moves them from one to the other.
#[derive(Debug)]
pub(crate) struct PairBuffers {
    pub keys: [wgpu::Buffer; 2],
    pub values: [wgpu::Buffer; 2],
    /// Pairs that fit.
    pub capacity: u32,
}

impl PairBuffers {
    pub(crate) fn new(
        gpu: &Gpu,
        labels: [&'static str; 2],
        capacity: u32,
    ) -> Result<Self, GpuError> {
        let bytes = u64::from(capacity) * 4;
        let make = |label| gpu.storage(label, bytes);
        Ok(Self {
            keys: [make(labels[0])?, make(labels[0])?],
            values: [make(labels[1])?, make(labels[1])?],
            capacity,
        })
    }
}

/// The passes of a sort, least significant digit first.
#[derive(Debug)]
pub(crate) struct SortPlan {
    passes: Vec<Pass>,
    /// Number of pairs with each digit in the last pass that ran.
    pub digit_counts: wgpu::Buffer,
    /// Keys per block.
    pub block: u32,
}

#[derive(Debug)]
struct Pass {
    drops: bool,
    bind_group: wgpu::BindGroup,
}

/// Bytes between the uniform blocks of two passes: the largest alignment that a device may ask for.
const PASS_STRIDE: usize = 256;

/// Keys per thread: many keys need few blocks, whose counts are scanned by one workgroup a digit;
/// few keys need many blocks, to fill the device.
pub(crate) fn keys_per_thread(capacity: u32) -> u32 {
    if capacity <= 1 << 20 { 4 } else { 16 }
}

impl SortPlan {
    /// A sort of the pairs in `pairs` by the digits with the lowest bits `shifts`. The number of
    /// pairs is `counts[counter]`. With `drops_not_drawn` a pass before all others sorts all
    /// `pairs.capacity` pairs by their low keys (in place of the values) and drops what is not
    /// drawn; the values become positions.
    ///
    /// Pass i reads buffers i % 2 and writes the others.
    pub(crate) fn new(
        gpu: &Gpu,
        kernels: &SortKernels,
        pairs: &PairBuffers,
        counts: &wgpu::Buffer,
        counter: usize,
        shifts: &[u32],
        drops_not_drawn: bool,
    ) -> Result<Self, GpuError> {
        let keys_per_thread = keys_per_thread(pairs.capacity);
        let block = 256 * keys_per_thread;
        let max_blocks = pairs.capacity.div_ceil(block).max(1);
        let block_counts = gpu.storage("block counts", u64::from(max_blocks) * 256 * 4)?;
        let digit_counts = gpu.storage("digit counts", 256 * 4)?;
        let first = drops_not_drawn.then_some((0, true));
        let passes: Vec<(u32, bool)> =
            first.into_iter().chain(shifts.iter().map(|&shift| (shift, false))).collect();
        let mut blocks = vec![0; passes.len() * PASS_STRIDE];
        for (bytes, &(shift, drops)) in blocks.chunks_exact_mut(PASS_STRIDE).zip(&passes) {
            let count = if drops { pairs.capacity } else { counter as u32 };
            let pass = SortPass { shift, count, keys_per_thread, max_blocks };
            bytes[..size_of::<SortPass>()].copy_from_slice(bytemuck::bytes_of(&pass));
        }
        let uniforms = gpu.uniform_of("sort passes", &blocks);
        let passes = passes
            .iter()
            .enumerate()
            .map(|(i, &(_, drops))| {
                let (from, to) = (i % 2, 1 - i % 2);
                let offset = (i * PASS_STRIDE) as u64;
                let bind_group = kernels.interface.bind(
                    gpu,
                    &[
                        part(&uniforms, offset, size_of::<SortPass>() as u64),
                        whole(counts),
                        whole(&pairs.keys[from]),
                        whole(&pairs.values[from]),
                        whole(&pairs.keys[to]),
                        whole(&pairs.values[to]),
                        whole(&block_counts),
                        whole(&digit_counts),
                    ],
                );
                Pass { drops, bind_group }
            })
            .collect();
        Ok(Self { passes, digit_counts, block })
    }

    /// Number of passes.
    pub(crate) fn len(&self) -> usize {
        self.passes.len()
    }

    /// Records pass `i`; `groups` is the number of blocks.
    pub(crate) fn record(
        &self,
        kernels: &SortKernels,
        pass: &mut wgpu::ComputePass<'_>,
        i: usize,
        groups: Groups<'_>,
    ) {
        let step = &self.passes[i];
        let pipelines = kernels.pipelines(step.drops);
        pass.set_bind_group(0, &step.bind_group, &[]);
        pass.set_pipeline(&pipelines.histogram);
        dispatch(pass, groups);
        pass.set_pipeline(&pipelines.scan_digits);
        pass.dispatch_workgroups(256, 1, 1);
        pass.set_pipeline(&pipelines.scatter);
        dispatch(pass, groups);
    }
}
