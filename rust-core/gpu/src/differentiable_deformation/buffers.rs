//! What a deformation network takes on the device.

use super::BLOCK_STRIDE;
use super::network_layout::NetworkLayout;
use crate::layout::NetworkLayer;
use crate::{Gpu, GpuError};

/// Bytes of the outputs of one splat.
pub(super) const HELD_BYTES: u64 = 40;

/// What does not depend on whose splats are deformed.
#[derive(Debug)]
pub(super) struct NetworkBuffers {
    pub(super) parameters: wgpu::Buffer,
    pub(super) gradients: wgpu::Buffer,
    pub(super) activations: wgpu::Buffer,
    pub(super) parts: wgpu::Buffer,
    /// One block per chunk, and one for the splats that rest.
    pub(super) chunks: wgpu::Buffer,
    /// One block per layer.
    pub(super) layers: wgpu::Buffer,
    /// Splats that the network moves, then those that rest.
    pub(super) order: wgpu::Buffer,
    /// Outputs of those that rest.
    pub(super) held: wgpu::Buffer,
    pub(super) deformed_positions: wgpu::Buffer,
    pub(super) deformed_log_scales: wgpu::Buffer,
    pub(super) deformed_rotations: wgpu::Buffer,
}

impl NetworkBuffers {
    pub(super) fn new(
        gpu: &Gpu,
        layout: &NetworkLayout,
        capacity: u32,
        columns: u32,
    ) -> Result<Self, GpuError> {
        // One more for the splats that rest.
        let chunks = (capacity.div_ceil(columns).max(1) + 1) * BLOCK_STRIDE;
        let mut layers = vec![0; layout.layers.len() * BLOCK_STRIDE as usize];
        let slots = layers.chunks_exact_mut(BLOCK_STRIDE as usize);
        for (slot, layer) in slots.zip(&layout.layers) {
            slot[..size_of::<NetworkLayer>()].copy_from_slice(bytemuck::bytes_of(layer));
        }
        let parameter_bytes = 4 * layout.parameters as u64;
        let activation_bytes = u64::from(columns) * layout.column_bytes();
        let splats = u64::from(capacity);
        for (what, need) in [
            ("activations of 128 splats in one binding", activation_bytes),
            ("gradients of a layer in one binding", layout.parts_bytes()),
            ("held outputs", splats * HELD_BYTES),
        ] {
            let have = gpu.max_binding();
            if need > have {
                return Err(GpuError::OutOfMemory { what, need, have });
            }
        }
        Ok(Self {
            parameters: gpu.storage("network", parameter_bytes)?,
            gradients: gpu.storage("gradients of the network", parameter_bytes)?,
            activations: gpu.storage("activations", activation_bytes)?,
            parts: gpu.storage("parts of the network's gradients", layout.parts_bytes())?,
            chunks: gpu.uniform_of("chunks", &vec![0; chunks as usize]),
            layers: gpu.uniform_of("layers", &layers),
            order: gpu.storage_of("order", &(0..capacity).collect::<Vec<u32>>())?,
            held: gpu.storage("held outputs", splats * HELD_BYTES)?,
            deformed_positions: gpu.storage("deformed positions", splats * 12)?,
            deformed_log_scales: gpu.storage("deformed log-scales", splats * 12)?,
            deformed_rotations: gpu.storage("deformed rotations", splats * 16)?,
        })
    }
}
