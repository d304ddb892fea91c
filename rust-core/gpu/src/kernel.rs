//! One entry point of a shader with its bindings.

use crate::Gpu;

/// What a binding is, in the order of binding numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// A uniform block.
    Uniform,
    /// A uniform block at an offset that is given with each dispatch.
    UniformAt,
    /// A storage buffer that is only read.
    Read,
    /// A storage buffer that is also written.
    Write,
}

/// The bindings that the entry points of one shader share.
#[derive(Debug)]
pub struct Interface {
    label: &'static str,
    module: wgpu::ShaderModule,
    bindings: Vec<Binding>,
    bind_group_layout: wgpu::BindGroupLayout,
    pipeline_layout: wgpu::PipelineLayout,
}

impl Interface {
    /// Compiles a shader of this crate, without run-time checks.
    pub(crate) fn new(gpu: &Gpu, label: &'static str, source: &str, bindings: &[Binding]) -> Self {
        Self::with_module(gpu, label, shader_module(gpu, label, source), bindings)
    }

    /// Compiles any shader whose bindings, all in group 0, are `bindings` in order. An index beyond
    /// a buffer's end reads or writes some other element, and a loop without an end is ended.
    ///
    /// # Panics
    /// When the source is no valid WGSL: the sources are part of the program.
    #[must_use]
    pub fn checked(gpu: &Gpu, label: &'static str, source: &str, bindings: &[Binding]) -> Self {
        let module = gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        Self::with_module(gpu, label, module, bindings)
    }

    /// [`checked`](Self::checked) without the checks, which cost some kernels an eighth of their time.
    ///
    /// # Safety
    /// Every index that an entry point forms, for any contents of the buffers that it can be given,
    /// is below the length of what it indexes, and every loop ends.
    ///
    /// # Panics
    /// When the source is no valid WGSL.
    #[must_use]
    pub unsafe fn trusted(
        gpu: &Gpu,
        label: &'static str,
        source: &str,
        bindings: &[Binding],
    ) -> Self {
        Self::new(gpu, label, source, bindings)
    }

    fn with_module(
        gpu: &Gpu,
        label: &'static str,
        module: wgpu::ShaderModule,
        bindings: &[Binding],
    ) -> Self {
        let device = gpu.device();
        let entries: Vec<wgpu::BindGroupLayoutEntry> = (0u32..)
            .zip(bindings)
            .map(|(binding, &kind)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer {
                    ty: match kind {
                        Binding::Uniform | Binding::UniformAt => wgpu::BufferBindingType::Uniform,
                        Binding::Read => wgpu::BufferBindingType::Storage { read_only: true },
                        Binding::Write => wgpu::BufferBindingType::Storage { read_only: false },
                    },
                    has_dynamic_offset: kind == Binding::UniformAt,
                    min_binding_size: None,
                },
                count: None,
            })
            .collect();
        let bind_group_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &entries,
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(&bind_group_layout)],
            immediate_size: 0,
        });
        Self { label, module, bindings: bindings.to_vec(), bind_group_layout, pipeline_layout }
    }

    /// The pipeline of an entry point, with values for its overridable constants. Workgroup memory
    /// is not cleared first.
    #[must_use]
    pub fn pipeline(
        &self,
        gpu: &Gpu,
        entry_point: &str,
        constants: &[(&str, f64)],
    ) -> wgpu::ComputePipeline {
        gpu.count_pipeline();
        gpu.device().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry_point),
            layout: Some(&self.pipeline_layout),
            module: &self.module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants,
                // Every kernel writes its workgroup memory before it reads it.
                zero_initialize_workgroup_memory: false,
            },
            cache: None,
        })
    }

    /// Binds buffers, in the order of the bindings.
    ///
    /// # Panics
    /// In debug builds, when there are more or fewer buffers than bindings.
    #[must_use]
    pub fn bind(&self, gpu: &Gpu, buffers: &[wgpu::BufferBinding<'_>]) -> wgpu::BindGroup {
        debug_assert_eq!(buffers.len(), self.bindings.len(), "{}", self.label);
        gpu.count_bind_group();
        let entries: Vec<wgpu::BindGroupEntry<'_>> = (0u32..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: wgpu::BindingResource::Buffer(buffer.clone()),
            })
            .collect();
        gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.label),
            layout: &self.bind_group_layout,
            entries: &entries,
        })
    }
}

/// Compiles a module without run-time checks of array bounds and of loops.
///
/// The kernels bound every index themselves, by the counts in their uniform blocks, and count in
/// every loop; the checks cost the rasteriser an eighth of its time (H100).
fn shader_module(gpu: &Gpu, label: &'static str, source: &str) -> wgpu::ShaderModule {
    let descriptor = wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    };
    let checks = wgpu::ShaderRuntimeChecks::unchecked();
    // SAFETY: the sources are part of this crate, or `Interface::trusted` was promised the same of
    // them. Each indexes its buffers with numbers below the
    // counts that the host made the buffers for, or below counts that an earlier kernel has checked
    // against the buffers' capacities, and each loop ends at such a count. The tests run all of
    // them, at the sizes where indices end.
    unsafe { gpu.device().create_shader_module_trusted(descriptor, checks) }
}

/// A whole buffer, as a binding.
#[must_use]
pub fn whole(buffer: &wgpu::Buffer) -> wgpu::BufferBinding<'_> {
    buffer.as_entire_buffer_binding()
}

/// A part of a buffer, as a binding.
#[must_use]
pub fn part(buffer: &wgpu::Buffer, offset: u64, bytes: u64) -> wgpu::BufferBinding<'_> {
    wgpu::BufferBinding { buffer, offset, size: wgpu::BufferSize::new(bytes) }
}

/// Workgroups of a dispatch that together make at least `count` (the twin of `folded` in
/// common/dispatch.wgsl).
pub(crate) fn folded(count: u32) -> (u32, u32, u32) {
    const MAX_GROUPS_PER_ROW: u32 = 65_535;
    (count.min(MAX_GROUPS_PER_ROW), count.div_ceil(MAX_GROUPS_PER_ROW).max(1), 1)
}
