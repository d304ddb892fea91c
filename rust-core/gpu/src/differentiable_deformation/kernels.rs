//! Pipelines of the network under training.

use super::NetworkProducts;
use crate::kernel::{Binding, Interface};
use crate::shaders::network;
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
    /// Those for split products only on devices that [have matrices](Gpu::has_matrices).
    pub(crate) fn new(gpu: &Gpu, products: NetworkProducts) -> Self {
        use Binding::{Read, Uniform, UniformAt, Write};
        let entry = |shader: shaders::Shader, entry_point: &str, bindings: &[Binding]| {
            let interface = Interface::new(gpu, shader.name, &shader.source(), bindings);
            Kernel { pipeline: interface.pipeline(gpu, entry_point, &[]), interface }
        };
        let kernel =
            |shader: shaders::Shader, bindings: &[Binding]| entry(shader, shader.name, bindings);
        // The variants of a product share their entry point.
        let product = |single: shaders::Shader, split, bindings: &[Binding]| match products {
            NetworkProducts::Single => entry(single, single.name, bindings),
            NetworkProducts::Split => entry(split, single.name, bindings),
        };
        Self([
            kernel(network::ENCODE, &[UniformAt, Read, Write, Read]),
            product(network::LAYER, network::LAYER_SPLIT, &[Uniform, Read, Write]),
            kernel(
                network::APPLY,
                &[UniformAt, Uniform, Read, Read, Read, Read, Read, Write, Write, Write, Read],
            ),
            kernel(network::HOLD, &[UniformAt, Read, Read, Read, Read, Read, Write, Write, Write]),
            kernel(network::HOLD_BACKWARD, &[UniformAt, Read, Read, Read, Read, Write, Write]),
            kernel(
                network::APPLY_BACKWARD,
                &[UniformAt, Uniform, Read, Read, Read, Read, Write, Write, Write, Read],
            ),
            product(
                network::WEIGHTS_BACKWARD,
                network::WEIGHTS_BACKWARD_SPLIT,
                &[UniformAt, Uniform, Read, Write],
            ),
            kernel(network::WEIGHTS_SUM, &[UniformAt, Uniform, Read, Write]),
            product(
                network::LAYER_BACKWARD,
                network::LAYER_BACKWARD_SPLIT,
                &[Uniform, Read, Write],
            ),
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
