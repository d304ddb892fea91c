//! What a run on the GPU may use.

use trapeze_gpu::{Gpu, NetworkProducts};

/// What the GPU may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GpuBackendOptions {
    /// Bytes that photographs may take.
    pub target_budget: u64,
    /// Bytes that the run may take on the device, photographs included.
    pub memory_budget: u64,
    /// Tile entries to make room for at first; the buffers grow when a view needs more. `None` makes
    /// a guess from the number of splats.
    pub initial_entries: Option<u32>,
    /// Bytes that the deformation network's hidden features may take: 8.5 KB a splat, of as many
    /// splats at a time as fit. When not all do, each step evaluates the network twice for most.
    pub activation_budget: u64,
    /// How the deformation network's products are computed, where that suits device and scene; single
    /// precision elsewhere.
    pub network_products: NetworkProducts,
}

impl Default for GpuBackendOptions {
    /// 512 MiB of photographs, as much for hidden features, 8 GiB in all; matrix units where there are any.
    fn default() -> Self {
        Self {
            target_budget: 512 << 20,
            memory_budget: 8 << 30,
            initial_entries: None,
            activation_budget: 512 << 20,
            network_products: NetworkProducts::Split,
        }
    }
}

impl GpuBackendOptions {
    /// At most `bytes` where the device shares the system's memory; a device with memory of its own
    /// says itself when that is full.
    #[must_use]
    pub fn within(gpu: &Gpu, bytes: u64) -> Self {
        let has_own = gpu.adapter_info().device_type == wgpu::DeviceType::DiscreteGpu;
        if has_own {
            return Self { memory_budget: u64::MAX, ..Self::default() };
        }
        let default = Self::default();
        let activation_budget = default.activation_budget.min(bytes / 8);
        Self { memory_budget: bytes, activation_budget, ..default }
    }
}
