//! Pipelines of the network under training.

use crate::kernel::{Binding, Interface};
use crate::{Gpu, shaders};

/// The kernels, in the order of both passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    Encode,
    Layer,
    Apply,
    Hold,
    HoldBackward,
    ApplyBackward,
    WeightsBackward,
    WeightsSum,
    LayerBackward,
}

/// Number of stages.
pub(super) const STAGES: usize = 9;

/// A kernel with one entry point.
#[derive(Debug)]
pub(super) struct Kernel {
    pub(super) interface: Interface,
    pub(super) pipeline: wgpu::ComputePipeline,
}

/// One kernel per stage.
#[derive(Debug)]
pub(crate) struct DeformationKernels([Kernel; STAGES]);

impl DeformationKernels {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        use Binding::{Read, Uniform, UniformAt, Write};
        let kernel = |shader: shaders::Shader, bindings: &[Binding]| {
            let interface = Interface::new(gpu, shader.name, &shader.source(), bindings);
            Kernel { pipeline: interface.pipeline(gpu, shader.name, &[]), interface }
        };
        Self([
            kernel(shaders::network::ENCODE, &[UniformAt, Read, Write, Read]),
            kernel(shaders::network::LAYER, &[Uniform, Read, Write]),
            kernel(
                shaders::network::APPLY,
                &[UniformAt, Uniform, Read, Read, Read, Read, Read, Write, Write, Write, Read],
            ),
            kernel(
                shaders::network::HOLD,
                &[UniformAt, Read, Read, Read, Read, Read, Write, Write, Write],
            ),
            kernel(
                shaders::network::HOLD_BACKWARD,
                &[UniformAt, Read, Read, Read, Read, Write, Write],
            ),
            kernel(
                shaders::network::APPLY_BACKWARD,
                &[UniformAt, Uniform, Read, Read, Read, Read, Write, Write, Write, Read],
            ),
            kernel(shaders::network::WEIGHTS_BACKWARD, &[UniformAt, Uniform, Read, Write]),
            kernel(shaders::network::WEIGHTS_SUM, &[UniformAt, Uniform, Read, Write]),
            kernel(shaders::network::LAYER_BACKWARD, &[Uniform, Read, Write]),
        ])
    }

    pub(super) fn of(&self, stage: Stage) -> &Kernel {
        &self.0[stage as usize]
    }

    /// Binds buffers to a stage.
    pub(super) fn bind(
        &self,
        gpu: &Gpu,
        stage: Stage,
        buffers: &[wgpu::BufferBinding<'_>],
    ) -> wgpu::BindGroup {
        self.of(stage).interface.bind(gpu, buffers)
    }
}
