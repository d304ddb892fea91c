//! The forward pass: what it binds, and its dispatches.

use super::buffers::{FrameUniforms, ImageBuffers, SlotBuffers, SplatBuffers};
use super::kernels::DifferentiableKernels;
use super::times;
use crate::kernel::{part, whole};
use crate::kernels::Kernels;
use crate::layout::{Region, argument};
use crate::stage_pass::{Groups, begin_pass, dispatch};
use crate::{Gpu, ParameterBuffers};

/// Bind groups of the forward pass.
#[derive(Debug)]
pub(super) struct ForwardBindings {
    pub parameters: ParameterBuffers,
    project: wgpu::BindGroup,
    color: wgpu::BindGroup,
    arguments: wgpu::BindGroup,
    bin: wgpu::BindGroup,
    ranges: wgpu::BindGroup,
    resolve: wgpu::BindGroup,
    rasterize: wgpu::BindGroup,
    /// Which pair of buffers the tile sort ends in.
    pub sorted: usize,
}

/// The buffers of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameBuffers<'a> {
    pub uniforms: &'a FrameUniforms,
    pub splats: &'a SplatBuffers,
    pub slots: &'a SlotBuffers,
    pub image: &'a ImageBuffers,
}

impl ForwardBindings {
    pub(super) fn new(
        gpu: &Gpu,
        own: &DifferentiableKernels,
        parameters: &ParameterBuffers,
        frame: FrameBuffers<'_>,
    ) -> Self {
        let kernels = &gpu.kernels().tiles;
        let FrameBuffers { uniforms, splats, slots, image } = frame;
        let (projected, order, pairs) = (&splats.projected, &splats.order, &slots.entries.pairs);
        let sorted = slots.entries.sort(image.tile_count()).len() % 2;
        // The other pair of the sort is free once it is done.
        let entry_splats = &pairs.values[1 - sorted];
        let region = || part(&image.region, 0, size_of::<Region>() as u64);
        Self {
            parameters: parameters.clone(),
            project: own.project_interface.bind(
                gpu,
                &[
                    whole(&uniforms.frame),
                    whole(&uniforms.splats),
                    whole(&parameters.positions),
                    whole(&parameters.log_scales),
                    whole(&parameters.rotations),
                    whole(&parameters.opacity_logits),
                    whole(&projected.centres),
                    whole(&projected.extents),
                    whole(&splats.pairs.keys[0]),
                    whole(&splats.pairs.values[0]),
                    whole(&splats.visible),
                    whole(&splats.first_slots),
                ],
            ),
            color: own.color_interface.bind(
                gpu,
                &[
                    whole(&uniforms.frame),
                    whole(&uniforms.splats),
                    whole(&parameters.positions),
                    whole(&parameters.sh_dc),
                    whole(&parameters.sh_rest),
                    whole(&splats.visible),
                    whole(&projected.colors),
                ],
            ),
            arguments: kernels.bind_arguments(gpu, region(), order),
            bin: own.bin.bind(
                gpu,
                &[
                    region(),
                    whole(&order.order),
                    whole(&projected.centres),
                    whole(&projected.extents),
                    whole(&order.counts),
                    whole(&order.group_entries),
                    whole(&pairs.keys[0]),
                    whole(&pairs.values[0]),
                    whole(&slots.slot_splats),
                ],
            ),
            ranges: kernels.ranges_interface.bind(
                gpu,
                &[
                    region(),
                    whole(&order.counts),
                    whole(&pairs.keys[sorted]),
                    whole(&image.tile_starts),
                ],
            ),
            resolve: own.resolve_interface.bind(
                gpu,
                &[
                    whole(&order.counts),
                    whole(&pairs.values[sorted]),
                    whole(&slots.slot_splats),
                    whole(entry_splats),
                ],
            ),
            rasterize: kernels.rasterize_interface.bind(
                gpu,
                &[
                    region(),
                    whole(&image.tile_starts),
                    whole(entry_splats),
                    whole(&projected.centres),
                    whole(&projected.extents),
                    whole(&projected.colors),
                    whole(&image.image),
                    whole(&image.layers),
                ],
            ),
            sorted,
        }
    }

    /// Records the stages of a frame.
    pub(super) fn record(
        &self,
        kernels: &Kernels,
        own: &DifferentiableKernels,
        frame: FrameBuffers<'_>,
        depth: bool,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: Option<&wgpu::QuerySet>,
    ) {
        let FrameBuffers { splats, slots, image, .. } = frame;
        let order = &splats.order;
        {
            let mut pass = begin_pass(encoder, "project", times::PROJECT, timestamps);
            pass.set_pipeline(&own.project);
            pass.set_bind_group(0, &self.project, &[]);
            dispatch(&mut pass, Groups::Direct(splats.capacity.div_ceil(256)));
            pass.set_pipeline(&own.color);
            pass.set_bind_group(0, &self.color, &[]);
            dispatch(&mut pass, Groups::Direct(self.parameters.count.div_ceil(64)));
        }
        {
            let mut pass = begin_pass(encoder, "sort", times::SORT, timestamps);
            let blocks = Groups::Direct(splats.depth_blocks);
            splats.depth_sort.record(&kernels.sort, &mut pass, 0, blocks);
            pass.set_pipeline(&kernels.tiles.drawing_order);
            pass.set_bind_group(0, &self.arguments, &[0]);
            pass.dispatch_workgroups(1, 1, 1);
            for step in 1..splats.depth_sort.len() {
                let groups = order.groups(argument::DEPTH_SORT);
                splats.depth_sort.record(&kernels.sort, &mut pass, step, groups);
            }
        }
        {
            let mut pass = begin_pass(encoder, "bin", times::BIN, timestamps);
            pass.set_pipeline(&own.count);
            pass.set_bind_group(0, &self.bin, &[0]);
            dispatch(&mut pass, order.groups(argument::BIN));
            pass.set_pipeline(&kernels.tiles.entries);
            pass.set_bind_group(0, &self.arguments, &[0]);
            pass.dispatch_workgroups(1, 1, 1);
            pass.set_pipeline(&own.emit);
            pass.set_bind_group(0, &self.bin, &[0]);
            dispatch(&mut pass, order.groups(argument::EMIT));
            let tiles = image.tile_count();
            let sort = slots.entries.sort(tiles);
            for step in 0..sort.len() {
                sort.record(&kernels.sort, &mut pass, step, order.groups(argument::ENTRY_SORT));
            }
            pass.set_pipeline(&kernels.tiles.ranges);
            pass.set_bind_group(0, &self.ranges, &[0]);
            dispatch(&mut pass, Groups::Direct((tiles + 1).div_ceil(256)));
            pass.set_pipeline(&own.resolve);
            pass.set_bind_group(0, &self.resolve, &[]);
            dispatch(&mut pass, order.groups(argument::ENTRY_CHUNKS));
        }
        let mut pass = begin_pass(encoder, "rasterize", times::RASTERIZE, timestamps);
        pass.set_pipeline(kernels.tiles.blending(depth));
        pass.set_bind_group(0, &self.rasterize, &[0]);
        dispatch(&mut pass, order.groups(argument::RASTERIZE));
    }
}
