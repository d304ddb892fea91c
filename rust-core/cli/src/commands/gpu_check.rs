//! `trapeze info --gpu`: what the device is, and whether its kernels tell the truth on it.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use serde::Serialize;
use trapeze_cpu::reference;
use trapeze_gpu::{
    Gpu, HarmonicsStorage, MemoryPlan, NetworkPrecision, Renderer, RendererOptions, SceneSize,
    SelfCheckReport, self_check,
};
use trapeze_scene::{Bounds, Camera, FrameSettings, Orbit, Scene, psnr};

use super::render::open_gpu;
use crate::error::CliError;

/// Size of the checked image of a scene, and of the image that memory is planned for.
const CHECKED_SIZE: (u32, u32) = (160, 120);
const PLANNED_SIZE: [u32; 2] = [1920, 1080];

/// The built-in checks, and what a given scene takes and shows.
#[derive(Debug, Serialize)]
pub(super) struct GpuCheck {
    #[serde(flatten)]
    pub(super) report: SelfCheckReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<SceneCheck>,
}

#[derive(Debug, Serialize)]
struct SceneCheck {
    /// Bytes on the device, for images of 1920 × 1080.
    memory: MemoryPlan,
    memory_bytes: u64,
    /// Each variant against the f64 reference.
    variants: Vec<VariantCheck>,
}

#[derive(Debug, Serialize)]
struct VariantCheck {
    name: &'static str,
    /// Kernel of the network, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    network: Option<&'static str>,
    /// dB; null for equal images.
    psnr: f64,
    milliseconds: f64,
}

pub(super) fn check(scene: Option<Scene>) -> Result<GpuCheck, CliError> {
    let gpu = open_gpu()?;
    let report = self_check(&gpu);
    let scene = scene.map(|scene| check_scene(&gpu, &Arc::new(scene))).transpose()?;
    Ok(GpuCheck { report, scene })
}

/// Renders a small frame of the scene with every variant of the kernels.
fn check_scene(gpu: &Gpu, scene: &Arc<Scene>) -> Result<SceneCheck, CliError> {
    let size = SceneSize::of(scene)?;
    let memory = MemoryPlan::new(&size, &RendererOptions::default(), PLANNED_SIZE, true);
    let camera = camera_of(scene);
    let settings = FrameSettings { time: 0.37, ..FrameSettings::default() };
    let exact = reference::render(scene, &camera, &settings).to_frame();
    let mut variants = Vec::new();
    for (name, harmonics, precision) in [
        ("f32", HarmonicsStorage::Single, NetworkPrecision::Single),
        ("f16 harmonics", HarmonicsStorage::Half, NetworkPrecision::Single),
        ("8-bit harmonics", HarmonicsStorage::Byte, NetworkPrecision::Single),
        ("f16 network", HarmonicsStorage::Single, NetworkPrecision::Half),
    ] {
        if precision == NetworkPrecision::Half && scene.deformation.is_none() {
            continue;
        }
        let options = RendererOptions { harmonics, precision, ..RendererOptions::default() };
        let mut renderer = Renderer::with_options(gpu, Arc::clone(scene), options)?;
        // The first frame compiles kernels.
        let frame = renderer.render(&camera, &settings)?;
        let start = Instant::now();
        renderer.forget_deformation();
        renderer.render(&camera, &settings)?;
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        let psnr = psnr(&frame.color, &exact.color);
        let network = renderer.network_kernel();
        variants.push(VariantCheck { name, network, psnr, milliseconds });
    }
    Ok(SceneCheck { memory_bytes: memory.total(), memory, variants })
}

fn camera_of(scene: &Scene) -> Camera {
    let unit = Bounds { min: DVec3::splat(-1.0), max: DVec3::ONE };
    let orbit = Orbit { azimuth: 35.0, elevation: 24.0, up: DVec3::Y };
    orbit.frame(&scene.framing_bounds().unwrap_or(unit), 0.8, CHECKED_SIZE)
}
