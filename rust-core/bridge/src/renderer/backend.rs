//! The two renderers behind one set of calls.

use std::sync::Arc;
use std::time::{Duration, Instant};

use trapeze_gpu::{MemoryPlan, SceneSize};
use trapeze_scene::{Camera, Frame, FrameSettings, Scene};

use super::Options;
use crate::device::Device;
use crate::failure::Failure;

/// A scene, ready to be drawn.
#[derive(Debug)]
pub(crate) enum Backend {
    Gpu(Box<GpuBackend>),
    Cpu(Box<trapeze_cpu::Renderer>),
}

/// A scene on the device, and what its memory is planned from.
#[derive(Debug)]
pub(crate) struct GpuBackend {
    pub(super) renderer: trapeze_gpu::Renderer,
    size: SceneSize,
    options: trapeze_gpu::RendererOptions,
}

/// Seconds that a frame took; `None` for a part that is not told.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cost {
    pub(crate) frame: f64,
    pub(crate) deform: Option<f64>,
    pub(crate) sort: Option<f64>,
    pub(crate) rasterize: Option<f64>,
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) splat: u32,
    pub(crate) label: Option<u32>,
    pub(crate) depth: f32,
}

impl Backend {
    pub(crate) fn new(
        device: &Device,
        scene: Arc<Scene>,
        options: Options,
    ) -> Result<Self, Failure> {
        Ok(match device.gpu()? {
            Some(gpu) => {
                let options = trapeze_gpu::RendererOptions {
                    precision: options.precision,
                    max_sh_degree: options.max_sh_degree,
                    ..trapeze_gpu::RendererOptions::default()
                };
                let size = SceneSize::of(&scene)?;
                let renderer = trapeze_gpu::Renderer::with_options(&gpu, scene, options)?;
                Self::Gpu(Box::new(GpuBackend { renderer, size, options }))
            }
            None => Self::Cpu(Box::new(trapeze_cpu::Renderer::new(scene))),
        })
    }

    /// Draws a frame and keeps it; `true` when it has to be drawn again. A `timed` one is waited
    /// for.
    pub(crate) fn draw(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
        timed: bool,
    ) -> Result<(bool, Option<Cost>), Failure> {
        match self {
            Self::Gpu(gpu) if !timed => Ok((gpu.renderer.draw(camera, settings)?, None)),
            _ => Ok((false, self.draw_timed(camera, settings)?)),
        }
    }

    /// Draws a frame, waits for it, and tells what it took on the device.
    pub(crate) fn draw_timed(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Option<Cost>, Failure> {
        let seconds = |d: Duration| Some(d.as_secs_f64());
        match self {
            Self::Gpu(gpu) => {
                let times = gpu.renderer.draw_timed(camera, settings)?;
                Ok(times.map(|times| Cost {
                    frame: times.total.as_secs_f64(),
                    deform: seconds(times.deform),
                    sort: seconds(times.sort),
                    rasterize: seconds(times.rasterize),
                }))
            }
            Self::Cpu(renderer) => {
                let start = Instant::now();
                renderer.render(camera, settings)?;
                let frame = start.elapsed().as_secs_f64();
                let times = renderer.stage_times();
                Ok(Some(Cost {
                    frame,
                    deform: seconds(times.deform),
                    sort: seconds(times.sort),
                    rasterize: seconds(times.rasterize),
                }))
            }
        }
    }

    pub(crate) fn render(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Frame, Failure> {
        Ok(match self {
            Self::Gpu(gpu) => gpu.renderer.render(camera, settings)?,
            Self::Cpu(renderer) => renderer.render(camera, settings)?,
        })
    }

    pub(crate) fn pick(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
        pixel: (u32, u32),
    ) -> Result<Option<Hit>, Failure> {
        Ok(match self {
            Self::Gpu(gpu) => gpu.renderer.pick(camera, settings, pixel)?.map(|p| Hit {
                splat: p.splat,
                label: p.cluster,
                depth: p.depth,
            }),
            Self::Cpu(renderer) => renderer.pick(camera, settings, pixel)?.map(|p| Hit {
                splat: p.splat,
                label: p.cluster,
                depth: p.depth,
            }),
        })
    }

    pub(crate) fn visible_splats(&self) -> usize {
        match self {
            Self::Gpu(gpu) => gpu.renderer.visible_splats(),
            Self::Cpu(renderer) => renderer.visible_splats(),
        }
    }

    /// Bytes of the buffers on the device for frames of this size, as planned; 0 on the CPU.
    pub(crate) fn device_bytes(&self, image: [u32; 2]) -> u64 {
        match self {
            Self::Gpu(gpu) => MemoryPlan::new(&gpu.size, &gpu.options, image, false).total(),
            Self::Cpu(_) => 0,
        }
    }

    /// Waits until the device has done all that it was given.
    pub(crate) fn wait(&self) -> Result<(), Failure> {
        match self {
            Self::Gpu(gpu) => Ok(gpu.renderer.gpu().wait()?),
            Self::Cpu(_) => Ok(()),
        }
    }

    pub(crate) fn is_lost(&self) -> bool {
        matches!(self, Self::Gpu(gpu) if gpu.renderer.gpu().is_lost())
    }
}
