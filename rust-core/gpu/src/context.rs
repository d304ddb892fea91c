//! The device.

mod buffers;
mod options;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use crate::GpuError;
use crate::kernels::Kernels;

use self::buffers::Counts;
pub use self::buffers::Created;
pub use self::options::{DeviceProfile, GpuOptions};
use self::options::{check_limits, choose_adapter, imposed_limits, optional_features};

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
            // SAFETY: cooperative matrices are used in two kinds of kernels, whose loads and stores
            // stay inside their own workgroup memory and the weights, and which are used only after
            // their results have been compared with those of plain kernels on this device.
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

    /// Whether the adapter is no hardware but the CPU behind a driver (lavapipe, SwiftShader).
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.adapter_info().device_type == wgpu::DeviceType::Cpu
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

    /// Whether the device has what the matrix kernels of the network were written for: products of
    /// 16 × 16 × 16 halves summed in 32 bits, subgroups of 32, and room for their workgroup memory.
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
}

/// Workgroup memory of deform_matrix.wgsl, which takes most, bytes.
const MATRIX_KERNEL_MEMORY: u32 = 16_896 * 2 + 2048 * 4;
