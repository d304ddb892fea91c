//! The backward pass: what it binds, and its dispatches.

use super::forward::FrameBuffers;
use super::kernels::DifferentiableKernels;
use super::{ImageGradientBuffers, times};
use crate::kernel::whole;
use crate::layout::argument;
use crate::stage_pass::{Groups, begin_pass, dispatch};
use crate::{Gpu, ParameterBuffers};

/// Bind groups of the backward pass, and what they were made for.
#[derive(Debug)]
pub(super) struct BackwardBindings {
    by_color: wgpu::Buffer,
    by_depth: Option<wgpu::Buffer>,
    gradients: ParameterBuffers,
    depth_gradient: Option<wgpu::BindGroup>,
    rasterize: wgpu::BindGroup,
    sum_slots: wgpu::BindGroup,
    project: wgpu::BindGroup,
    color: wgpu::BindGroup,
}

impl BackwardBindings {
    pub(super) fn new(
        gpu: &Gpu,
        kernels: &DifferentiableKernels,
        parameters: &ParameterBuffers,
        frame: FrameBuffers<'_>,
        by_image: ImageGradientBuffers<'_>,
        gradients: &ParameterBuffers,
    ) -> Self {
        let FrameBuffers { uniforms, splats, slots, image } = frame;
        let (projected, order, pairs) = (&splats.projected, &splats.order, &slots.entries.pairs);
        let sorted = slots.entries.sort(image.tile_count()).len() % 2;
        let depth_gradient = by_image.expected_depth.map(|by_depth| {
            kernels.depth_gradient_interface.bind(
                gpu,
                &[
                    whole(&image.region),
                    whole(&image.image),
                    whole(&image.layers),
                    whole(by_depth),
                    whole(&image.by_depth_sums),
                ],
            )
        });
        Self {
            by_color: by_image.color.clone(),
            by_depth: by_image.expected_depth.cloned(),
            gradients: gradients.clone(),
            depth_gradient,
            rasterize: kernels.rasterize_backward_interface.bind(
                gpu,
                &[
                    whole(&image.region),
                    whole(&image.tile_starts),
                    whole(&pairs.values[1 - sorted]),
                    whole(&pairs.values[sorted]),
                    whole(&projected.centres),
                    whole(&projected.extents),
                    whole(&projected.colors),
                    whole(&image.image),
                    whole(by_image.color),
                    whole(&image.by_depth_sums),
                    whole(&slots.slots),
                ],
            ),
            sum_slots: kernels.sum_slots.bind(
                gpu,
                &[
                    whole(&uniforms.splats),
                    whole(&order.counts),
                    whole(&slots.slot_splats),
                    whole(&slots.slots),
                    whole(&splats.first_slots),
                    whole(&splats.sums),
                ],
            ),
            project: kernels.project_backward_interface.bind(
                gpu,
                &[
                    whole(&uniforms.frame),
                    whole(&uniforms.splats),
                    whole(&parameters.positions),
                    whole(&parameters.log_scales),
                    whole(&parameters.rotations),
                    whole(&projected.centres),
                    whole(&projected.extents),
                    whole(&splats.sums),
                    whole(&gradients.positions),
                    whole(&gradients.log_scales),
                    whole(&gradients.rotations),
                ],
            ),
            color: kernels.color_backward_interface.bind(
                gpu,
                &[
                    whole(&uniforms.frame),
                    whole(&uniforms.splats),
                    whole(&parameters.positions),
                    whole(&parameters.sh_dc),
                    whole(&parameters.sh_rest),
                    whole(&parameters.opacity_logits),
                    whole(&splats.sums),
                    whole(&gradients.positions),
                    whole(&gradients.sh_dc),
                    whole(&gradients.sh_rest),
                    whole(&gradients.opacity_logits),
                ],
            ),
        }
    }

    /// Whether they bind these buffers.
    pub(super) fn are_of(
        &self,
        by_image: ImageGradientBuffers<'_>,
        gradients: &ParameterBuffers,
    ) -> bool {
        self.by_color == *by_image.color
            && self.by_depth.as_ref() == by_image.expected_depth
            && self.gradients.shares_buffers_with(gradients)
    }

    /// Records the stages.
    pub(super) fn record(
        &self,
        kernels: &DifferentiableKernels,
        count: u32,
        frame: FrameBuffers<'_>,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: Option<&wgpu::QuerySet>,
    ) {
        let FrameBuffers { splats, image, .. } = frame;
        let order = &splats.order;
        let sums = kernels.sums(self.depth_gradient.is_some());
        {
            let mut pass =
                begin_pass(encoder, "rasterize_backward", times::RASTERIZE_BACKWARD, timestamps);
            if let Some(bind_group) = &self.depth_gradient {
                pass.set_pipeline(&kernels.depth_gradient);
                pass.set_bind_group(0, bind_group, &[]);
                dispatch(&mut pass, Groups::Direct(image.pixel_count().div_ceil(256)));
            }
            pass.set_pipeline(&sums.rasterize_backward);
            pass.set_bind_group(0, &self.rasterize, &[]);
            dispatch(&mut pass, order.groups(argument::RASTERIZE));
        }
        {
            let mut pass = begin_pass(encoder, "sum_slots", times::SUM_SLOTS, timestamps);
            pass.set_bind_group(0, &self.sum_slots, &[]);
            pass.set_pipeline(&sums.sum_chunks);
            dispatch(&mut pass, order.groups(argument::ENTRY_CHUNKS));
            pass.set_pipeline(&sums.sum_splats);
            dispatch(&mut pass, Groups::Direct(count.div_ceil(256)));
        }
        let mut pass = begin_pass(encoder, "project_backward", times::PROJECT_BACKWARD, timestamps);
        pass.set_pipeline(&kernels.project_backward);
        pass.set_bind_group(0, &self.project, &[]);
        dispatch(&mut pass, Groups::Direct(count.div_ceil(256)));
        pass.set_pipeline(&kernels.color_backward);
        pass.set_bind_group(0, &self.color, &[]);
        dispatch(&mut pass, Groups::Direct(count.div_ceil(64)));
    }
}
