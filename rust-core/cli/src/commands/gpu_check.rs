//! `trapeze info --gpu`: what the device is, and whether its kernels tell the truth on it.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use serde::Serialize;
use trapeze_cpu::reference;
use trapeze_gpu::{DeviceReport, HarmonicsStorage, NetworkPrecision, Renderer, RendererOptions};
use trapeze_scene::{Bounds, Camera, FrameSettings, Orbit, Scene, ShDegree, Splats, psnr};

use super::render::open_gpu;
use crate::error::CliError;

/// Least PSNR against the f64 reference of a kernel that rounds and does nothing else, dB.
const SINGLE_PSNR: f64 = 60.0;
/// The same for variants in half precision.
const HALF_PSNR: f64 = 45.0;

#[derive(Debug, Serialize)]
pub(super) struct GpuCheck {
    device: DeviceReport,
    checks: Vec<Check>,
    ok: bool,
}

/// One variant against the f64 reference.
#[derive(Debug, Serialize)]
struct Check {
    name: &'static str,
    /// Kernel of the network, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    network: Option<&'static str>,
    /// Infinite for equal images, which JSON writes as null.
    psnr: f64,
    milliseconds: f64,
    ok: bool,
}

/// Renders a small frame of the scene, or of a built-in one, with every variant of the kernels.
pub(super) fn check(scene: Option<Scene>) -> Result<GpuCheck, CliError> {
    let gpu = open_gpu()?;
    let scene = Arc::new(scene.unwrap_or_else(built_in_scene));
    let camera = camera_of(&scene);
    let settings = FrameSettings { time: 0.37, ..FrameSettings::default() };
    let exact = reference::render(&scene, &camera, &settings).to_frame();
    let variants = [
        ("f32", HarmonicsStorage::Single, NetworkPrecision::Single, SINGLE_PSNR),
        ("f16 harmonics", HarmonicsStorage::Half, NetworkPrecision::Single, HALF_PSNR),
        ("f16 network", HarmonicsStorage::Single, NetworkPrecision::Half, HALF_PSNR),
    ];
    let mut checks = Vec::new();
    for (name, harmonics, precision, least) in variants {
        if precision == NetworkPrecision::Half && scene.deformation.is_none() {
            continue;
        }
        let options = RendererOptions { harmonics, precision, ..RendererOptions::default() };
        let mut renderer = Renderer::with_options(&gpu, scene.clone(), options)?;
        // The first frame compiles kernels.
        let frame = renderer.render(&camera, &settings)?;
        let start = Instant::now();
        renderer.forget_deformation();
        renderer.render(&camera, &settings)?;
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        let psnr = psnr(&frame.color, &exact.color);
        let network = renderer.network_kernel();
        checks.push(Check { name, network, psnr, milliseconds, ok: psnr >= least });
    }
    let ok = checks.iter().all(|check| check.ok);
    Ok(GpuCheck { device: DeviceReport::of(&gpu), checks, ok })
}

fn camera_of(scene: &Scene) -> Camera {
    let unit = Bounds { min: DVec3::splat(-1.0), max: DVec3::ONE };
    let orbit = Orbit { azimuth: 35.0, elevation: 24.0, up: DVec3::Y };
    orbit.frame(&scene.framing_bounds().unwrap_or(unit), 0.8, (160, 120))
}

/// Splats all over a ball, of every shape and opacity, with harmonics of degree 3.
fn built_in_scene() -> Scene {
    let n = 2000;
    let wave = |i: usize, k: f32| (i as f32 * k).sin();
    Scene::from_splats(Splats {
        positions: (0..n).map(|i| [wave(i, 1.7), wave(i, 2.3), wave(i, 3.1)]).collect(),
        log_scales: (0..n)
            .map(|i| [-3.0 + wave(i, 0.7), -3.5 + wave(i, 0.9), -4.0 + wave(i, 1.1)])
            .collect(),
        rotations: (0..n).map(|i| [1.0, wave(i, 4.1), wave(i, 5.3), wave(i, 6.7)]).collect(),
        opacity_logits: (0..n).map(|i| 3.0 * wave(i, 7.9)).collect(),
        sh_dc: (0..n).map(|i| [wave(i, 8.3), wave(i, 9.1), wave(i, 9.7)]).collect(),
        sh_rest: (0..n * 45).map(|i| 0.2 * wave(i, 0.37)).collect(),
        sh_degree: ShDegree::Three,
    })
}
