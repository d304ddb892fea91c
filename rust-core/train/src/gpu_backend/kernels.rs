//! The pipelines of training, made once per device.

use std::collections::HashMap;

use trapeze_gpu::Gpu;
use trapeze_gpu::compute::{Binding, Interface};
use trapeze_gpu::shaders::training as shaders;

use super::layout::NETWORK_GROUP;
use crate::parameters::ParameterGroup;

/// Interfaces and pipelines; those that depend on the number of SH bands are made when they are
/// first needed.
pub(super) struct TrainingKernels {
    pub(super) loss_interface: Interface,
    pub(super) loss: wgpu::ComputePipeline,
    pub(super) loss_backward: wgpu::ComputePipeline,
    pub(super) report_interface: Interface,
    pub(super) report: wgpu::ComputePipeline,
    pub(super) adam_interface: Interface,
    adam: HashMap<(usize, u32), wgpu::ComputePipeline>,
    pub(super) network_adam: wgpu::ComputePipeline,
    pub(super) noise_interface: Interface,
    pub(super) noise: wgpu::ComputePipeline,
    pub(super) weigh_interface: Interface,
    weigh: HashMap<u32, wgpu::ComputePipeline>,
    pub(super) relocate_interface: Interface,
    pub(super) sum_blocks: wgpu::ComputePipeline,
    pub(super) draw: wgpu::ComputePipeline,
    pub(super) correct: wgpu::ComputePipeline,
    pub(super) copy_interface: Interface,
    copy: HashMap<u32, wgpu::ComputePipeline>,
    pub(super) restride_interface: Interface,
    pub(super) restride: wgpu::ComputePipeline,
}

impl TrainingKernels {
    pub(super) fn new(gpu: &Gpu) -> Self {
        use Binding::{Read, Uniform, Write};
        let interface = |shader: trapeze_gpu::shaders::Shader, bindings: &[Binding]| {
            Interface::checked(gpu, shader.name, &shader.source(), bindings)
        };
        let loss = interface(shaders::LOSS, &[Uniform, Read, Read, Read, Write, Write, Write]);
        let report = interface(shaders::REPORT, &[Uniform, Read, Read, Write]);
        let adam = interface(shaders::ADAM, &[Uniform, Write, Read, Write, Write, Write, Read]);
        let noise = interface(shaders::NOISE, &[Uniform, Write, Read, Read, Read, Read]);
        let relocate =
            interface(shaders::RELOCATE, &[Uniform, Read, Write, Write, Write, Write, Write, Read]);
        let restride = interface(shaders::RESTRIDE, &[Uniform, Read, Write]);
        Self {
            loss: loss.pipeline(gpu, "loss", &[]),
            loss_backward: loss.pipeline(gpu, "loss_backward", &[]),
            loss_interface: loss,
            report: report.pipeline(gpu, "report", &[]),
            report_interface: report,
            network_adam: adam.pipeline(gpu, "adam", &[("GROUP", NETWORK_GROUP as f64)]),
            adam_interface: adam,
            adam: HashMap::new(),
            noise: noise.pipeline(gpu, "noise", &[]),
            noise_interface: noise,
            weigh_interface: interface(
                shaders::WEIGH,
                &[Uniform, Uniform, Read, Read, Read, Read, Read, Read, Write, Write, Write],
            ),
            weigh: HashMap::new(),
            sum_blocks: relocate.pipeline(gpu, "sum_blocks", &[]),
            draw: relocate.pipeline(gpu, "draw", &[]),
            correct: relocate.pipeline(gpu, "correct", &[]),
            relocate_interface: relocate,
            copy_interface: interface(shaders::COPY, &[Uniform, Read, Read, Write, Write, Write]),
            copy: HashMap::new(),
            restride: restride.pipeline(gpu, "restride", &[]),
            restride_interface: restride,
        }
    }

    /// The update of a group with `width` numbers per splat.
    pub(super) fn adam(
        &mut self,
        gpu: &Gpu,
        group: ParameterGroup,
        width: u32,
    ) -> wgpu::ComputePipeline {
        let constants = [("GROUP", f64::from(group as u32)), ("WIDTH", f64::from(width))];
        let make = || self.adam_interface.pipeline(gpu, "adam", &constants);
        self.adam.entry((group as usize, width)).or_insert_with(make).clone()
    }

    /// The weights of splats with `rest_width` numbers in their higher SH bands.
    pub(super) fn weigh(&mut self, gpu: &Gpu, rest_width: u32) -> wgpu::ComputePipeline {
        let constants = [("REST_WIDTH", f64::from(rest_width))];
        let make = || self.weigh_interface.pipeline(gpu, "weigh", &constants);
        self.weigh.entry(rest_width).or_insert_with(make).clone()
    }

    /// The copies of an array with `width` numbers per splat.
    pub(super) fn copy(&mut self, gpu: &Gpu, width: u32) -> wgpu::ComputePipeline {
        let constants = [("WIDTH", f64::from(width))];
        let make = || self.copy_interface.pipeline(gpu, "copy", &constants);
        self.copy.entry(width).or_insert_with(make).clone()
    }
}
