//! The app's layer, on which frames are shown.

use trapeze_gpu::{Gpu, GpuError, Presented, WindowSurface};

use super::backend::Backend;
use crate::failure::{Code, Failure};

/// A surface on a `CAMetalLayer`. The app keeps the layer alive for as long as it is attached.
#[derive(Debug)]
pub(super) struct Screen {
    layer: usize,
    size: [u32; 2],
    /// Made again when its device was lost.
    surface: WindowSurface,
}

impl Screen {
    pub(super) fn new(gpu: &Gpu, layer: usize, size: [u32; 2]) -> Result<Self, Failure> {
        Ok(Self { layer, size, surface: surface_on(gpu, layer, size)? })
    }

    pub(super) fn layer(&self) -> usize {
        self.layer
    }

    pub(super) fn resize(&mut self, size: [u32; 2]) -> Result<(), Failure> {
        self.surface.resize(size)?;
        self.size = size;
        Ok(())
    }

    /// Shows what was drawn last; `false` when the layer took no frame.
    pub(super) fn present(
        &mut self,
        backend: &Backend,
        background: [f32; 3],
    ) -> Result<bool, Failure> {
        let Backend::Gpu(gpu) = backend else {
            let message = "layer: expected a graphics device to draw on it, found the CPU";
            return Err(Failure::new(Code::NoDevice, message));
        };
        let renderer = &gpu.renderer;
        self.surface.set_background(background);
        match self.surface.present(renderer) {
            Ok(presented) => Ok(presented == Presented::Shown),
            // The renderer is on another device than the surface since that was lost.
            Err(GpuError::DeviceLost(_)) if !renderer.gpu().is_lost() => {
                self.surface = surface_on(renderer.gpu(), self.layer, self.size)?;
                Ok(false)
            }
            Err(error) => Err(error.into()),
        }
    }
}

#[cfg(target_vendor = "apple")]
fn surface_on(gpu: &Gpu, layer: usize, size: [u32; 2]) -> Result<WindowSurface, GpuError> {
    let Some(layer) = std::ptr::NonNull::new(std::ptr::with_exposed_provenance_mut(layer)) else {
        return Err(GpuError::Surface { expected: "a CAMetalLayer", found: "none".into() });
    };
    // SAFETY: the app promises that the address is that of a CAMetalLayer that lives until another
    // one is attached; its wrapper takes nothing else.
    unsafe { WindowSurface::on_layer_at(gpu, layer, size, trapeze_gpu::SurfaceOptions::default()) }
}

#[cfg(not(target_vendor = "apple"))]
fn surface_on(_: &Gpu, _: usize, _: [u32; 2]) -> Result<WindowSurface, GpuError> {
    Err(GpuError::Surface { expected: "a system with CAMetalLayer", found: "another".into() })
}
