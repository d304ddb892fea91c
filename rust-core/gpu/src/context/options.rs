//! How to choose and open a device.

use crate::GpuError;

/// Limits and features that are used no further than this, to run as a weaker device would.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeviceProfile {
    /// All that the adapter has.
    #[default]
    Full,
    /// What every Apple GPU since A14 / M1 promises: 32 KiB of workgroup memory, 1 024 threads,
    /// 29 storage buffers a stage; no assumption about subgroups.
    Apple,
    /// A weak device: no optional feature, 10 storage buffers, 16 KiB of workgroup memory, 256
    /// threads, 128 MiB bindings.
    Weak,
}

/// How to choose and open a device.
#[derive(Clone, Debug, Default)]
pub struct GpuOptions {
    /// Part of the adapter's name, in any case; the fastest adapter for `None`.
    pub adapter: Option<String>,
    /// Limits to impose.
    pub profile: DeviceProfile,
    /// Most bytes of a single buffer, when lower than the adapter's limit; for tests of how large
    /// scenes are taken apart.
    pub max_buffer_bytes: Option<u64>,
    /// Most bytes of a single binding, likewise.
    pub max_binding_bytes: Option<u64>,
}

/// Features that make something faster or measurable, and are used where they exist.
pub(super) fn optional_features() -> wgpu::Features {
    wgpu::Features::TIMESTAMP_QUERY
        | wgpu::Features::SHADER_F16
        | wgpu::Features::EXPERIMENTAL_COOPERATIVE_MATRIX
}

pub(super) fn choose_adapter(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
    options: &GpuOptions,
) -> Result<wgpu::Adapter, GpuError> {
    let none = |found: String| GpuError::NoAdapter {
        expected: options.adapter.clone().unwrap_or_else(|| "a Vulkan or Metal device".into()),
        found,
    };
    let Some(wanted) = &options.adapter else {
        return pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        }))
        .map_err(|e| none(e.to_string()));
    };
    let backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL;
    let adapters = pollster::block_on(instance.enumerate_adapters(backends));
    let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
    adapters
        .into_iter()
        .find(|a| a.get_info().name.to_lowercase().contains(&wanted.to_lowercase()))
        .ok_or_else(|| none(names.join(", ")))
}

pub(super) fn imposed_limits(adapter: wgpu::Limits, options: &GpuOptions) -> wgpu::Limits {
    let mut limits = adapter;
    match options.profile {
        DeviceProfile::Full => {}
        DeviceProfile::Apple => {
            limits.max_compute_workgroup_storage_size =
                limits.max_compute_workgroup_storage_size.min(32 << 10);
            limits.max_compute_invocations_per_workgroup =
                limits.max_compute_invocations_per_workgroup.min(1024);
            limits.max_storage_buffers_per_shader_stage =
                limits.max_storage_buffers_per_shader_stage.min(29);
        }
        DeviceProfile::Weak => {
            limits.max_compute_workgroup_storage_size =
                limits.max_compute_workgroup_storage_size.min(16 << 10);
            limits.max_compute_invocations_per_workgroup =
                limits.max_compute_invocations_per_workgroup.min(256);
            limits.max_storage_buffers_per_shader_stage =
                limits.max_storage_buffers_per_shader_stage.min(10);
            limits.max_storage_buffer_binding_size =
                limits.max_storage_buffer_binding_size.min(128 << 20);
        }
    }
    if let Some(bytes) = options.max_buffer_bytes {
        limits.max_buffer_size = limits.max_buffer_size.min(bytes);
    }
    if let Some(bytes) = options.max_binding_bytes {
        limits.max_storage_buffer_binding_size = limits.max_storage_buffer_binding_size.min(bytes);
    }
    limits
}

/// What the kernels need at least.
pub(super) fn check_limits(adapter: &wgpu::Adapter, limits: &wgpu::Limits) -> Result<(), GpuError> {
    let needs = [
        ("storage buffers per stage", 9, u64::from(limits.max_storage_buffers_per_shader_stage)),
        (
            "workgroup memory in bytes",
            16 << 10,
            u64::from(limits.max_compute_workgroup_storage_size),
        ),
        ("threads per workgroup", 256, u64::from(limits.max_compute_invocations_per_workgroup)),
    ];
    match needs.into_iter().find(|&(_, need, have)| have < need) {
        None => Ok(()),
        Some((what, need, have)) => {
            Err(GpuError::TooWeak { adapter: adapter.get_info().name, what, need, have })
        }
    }
}
