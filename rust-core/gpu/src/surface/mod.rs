//! Onto the screen: a window's surface that shows what a renderer drew.

mod blit;
mod format;
#[cfg(target_vendor = "apple")]
mod metal_layer;
#[cfg(test)]
mod tests;

use std::sync::Arc;

pub(crate) use blit::{Blit, ImageView};

use crate::{Gpu, GpuError, Renderer};

/// How a surface shows images.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// r g b under what the splats leave open: display (sRGB-encoded) values, 0 … 1.
    pub background: [f32; 3],
    /// Whether frames wait for the display's refresh; without, they may tear.
    pub wait_for_refresh: bool,
}

impl Default for SurfaceOptions {
    fn default() -> Self {
        Self { background: [0.0; 3], wait_for_refresh: true }
    }
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presented {
    /// It is on its way to the screen.
    Shown,
    /// The window shows nothing at the moment: it is hidden, has no area, or gave no texture in
    /// time. Try again with the next frame.
    Skipped,
}

type MakeSurface = dyn Fn(&wgpu::Instance) -> Result<wgpu::Surface<'static>, wgpu::CreateSurfaceError>
    + Send
    + Sync;

/// The surface of a window or of a `CAMetalLayer`, on which images of a [`Renderer`] are shown.
///
/// Colour space: the surface is sRGB, and gets the renderer's display values unchanged where it
/// offers a format that stores plain numbers, as all known ones do; otherwise decoded to linear
/// light. Images of another size than the surface are stretched to it.
///
/// A surface that was outdated or lost is configured again, or made again from its window, before
/// the next frame is shown.
pub struct WindowSurface {
    gpu: Gpu,
    surface: wgpu::Surface<'static>,
    /// Makes the surface again; `None` where only the owner of the layer can.
    make: Option<Box<MakeSurface>>,
    format: wgpu::TextureFormat,
    size: [u32; 2],
    options: SurfaceOptions,
    configured: bool,
    blit: Blit,
}

impl std::fmt::Debug for WindowSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("WindowSurface")
            .field("format", &self.format)
            .field("size", &self.size)
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

impl WindowSurface {
    /// A surface on a window of `size` pixels (not points), on the device's own instance.
    ///
    /// # Errors
    /// [`GpuError::Surface`] when the window has none, or none that this device can show images on.
    pub fn new<W>(
        gpu: &Gpu,
        window: Arc<W>,
        size: [u32; 2],
        options: SurfaceOptions,
    ) -> Result<Self, GpuError>
    where
        W: wgpu::rwh::HasWindowHandle + wgpu::rwh::HasDisplayHandle + Send + Sync + 'static,
    {
        let make: Box<MakeSurface> =
            Box::new(move |instance| instance.create_surface(window.clone()));
        let surface = make(gpu.instance()).map_err(|e| no_surface(&e))?;
        Self::on(gpu, surface, Some(make), size, options)
    }

    fn on(
        gpu: &Gpu,
        surface: wgpu::Surface<'static>,
        make: Option<Box<MakeSurface>>,
        size: [u32; 2],
        options: SurfaceOptions,
    ) -> Result<Self, GpuError> {
        let formats = surface.get_capabilities(gpu.adapter()).formats;
        let Some((format, _)) = format::choose(&formats) else {
            return Err(GpuError::Surface {
                expected: "a surface that this device presents to",
                found: format!("formats {formats:?}"),
            });
        };
        let blit = Blit::new(gpu, format)?;
        let mut new = Self {
            gpu: gpu.clone(),
            surface,
            make,
            format,
            size: [0; 2],
            options,
            configured: false,
            blit,
        };
        new.resize(size)?;
        Ok(new)
    }

    /// Pixels across and down.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Format of the surface's textures.
    #[must_use]
    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// Tells the surface that its window now has `size` pixels. A window without area shows nothing
    /// until it has one again.
    ///
    /// # Errors
    /// [`GpuError::Surface`] when the device has no textures of that size; the old size stays.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<(), GpuError> {
        let most = self.gpu.limits().max_texture_dimension_2d;
        if size.iter().any(|&side| side > most) {
            return Err(GpuError::Surface {
                expected: "sides that a texture of this device can have",
                found: format!("{} × {} pixels, have {most}", size[0], size[1]),
            });
        }
        if size != self.size {
            self.size = size;
            self.configured = false;
        }
        Ok(())
    }

    /// Changes what is under the splats, from the next frame on.
    pub fn set_background(&mut self, background: [f32; 3]) {
        self.options.background = background;
    }

    /// Shows the last image that `renderer`, which is on the surface's device, has drawn; the
    /// background alone before the first.
    ///
    /// # Errors
    /// [`GpuError::Surface`] when the surface is lost and cannot be made again,
    /// [`GpuError::DeviceLost`] when the device is, [`GpuError::OutOfMemory`] when the image is
    /// larger than one binding of the device.
    pub fn present(&mut self, renderer: &Renderer) -> Result<Presented, GpuError> {
        self.gpu.check()?;
        if renderer.gpu().device() != self.gpu.device() {
            return Err(GpuError::Surface {
                expected: "a renderer on the surface's device",
                found: "one on another device".into(),
            });
        }
        let Some(target) = self.acquire()? else { return Ok(Presented::Skipped) };
        let view = target.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
        let background = self.options.background;
        self.blit.record(
            &self.gpu,
            &mut encoder,
            renderer.image(),
            background,
            &view,
            self.size,
        )?;
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.queue().present(target);
        Ok(Presented::Shown)
    }

    /// The texture of the next frame, after mending the surface where that is needed.
    fn acquire(&mut self) -> Result<Option<wgpu::SurfaceTexture>, GpuError> {
        use wgpu::CurrentSurfaceTexture as Current;
        if self.size.contains(&0) {
            return Ok(None);
        }
        // Once as it is, once configured again, once made again.
        for _ in 0..3 {
            if !self.configured {
                self.configure();
            }
            match self.surface.get_current_texture() {
                Current::Success(texture) => return Ok(Some(texture)),
                Current::Suboptimal(texture) => {
                    // Configuring waits until this texture is gone.
                    self.configured = false;
                    return Ok(Some(texture));
                }
                Current::Timeout | Current::Occluded => return Ok(None),
                Current::Outdated => self.configured = false,
                Current::Lost => self.make_again()?,
                Current::Validation => {
                    return Err(GpuError::Surface {
                        expected: "a texture of the surface",
                        found: "a validation error".into(),
                    });
                }
            }
        }
        Ok(None)
    }

    fn make_again(&mut self) -> Result<(), GpuError> {
        let Some(make) = &self.make else {
            return Err(GpuError::Surface {
                expected: "the layer that the surface was made on",
                found: "a lost surface".into(),
            });
        };
        self.surface = make(self.gpu.instance()).map_err(|e| no_surface(&e))?;
        self.configured = false;
        Ok(())
    }

    fn configure(&mut self) {
        let [width, height] = self.size;
        let present_mode = match self.options.wait_for_refresh {
            true => wgpu::PresentMode::AutoVsync,
            false => wgpu::PresentMode::AutoNoVsync,
        };
        self.surface.configure(
            self.gpu.device(),
            &wgpu::SurfaceConfiguration {
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
                format: self.format,
                color_space: wgpu::SurfaceColorSpace::Auto,
                width,
                height,
                present_mode,
                desired_maximum_frame_latency: 2,
                // Alpha is 1 everywhere: the background is part of the image.
                alpha_mode: wgpu::CompositeAlphaMode::Auto,
                view_formats: Vec::new(),
            },
        );
        self.configured = true;
    }
}

fn no_surface(error: &wgpu::CreateSurfaceError) -> GpuError {
    GpuError::Surface { expected: "a window that can be drawn into", found: error.to_string() }
}
