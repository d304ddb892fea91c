//! Surfaces on the `CAMetalLayer` of an app's view.

use std::ffi::c_void;
use std::ptr::{self, NonNull};

use objc2_quartz_core::CAMetalLayer;

use super::{SurfaceOptions, WindowSurface, no_surface};
use crate::{Gpu, GpuError};

impl WindowSurface {
    /// A surface on a layer whose drawables have `size` pixels (not points). The surface keeps the
    /// layer alive, and sets its device, pixel format, drawable size and colour space.
    ///
    /// # Errors
    /// [`GpuError::Surface`] when the device cannot show images on it.
    pub fn on_layer(
        gpu: &Gpu,
        layer: &CAMetalLayer,
        size: [u32; 2],
        options: SurfaceOptions,
    ) -> Result<Self, GpuError> {
        let pointer = ptr::from_ref(layer).cast_mut().cast::<c_void>();
        let target = wgpu::SurfaceTargetUnsafe::CoreAnimationLayer(pointer);
        // SAFETY: the reference proves that the layer is alive and a CAMetalLayer; wgpu retains it
        // for as long as the surface exists.
        let surface = unsafe { gpu.instance().create_surface_unsafe(target) };
        Self::on(gpu, surface.map_err(|e| no_surface(&e))?, None, size, options)
    }

    /// The same from an address, as it crosses an FFI border.
    ///
    /// # Errors
    /// [`GpuError::Surface`] when the device cannot show images on it.
    ///
    /// # Safety
    /// `layer` is the address of a `CAMetalLayer` that is alive during this call.
    pub unsafe fn on_layer_at(
        gpu: &Gpu,
        layer: NonNull<c_void>,
        size: [u32; 2],
        options: SurfaceOptions,
    ) -> Result<Self, GpuError> {
        // SAFETY: promised by the caller.
        let layer = unsafe { layer.cast::<CAMetalLayer>().as_ref() };
        Self::on_layer(gpu, layer, size, options)
    }
}
