//! The renderers behind the variants, under one roof: draw a frame, and tell how long it took.

use std::sync::Arc;
use std::time::{Duration, Instant};

use trapeze_gpu::{Gpu, MemoryPlan, SceneSize};
use trapeze_scene::{Camera, Frame, FrameSettings, Scene};

use super::variant::VariantBackend;
use crate::error::CliError;
use crate::measure::warm_up_gpu;

pub(super) enum Engine {
    Cpu(Box<trapeze_cpu::Renderer>, Frame),
    Gpu(Box<trapeze_gpu::Renderer>),
}

impl Engine {
    /// `gpu` is there whenever a variant needs it.
    pub(super) fn new(
        scene: &Arc<Scene>,
        backend: VariantBackend,
        gpu: Option<&Gpu>,
    ) -> Result<Self, CliError> {
        match (backend, gpu) {
            (VariantBackend::Cpu(options), _) => {
                let renderer = trapeze_cpu::Renderer::with_options(scene.clone(), options);
                Ok(Self::Cpu(Box::new(renderer), Frame::default()))
            }
            (VariantBackend::Gpu(options), Some(gpu)) => {
                let renderer = trapeze_gpu::Renderer::with_options(gpu, scene.clone(), options)?;
                Ok(Self::Gpu(Box::new(renderer)))
            }
            (VariantBackend::Gpu(_), None) => {
                Err(CliError::argument("--backend", "a GPU for the GPU's variants", "none"))
            }
        }
    }

    pub(super) fn render(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Frame, CliError> {
        match self {
            Self::Cpu(renderer, frame) => {
                renderer.render_into(camera, settings, frame)?;
                Ok(frame.clone())
            }
            Self::Gpu(renderer) => Ok(renderer.render(camera, settings)?),
        }
    }

    /// Draws until the clocks of a GPU are up; the reference before it left it idle. A software device
    /// has none to raise.
    pub(super) fn warm_up(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<(), CliError> {
        let Self::Gpu(renderer) = self else { return Ok(()) };
        if renderer.gpu().is_software() {
            return Ok(());
        }
        Ok(warm_up_gpu(|| {
            renderer.forget_deformation();
            renderer.draw_timed(camera, settings)
        })?)
    }

    /// Time of a frame until its image is there: in memory, or on the GPU, by the GPU's own clock
    /// where it has one.
    pub(super) fn time(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Duration, CliError> {
        let start = Instant::now();
        match self {
            Self::Cpu(renderer, frame) => renderer.render_into(camera, settings, frame)?,
            Self::Gpu(renderer) => {
                if let Some(stages) = renderer.draw_timed(camera, settings)? {
                    return Ok(stages.total);
                }
            }
        }
        Ok(start.elapsed())
    }

    /// Kernel of the network on the GPU.
    pub(super) fn network_kernel(&self) -> Option<&'static str> {
        match self {
            Self::Cpu(..) => None,
            Self::Gpu(renderer) => renderer.network_kernel(),
        }
    }
}

/// Bytes that a variant takes on the device.
pub(super) fn device_bytes(
    scene: &Scene,
    backend: VariantBackend,
    image: [u32; 2],
) -> Result<Option<u64>, CliError> {
    match backend {
        VariantBackend::Cpu(_) => Ok(None),
        VariantBackend::Gpu(options) => {
            let plan = MemoryPlan::new(&SceneSize::of(scene)?, &options, image, false);
            Ok(Some(plan.total()))
        }
    }
}
