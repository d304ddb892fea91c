//! What a device is, for people and for figures that name the machine they were taken on.

use serde::Serialize;

use crate::Gpu;

/// Name, driver and abilities of a device.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DeviceReport {
    /// The adapter's name.
    pub name: String,
    /// Metal or Vulkan.
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
    /// Discrete, integrated, or software.
    pub kind: String,
    /// Smallest and largest size of a subgroup.
    pub subgroup_sizes: [u32; 2],
    /// Bytes of workgroup memory.
    pub workgroup_memory: u32,
    /// Storage buffers per stage.
    pub storage_buffers: u32,
    /// Most bytes of one binding.
    pub binding_bytes: u64,
    /// Whether stages can be timed.
    pub timestamps: bool,
    /// Whether kernels may use 16-bit floats.
    pub half_floats: bool,
    /// Whether the network may run on cooperative matrices.
    pub matrices: bool,
}

impl DeviceReport {
    /// Describes a device.
    #[must_use]
    pub fn of(gpu: &Gpu) -> Self {
        let info = gpu.adapter_info();
        let limits = gpu.limits();
        Self {
            name: info.name.clone(),
            backend: info.backend.to_string(),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            kind: format!("{:?}", info.device_type),
            subgroup_sizes: [info.subgroup_min_size, info.subgroup_max_size],
            workgroup_memory: limits.max_compute_workgroup_storage_size,
            storage_buffers: limits.max_storage_buffers_per_shader_stage,
            binding_bytes: gpu.max_binding(),
            timestamps: gpu.features().contains(wgpu::Features::TIMESTAMP_QUERY),
            half_floats: gpu.features().contains(wgpu::Features::SHADER_F16),
            matrices: gpu.has_matrices(),
        }
    }
}
