//! Pipelines of the network under training.

use crate::kernel::{Binding, Interface};
use crate::{Gpu, shaders};

/// A kernel with one entry point.
#[derive(Debug)]
pub(crate) struct Kernel {
    pub interface: Interface,
    pub pipeline: wgpu::ComputePipeline,
}

/// One kernel per stage.
#[derive(Debug)]
pub(crate) struct DeformationKernels {
    pub encode: Kernel,
    pub layer: Kernel,
    pub apply: Kernel,
    pub apply_backward: Kernel,
    pub layer_backward: Kernel,
    pub weights_backward: Kernel,
    pub weights_sum: Kernel,
}

impl DeformationKernels {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        use Binding::{Read, Uniform, UniformAt, Write};
        let kernel = |shader: shaders::Shader, bindings: &[Binding]| {
            let interface = Interface::new(gpu, shader.name, &shader.source(), bindings);
            Kernel { pipeline: interface.pipeline(gpu, shader.name, &[]), interface }
        };
        Self {
            encode: kernel(shaders::network::ENCODE, &[UniformAt, Read, Write]),
            layer: kernel(shaders::network::LAYER, &[Uniform, Read, Write]),
            apply: kernel(
                shaders::network::APPLY,
                &[UniformAt, Uniform, Read, Read, Read, Read, Read, Write, Write, Write],
            ),
            apply_backward: kernel(
                shaders::network::APPLY_BACKWARD,
                &[UniformAt, Uniform, Read, Read, Read, Read, Write, Write, Write],
            ),
            layer_backward: kernel(shaders::network::LAYER_BACKWARD, &[Uniform, Read, Write]),
            weights_backward: kernel(
                shaders::network::WEIGHTS_BACKWARD,
                &[UniformAt, Uniform, Read, Write],
            ),
            weights_sum: kernel(shaders::network::WEIGHTS_SUM, &[UniformAt, Uniform, Read, Write]),
        }
    }
}
