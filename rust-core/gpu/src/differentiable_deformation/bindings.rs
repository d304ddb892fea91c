//! Bind groups: those of a layer, and those of the splats that are deformed.

use super::BLOCK_STRIDE;
use super::buffers::NetworkBuffers;
use super::kernels::{DeformationKernels, Stage};
use crate::kernel::{part, whole};
use crate::layout::{NetworkChunk, NetworkLayer};
use crate::{Gpu, ParameterBuffers};

impl NetworkBuffers {
    /// The uniform block of a layer.
    fn layer(&self, index: u32) -> wgpu::BufferBinding<'_> {
        part(&self.layers, u64::from(index * BLOCK_STRIDE), size_of::<NetworkLayer>() as u64)
    }

    /// The uniform block of a chunk, whose offset is given with the dispatch.
    fn chunk(&self) -> wgpu::BufferBinding<'_> {
        part(&self.chunks, 0, size_of::<NetworkChunk>() as u64)
    }

    /// Index of the heads.
    fn heads(&self) -> u32 {
        (self.layers.size() / u64::from(BLOCK_STRIDE)) as u32 - 1
    }
}

/// Both ways through one layer.
#[derive(Debug)]
pub(super) struct LayerBindings {
    pub(super) forward: wgpu::BindGroup,
    pub(super) backward: wgpu::BindGroup,
    pub(super) weights_backward: wgpu::BindGroup,
    pub(super) weights_sum: wgpu::BindGroup,
}

impl LayerBindings {
    pub(super) fn new(
        gpu: &Gpu,
        kernels: &DeformationKernels,
        buffers: &NetworkBuffers,
        index: u32,
    ) -> Self {
        let (parameters, activations) = (&buffers.parameters, &buffers.activations);
        let rows = || [buffers.layer(index), whole(parameters), whole(activations)];
        Self {
            forward: kernels.bind(gpu, Stage::Layer, &rows()),
            backward: kernels.bind(gpu, Stage::LayerBackward, &rows()),
            weights_backward: kernels.bind(
                gpu,
                Stage::WeightsBackward,
                &[buffers.chunk(), buffers.layer(index), whole(activations), whole(&buffers.parts)],
            ),
            weights_sum: kernels.bind(
                gpu,
                Stage::WeightsSum,
                &[
                    buffers.chunk(),
                    buffers.layer(index),
                    whole(&buffers.parts),
                    whole(&buffers.gradients),
                ],
            ),
        }
    }
}

/// The geometry that is deformed.
#[derive(Debug, PartialEq)]
struct Geometry([wgpu::Buffer; 3]);

impl Geometry {
    fn of(parameters: &ParameterBuffers) -> Self {
        let ParameterBuffers { positions, log_scales, rotations, .. } = parameters;
        Self([positions.clone(), log_scales.clone(), rotations.clone()])
    }
}

/// From splats to the network and back to splats.
#[derive(Debug)]
pub(super) struct ForwardBindings {
    canonical: Geometry,
    pub(super) encode: wgpu::BindGroup,
    pub(super) apply: wgpu::BindGroup,
    pub(super) hold: wgpu::BindGroup,
}

impl ForwardBindings {
    pub(super) fn new(
        gpu: &Gpu,
        kernels: &DeformationKernels,
        buffers: &NetworkBuffers,
        canonical: &ParameterBuffers,
    ) -> Self {
        Self {
            canonical: Geometry::of(canonical),
            encode: kernels.bind(
                gpu,
                Stage::Encode,
                &[
                    buffers.chunk(),
                    whole(&canonical.positions),
                    whole(&buffers.activations),
                    whole(&buffers.order),
                ],
            ),
            apply: kernels.bind(
                gpu,
                Stage::Apply,
                &[
                    buffers.chunk(),
                    buffers.layer(buffers.heads()),
                    whole(&buffers.parameters),
                    whole(&buffers.activations),
                    whole(&canonical.positions),
                    whole(&canonical.log_scales),
                    whole(&canonical.rotations),
                    whole(&buffers.deformed_positions),
                    whole(&buffers.deformed_log_scales),
                    whole(&buffers.deformed_rotations),
                    whole(&buffers.order),
                ],
            ),
            hold: kernels.bind(
                gpu,
                Stage::Hold,
                &[
                    buffers.chunk(),
                    whole(&buffers.order),
                    whole(&buffers.held),
                    whole(&canonical.positions),
                    whole(&canonical.log_scales),
                    whole(&canonical.rotations),
                    whole(&buffers.deformed_positions),
                    whole(&buffers.deformed_log_scales),
                    whole(&buffers.deformed_rotations),
                ],
            ),
        }
    }

    /// Whether they bind these splats.
    pub(super) fn are_of(&self, canonical: &ParameterBuffers) -> bool {
        self.canonical == Geometry::of(canonical)
    }
}

/// From gradients by the deformed splats to those by the canonical ones and by the outputs.
#[derive(Debug)]
pub(super) struct BackwardBindings {
    canonical: Geometry,
    gradients: Geometry,
    pub(super) apply: wgpu::BindGroup,
    pub(super) hold: wgpu::BindGroup,
}

impl BackwardBindings {
    pub(super) fn new(
        gpu: &Gpu,
        kernels: &DeformationKernels,
        buffers: &NetworkBuffers,
        canonical: &ParameterBuffers,
        gradients: &ParameterBuffers,
    ) -> Self {
        Self {
            canonical: Geometry::of(canonical),
            gradients: Geometry::of(gradients),
            apply: kernels.bind(
                gpu,
                Stage::ApplyBackward,
                &[
                    buffers.chunk(),
                    buffers.layer(buffers.heads()),
                    whole(&canonical.log_scales),
                    whole(&canonical.rotations),
                    whole(&buffers.deformed_log_scales),
                    whole(&gradients.positions),
                    whole(&gradients.log_scales),
                    whole(&gradients.rotations),
                    whole(&buffers.activations),
                    whole(&buffers.order),
                ],
            ),
            hold: kernels.bind(
                gpu,
                Stage::HoldBackward,
                &[
                    buffers.chunk(),
                    whole(&buffers.order),
                    whole(&canonical.log_scales),
                    whole(&canonical.rotations),
                    whole(&buffers.deformed_log_scales),
                    whole(&gradients.log_scales),
                    whole(&gradients.rotations),
                ],
            ),
        }
    }

    /// Whether they bind these splats and gradients.
    pub(super) fn are_of(
        &self,
        canonical: &ParameterBuffers,
        gradients: &ParameterBuffers,
    ) -> bool {
        self.canonical == Geometry::of(canonical) && self.gradients == Geometry::of(gradients)
    }
}
