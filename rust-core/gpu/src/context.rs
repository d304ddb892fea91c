//! The device: choosing an adapter, and making its objects.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use wgpu::util::DeviceExt;

use crate::GpuError;
use crate::kernels::Kernels;

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

/// Objects created since the device was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Created {
    /// Buffers.
    pub buffers: u64,
    /// Their bytes.
    pub buffer_bytes: u64,
    /// Bind groups.
    pub bind_groups: u64,
    /// Pipelines.
    pub pipelines: u64,
    /// Times that the CPU waited for the GPU.
    pub waits: u64,
}

#[derive(Debug, Default)]
struct Counts {
    buffers: AtomicU64,
    buffer_bytes: AtomicU64,
    bind_groups: AtomicU64,
    pipelines: AtomicU64,
    waits: AtomicU64,
}

/// An open GPU. Cheap to clone; every renderer on it shares one device and one queue.
#[derive(Clone, Debug)]
pub struct Gpu {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    options: GpuOptions,
    instance: wgpu::Instance,
    adapter: wgpu::Adapter,
    device: wgpu::Device,
    queue: wgpu::Queue,
    limits: wgpu::Limits,
    features: wgpu::Features,
    created: Counts,
    /// Why the device is gone, once it is.
    lost: Arc<OnceLock<String>>,
    /// The first error that nobody expected: a fault in this crate or in the driver.
    fault: Arc<OnceLock<String>>,
    kernels: OnceLock<Kernels>,
}

/// Features that make something faster or measurable, and are used where they exist.
fn optional_features() -> wgpu::Features {
    wgpu::Features::TIMESTAMP_QUERY
        | wgpu::Features::SHADER_F16
        | wgpu::Features::EXPERIMENTAL_COOPERATIVE_MATRIX
}

impl Gpu {
    /// Opens the device that the options describe.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] when there is none, [`GpuError::TooWeak`] when it cannot run the
    /// kernels, [`GpuError::Device`] when the driver refuses.
    pub fn open(options: &GpuOptions) -> Result<Self, GpuError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL;
        // Validation of indirect dispatches would add a dispatch to each of them; the kernels that
        // write the arguments fold them into what the limits allow.
        descriptor.flags = wgpu::InstanceFlags::empty();
        let instance = wgpu::Instance::new(descriptor);
        Self::open_on(instance, None, options)
    }

    /// Opens a device that can present to `surface`, on the instance that made the surface.
    ///
    /// # Errors
    /// Those of [`open`](Self::open).
    pub fn open_on(
        instance: wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
        options: &GpuOptions,
    ) -> Result<Self, GpuError> {
        let adapter = choose_adapter(&instance, surface, options)?;
        let limits = imposed_limits(adapter.limits(), options);
        check_limits(&adapter, &limits)?;
        let features = match options.profile {
            DeviceProfile::Weak => wgpu::Features::empty(),
            DeviceProfile::Full | DeviceProfile::Apple => adapter.features() & optional_features(),
        };
        let experimental = if features.contains(wgpu::Features::EXPERIMENTAL_COOPERATIVE_MATRIX) {
            // SAFETY: cooperative matrices are used in one kernel, whose loads and stores stay
            // inside its own workgroup memory and weight buffer, and which is used only after its
            // results have been compared with those of the plain kernel on this device.
            unsafe { wgpu::ExperimentalFeatures::enabled() }
        } else {
            wgpu::ExperimentalFeatures::disabled()
        };
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("trapeze"),
            required_features: features,
            required_limits: limits.clone(),
            experimental_features: experimental,
            memory_hints: wgpu::MemoryHints::Performance,
            trace: wgpu::Trace::Off,
        });
        let (device, queue) =
            pollster::block_on(request).map_err(|e| GpuError::Device(e.to_string()))?;
        let lost = Arc::new(OnceLock::new());
        let cell = lost.clone();
        device.set_device_lost_callback(move |reason, message| {
            // Destroyed is what a closed device tells too, when nobody listens any more.
            if reason != wgpu::DeviceLostReason::Destroyed {
                tracing::error!("GPU device lost: {message}");
            }
            let _ = cell.set(message);
        });
        let fault = Arc::new(OnceLock::new());
        let cell = fault.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            // The first one; what follows from it says little.
            if cell.set(error.to_string()).is_ok() {
                tracing::error!("GPU: {error}");
            }
        }));
        let created = Counts::default();
        Ok(Self {
            inner: Arc::new(Inner {
                instance,
                adapter,
                device,
                queue,
                limits,
                features,
                options: options.clone(),
                created,
                lost,
                fault,
                kernels: OnceLock::new(),
            }),
        })
    }

    /// Name, driver and kind of the adapter.
    #[must_use]
    pub fn adapter_info(&self) -> wgpu::AdapterInfo {
        self.inner.adapter.get_info()
    }

    /// Limits that are in force.
    #[must_use]
    pub fn limits(&self) -> &wgpu::Limits {
        &self.inner.limits
    }

    /// Features that are in use.
    #[must_use]
    pub fn features(&self) -> wgpu::Features {
        self.inner.features
    }

    /// Objects created and waits made so far. A steady frame changes none of them.
    #[must_use]
    pub fn created(&self) -> Created {
        let counts = &self.inner.created;
        let read = |count: &AtomicU64| count.load(Ordering::Relaxed);
        Created {
            buffers: read(&counts.buffers),
            buffer_bytes: read(&counts.buffer_bytes),
            bind_groups: read(&counts.bind_groups),
            pipelines: read(&counts.pipelines),
            waits: read(&counts.waits),
        }
    }

    /// Whether the device is gone: every renderer on it has to be made again on a new one.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.inner.lost.get().is_some()
    }

    /// Whether the device can still be used.
    ///
    /// # Errors
    /// [`GpuError::DeviceLost`] when it is gone, [`GpuError::Device`] when it has refused something
    /// that it should not have.
    pub fn check(&self) -> Result<(), GpuError> {
        if let Some(why) = self.inner.lost.get() {
            return Err(GpuError::DeviceLost(why.clone()));
        }
        self.inner.fault.get().map_or(Ok(()), |what| Err(GpuError::Device(what.clone())))
    }

    /// Opens a device anew with the same options, after this one was lost.
    ///
    /// # Errors
    /// Those of [`open`](Self::open).
    pub fn reopened(&self) -> Result<Self, GpuError> {
        Self::open_on(self.instance().clone(), None, &self.inner.options)
    }

    /// The wgpu instance, for surfaces.
    #[must_use]
    pub fn instance(&self) -> &wgpu::Instance {
        &self.inner.instance
    }

    /// The wgpu adapter.
    #[must_use]
    pub fn adapter(&self) -> &wgpu::Adapter {
        &self.inner.adapter
    }

    /// The wgpu device.
    #[must_use]
    pub fn device(&self) -> &wgpu::Device {
        &self.inner.device
    }

    /// The wgpu queue.
    #[must_use]
    pub fn queue(&self) -> &wgpu::Queue {
        &self.inner.queue
    }

    /// Most bytes that one binding of a storage buffer may have.
    #[must_use]
    pub fn max_binding(&self) -> u64 {
        let limits = self.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// Whether the device has what the matrix kernel of the network was written for: products of
    /// 16 × 16 × 16 halves summed in 32 bits, subgroups of 32, and room for its workgroup memory.
    #[must_use]
    pub fn has_matrices(&self) -> bool {
        let wanted = wgpu::Features::EXPERIMENTAL_COOPERATIVE_MATRIX | wgpu::Features::SHADER_F16;
        let info = self.adapter_info();
        self.features().contains(wanted)
            && (info.subgroup_min_size, info.subgroup_max_size) == (32, 32)
            && self.limits().max_compute_workgroup_storage_size >= MATRIX_KERNEL_MEMORY
            && self.adapter().cooperative_matrix_properties().iter().any(|shape| {
                (shape.m_size, shape.n_size, shape.k_size) == (16, 16, 16)
                    && shape.ab_type == wgpu::CooperativeScalarType::F16
                    && shape.cr_type == wgpu::CooperativeScalarType::F32
            })
    }

    /// Waits until the GPU has done all that was submitted.
    ///
    /// # Errors
    /// [`GpuError::DeviceLost`] when it is gone.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.inner.created.waits.fetch_add(1, Ordering::Relaxed);
        let polled = self.device().poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        polled.map(|_| ()).map_err(|e| GpuError::Device(e.to_string()))
    }

    /// Lets callbacks of finished work run, without waiting.
    ///
    /// # Errors
    /// [`GpuError::DeviceLost`] when the device is gone.
    pub fn poll(&self) -> Result<(), GpuError> {
        let polled = self.device().poll(wgpu::PollType::Poll);
        self.check()?;
        polled.map(|_| ()).map_err(|e| GpuError::Device(e.to_string()))
    }

    /// The pipelines of this device; made when they are first asked for.
    pub(crate) fn kernels(&self) -> &Kernels {
        self.inner.kernels.get_or_init(|| Kernels::new(self))
    }

    /// A buffer of at least `bytes`, zeroed.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] when it is larger than a buffer may be, or than what is left.
    pub fn buffer(
        &self,
        label: &'static str,
        bytes: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        // wgpu refuses empty bindings, and structs of kernels are up to 48 bytes.
        let size = bytes.max(256).next_multiple_of(16);
        let have = self.limits().max_buffer_size;
        if size > have {
            return Err(GpuError::OutOfMemory { what: label, need: size, have });
        }
        self.count_buffer(size);
        let scope = self.device().push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let buffer = self.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        });
        match pollster::block_on(scope.pop()) {
            None => Ok(buffer),
            Some(_) => Err(GpuError::OutOfMemory { what: label, need: size, have: 0 }),
        }
    }

    /// A storage buffer of at least `bytes` that can also be copied from and written to.
    ///
    /// # Errors
    /// Those of [`buffer`](Self::buffer).
    pub fn storage(&self, label: &'static str, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC;
        self.buffer(label, bytes, usage)
    }

    /// A storage buffer that holds `data`.
    ///
    /// # Errors
    /// Those of [`buffer`](Self::buffer), and [`GpuError::Device`] when the device is lost.
    pub fn storage_of<T: bytemuck::NoUninit>(
        &self,
        label: &'static str,
        data: &[T],
    ) -> Result<wgpu::Buffer, GpuError> {
        let buffer = self.storage(label, size_of_val(data) as u64)?;
        self.write(&buffer, data)?;
        Ok(buffer)
    }

    /// Writes `data` to the start of a buffer, before anything that is submitted from now on. Large
    /// data go in pieces, with a wait now and then, so that the staging memory stays small.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn write<T: bytemuck::NoUninit>(
        &self,
        buffer: &wgpu::Buffer,
        data: &[T],
    ) -> Result<(), GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        for (i, piece) in bytes.chunks(UPLOAD_PIECE).enumerate() {
            self.queue().write_buffer(buffer, (i * UPLOAD_PIECE) as u64, piece);
            if i % 8 == 7 {
                self.queue().submit([]);
                self.wait()?;
            }
        }
        Ok(())
    }

    /// A uniform buffer that holds `data` and can be written to.
    pub fn uniform_of(&self, label: &'static str, data: &[u8]) -> wgpu::Buffer {
        self.count_buffer(data.len() as u64);
        self.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents: data,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        })
    }

    fn count_buffer(&self, bytes: u64) {
        self.inner.created.buffers.fetch_add(1, Ordering::Relaxed);
        self.inner.created.buffer_bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    pub(crate) fn count_bind_group(&self) {
        self.inner.created.bind_groups.fetch_add(1, Ordering::Relaxed);
    }

    pub(crate) fn count_pipeline(&self) {
        self.inner.created.pipelines.fetch_add(1, Ordering::Relaxed);
    }
}

/// Workgroup memory of deform_matrix.wgsl, bytes.
const MATRIX_KERNEL_MEMORY: u32 = 16_896 * 2 + 2048 * 4;

/// Bytes of one write of an upload.
const UPLOAD_PIECE: usize = 16 << 20;

fn choose_adapter(
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

fn imposed_limits(adapter: wgpu::Limits, options: &GpuOptions) -> wgpu::Limits {
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
fn check_limits(adapter: &wgpu::Adapter, limits: &wgpu::Limits) -> Result<(), GpuError> {
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
