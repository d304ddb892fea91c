//! `trapeze bench … --backend gpu`: times on the GPU's own clock, and the error beside them.

use std::sync::Arc;
use std::time::{Duration, Instant};

use trapeze_cpu::reference;
use trapeze_gpu::{
    DeviceReport, HarmonicsStorage, NetworkPrecision, Renderer, RendererOptions, StageTimes,
};
use trapeze_scene::{FrameSettings, ImageError};

use super::bench::{BenchReport, DeformArguments, Precision, RenderArguments, position_error};
use super::render::{open_gpu, static_threshold};
use crate::error::CliError;
use crate::measure::{Machine, Timing, warm_up_gpu};

pub(super) fn render(arguments: &RenderArguments) -> Result<BenchReport, CliError> {
    let scene = Arc::new(arguments.scene.load()?);
    let camera = arguments.view.camera(&scene)?;
    let settings = FrameSettings { time: arguments.time, ..FrameSettings::default() };
    let gpu = open_gpu()?;
    let harmonics = match arguments.half_harmonics {
        true => HarmonicsStorage::Half,
        false => HarmonicsStorage::Single,
    };
    let options = RendererOptions { harmonics, ..RendererOptions::default() };
    let mut renderer = Renderer::with_options(&gpu, scene.clone(), options)?;
    let frame = renderer.render(&camera, &settings)?;
    warm_up_gpu(|| renderer.draw_timed(&camera, &settings))?;
    let mut stages = Vec::new();
    for _ in 0..arguments.runs.max(1) {
        renderer.forget_deformation();
        stages.extend(renderer.draw_timed(&camera, &settings)?);
    }
    // Playback: frames follow each other without waiting, so that the host's work is hidden.
    let start = Instant::now();
    for _ in 0..arguments.runs.max(1) {
        renderer.forget_deformation();
        renderer.draw(&camera, &settings)?;
    }
    gpu.wait()?;
    let playback = start.elapsed() / arguments.runs.max(1) as u32;
    let exact = reference::render(&scene, &camera, &settings).to_frame();
    Ok(BenchReport {
        what: "render",
        scene: arguments.scene.scene.display().to_string(),
        splats: scene.len(),
        detail: Some(serde_json::json!({
            "backend": "gpu",
            "device": DeviceReport::of(&gpu),
            "harmonics": if arguments.half_harmonics { "f16" } else { "f32" },
            "size": [camera.width, camera.height],
            "visible_splats": renderer.visible_splats(),
            "tile_entries": renderer.tile_entries(),
            "playback_ms_per_frame": playback.as_secs_f64() * 1e3,
            "median_stage_ms": stage_medians(&stages),
        })),
        timing: total_timing(&stages)?,
        error_against_f64: Some(ImageError::between(&frame.color, &exact.color).into()),
        machine: Machine::this(),
    })
}

pub(super) fn deform(arguments: &DeformArguments) -> Result<BenchReport, CliError> {
    let scene = Arc::new(arguments.load_scene()?);
    let Some(network) = &scene.deformation else {
        return Err(CliError::argument("SCENE", "a scene with a deformation network", "none"));
    };
    let threshold = static_threshold(&scene, arguments.static_percentile)?;
    let gpu = open_gpu()?;
    let precision = match arguments.precision {
        Precision::F32 => NetworkPrecision::Single,
        Precision::F16 => NetworkPrecision::Half,
    };
    let options = RendererOptions { precision, ..RendererOptions::default() };
    let mut renderer = Renderer::with_options(&gpu, scene.clone(), options)?;
    let mut time = 0.0;
    let mut durations = Vec::new();
    warm_up_gpu(|| {
        time += 1.0 / 1024.0;
        renderer.deform_timed(time, threshold)
    })?;
    for _ in 0..arguments.runs.max(1) {
        time += 1.0 / 1024.0;
        durations.extend(renderer.deform_timed(time, threshold)?);
    }
    if durations.is_empty() {
        return Err(no_clock());
    }
    let dynamic: Vec<u32> = match (&scene.motion, threshold) {
        (Some(motion), Some(threshold)) => motion.dynamic_indices(threshold),
        _ => (0..scene.len() as u32).collect(),
    };
    let timing = Timing::of(&durations);
    let multiply_adds = network.multiply_adds() * dynamic.len();
    let positions = renderer.deformed_positions(time, threshold)?;
    Ok(BenchReport {
        what: "deform",
        scene: arguments.scene.scene.display().to_string(),
        splats: scene.len(),
        detail: Some(serde_json::json!({
            "backend": "gpu",
            "device": DeviceReport::of(&gpu),
            "kernel": renderer.network_kernel(),
            "dynamic_splats": dynamic.len(),
            "network": network.describe(),
            "dense_multiply_adds": multiply_adds,
            "teraflops": 2.0 * multiply_adds as f64 / timing.median_ms * 1e-9,
        })),
        timing,
        error_against_f64: Some(position_error(&scene, &positions, time, &dynamic)),
        machine: Machine::this(),
    })
}

fn no_clock() -> CliError {
    CliError::argument("--backend", "a device with timestamp queries", "one without")
}

fn total_timing(stages: &[StageTimes]) -> Result<Timing, CliError> {
    if stages.is_empty() {
        return Err(no_clock());
    }
    Ok(Timing::of(&stages.iter().map(|s| s.total).collect::<Vec<_>>()))
}

/// Median of each stage, milliseconds.
pub(crate) fn stage_medians(stages: &[StageTimes]) -> serde_json::Value {
    let median = |pick: fn(&StageTimes) -> Duration| {
        Timing::of(&stages.iter().map(pick).collect::<Vec<_>>()).median_ms
    };
    serde_json::json!({
        "deform": median(|s| s.deform),
        "project": median(|s| s.project),
        "sort": median(|s| s.sort),
        "bin": median(|s| s.bin),
        "rasterize": median(|s| s.rasterize),
    })
}
