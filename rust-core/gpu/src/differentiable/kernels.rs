//! Pipelines of the passes over trainable parameters.

use crate::kernel::{Binding, Interface};
use crate::{Gpu, shaders};

/// Pipelines, and the interfaces that their buffers are bound by. What forward passes over scenes
/// use as well is in [`Kernels`](crate::kernels::Kernels).
#[derive(Debug)]
pub(crate) struct DifferentiableKernels {
    pub project_interface: Interface,
    pub project: wgpu::ComputePipeline,
    pub color_interface: Interface,
    pub color: wgpu::ComputePipeline,
    pub bin: Interface,
    pub count: wgpu::ComputePipeline,
    pub emit: wgpu::ComputePipeline,
    pub resolve_interface: Interface,
    pub resolve: wgpu::ComputePipeline,
    pub depth_gradient_interface: Interface,
    pub depth_gradient: wgpu::ComputePipeline,
    pub rasterize_backward_interface: Interface,
    pub sum_slots: Interface,
    pub project_backward_interface: Interface,
    pub project_backward: wgpu::ComputePipeline,
    pub color_backward_interface: Interface,
    pub color_backward: wgpu::ComputePipeline,
    by_color: SumKernels,
    by_depth: SumKernels,
}

/// Pipelines that differ by whether there is a gradient by depth.
#[derive(Debug)]
pub(crate) struct SumKernels {
    pub rasterize_backward: wgpu::ComputePipeline,
    pub sum_chunks: wgpu::ComputePipeline,
    pub sum_splats: wgpu::ComputePipeline,
}

/// Storage buffers that the largest of the interfaces binds.
pub(crate) const STORAGE_BUFFERS: u32 = 10;

impl DifferentiableKernels {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        use Binding::{Read, Uniform, UniformAt, Write};
        let interface = |shader: shaders::Shader, bindings: &[Binding]| {
            Interface::new(gpu, shader.name, &shader.source(), bindings)
        };
        let project = interface(
            shaders::PROJECT_PARAMETERS,
            &[Uniform, Uniform, Read, Read, Read, Read, Write, Write, Write, Write, Write, Write],
        );
        let color = interface(
            shaders::COLOR_PARAMETERS,
            &[Uniform, Uniform, Read, Read, Read, Read, Write],
        );
        let bin = interface(
            shaders::BIN_NUMBERED,
            &[UniformAt, Read, Read, Read, Read, Write, Write, Write, Write],
        );
        let resolve = interface(shaders::RESOLVE_ENTRIES, &[Read, Read, Read, Write]);
        let depth_gradient =
            interface(shaders::DEPTH_GRADIENT, &[Uniform, Read, Read, Read, Write]);
        let rasterize_backward = interface(
            shaders::RASTERIZE_BACKWARD,
            &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Write],
        );
        let sum_slots = interface(shaders::SUM_SLOTS, &[Uniform, Read, Read, Write, Write, Write]);
        let project_backward = interface(
            shaders::PROJECT_BACKWARD,
            &[Uniform, Uniform, Read, Read, Read, Read, Read, Read, Write, Write, Write],
        );
        let color_backward = interface(
            shaders::COLOR_BACKWARD,
            &[Uniform, Uniform, Read, Read, Read, Read, Read, Write, Write, Write, Write],
        );
        let sums = |depth: bool| {
            let constants = [("DEPTH", f64::from(u8::from(depth)))];
            SumKernels {
                rasterize_backward: rasterize_backward.pipeline(
                    gpu,
                    "rasterize_backward",
                    &constants,
                ),
                sum_chunks: sum_slots.pipeline(gpu, "sum_chunks", &constants),
                sum_splats: sum_slots.pipeline(gpu, "sum_splats", &constants),
            }
        };
        Self {
            by_color: sums(false),
            by_depth: sums(true),
            project: project.pipeline(gpu, "project", &[]),
            project_interface: project,
            color: color.pipeline(gpu, "color", &[]),
            color_interface: color,
            count: bin.pipeline(gpu, "count", &[]),
            emit: bin.pipeline(gpu, "emit", &[]),
            bin,
            resolve: resolve.pipeline(gpu, "resolve_entries", &[]),
            resolve_interface: resolve,
            depth_gradient: depth_gradient.pipeline(gpu, "depth_gradient", &[]),
            depth_gradient_interface: depth_gradient,
            rasterize_backward_interface: rasterize_backward,
            sum_slots,
            project_backward: project_backward.pipeline(gpu, "project_backward", &[]),
            project_backward_interface: project_backward,
            color_backward: color_backward.pipeline(gpu, "color_backward", &[]),
            color_backward_interface: color_backward,
        }
    }

    /// The pipelines with or without a gradient by depth.
    pub(crate) fn sums(&self, depth: bool) -> &SumKernels {
        if depth { &self.by_depth } else { &self.by_color }
    }
}
