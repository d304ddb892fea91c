//! `trapeze bench`.

mod gradient;
mod search;
mod train;

use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, Subcommand, ValueEnum};
use serde::Serialize;
use trapeze_cpu::deform::DeformationStage;
use trapeze_cpu::{Renderer, reference};
use trapeze_formats::load_scene;
use trapeze_formats::ply::write_ply;
use trapeze_scene::{Frame, FrameSettings, ImageError, Scene, ShDegree, Splats};

use super::bench_gpu;
use super::render::{Backend, static_threshold};
use crate::error::CliError;
use crate::measure::{Machine, Timing, time_runs};
use crate::output::print_json;
use crate::scene_input::{SceneArguments, ViewArguments};

#[derive(Debug, Subcommand)]
pub(crate) enum Bench {
    /// Whole frames and each stage, with the error against the f64 reference.
    Render(RenderArguments),
    /// Frames forward and backward, with the gradients' error.
    Gradient(gradient::Arguments),
    /// The deformation network, with the error against the f64 reference.
    Deform(DeformArguments),
    /// Reading a splat file.
    Load(LoadArguments),
    /// Training steps on every instruction set and on the f64 reference, with what they reach.
    Train(train::Arguments),
    /// Looking at every cluster, and answering a text.
    Search(search::Arguments),
}

#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    #[command(flatten)]
    pub(super) scene: SceneArguments,
    #[command(flatten)]
    pub(super) view: ViewArguments,
    /// Time of the frames.
    #[arg(long, default_value_t = 0.0)]
    pub(super) time: f32,
    /// What computes the images.
    #[arg(long, value_enum, default_value_t)]
    pub(super) backend: Backend,
    /// Store SH coefficients on the GPU as half floats.
    #[arg(long)]
    pub(super) half_harmonics: bool,
    /// Timed runs.
    #[arg(long, default_value_t = 30)]
    pub(super) runs: usize,
    /// Print JSON.
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct DeformArguments {
    #[command(flatten)]
    pub(super) scene: SceneArguments,
    /// Let this share of the splats (0-100) rest at t = 0.
    #[arg(long, value_name = "PERCENTILE")]
    pub(super) static_percentile: Option<f32>,
    /// What evaluates the network.
    #[arg(long, value_enum, default_value_t)]
    pub(super) backend: Backend,
    /// Arithmetic of the network on the GPU.
    #[arg(long, value_enum, default_value_t)]
    pub(super) precision: Precision,
    /// Repeat the scene's splats until there are this many.
    #[arg(long, value_name = "SPLATS")]
    pub(super) splats: Option<u32>,
    /// Timed runs.
    #[arg(long, default_value_t = 30)]
    pub(super) runs: usize,
    /// Print JSON.
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct LoadArguments {
    /// The file to read; without it a PLY of `--splats` splats with 62 floats each is made.
    file: Option<PathBuf>,
    /// Splats of the file that is made.
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(1..=8_000_000))]
    splats: u32,
    /// Timed runs.
    #[arg(long, default_value_t = 10)]
    runs: usize,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Arithmetic of the deformation network on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Precision {
    /// 32-bit floats.
    #[default]
    F32,
    /// 16-bit weights and hidden vectors, where the device has passed its self-check.
    F16,
}

/// Error of a result against the f64 reference.
#[derive(Debug, Serialize)]
pub(super) struct Error {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) psnr: Option<f64>,
    pub(super) max: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) p999: Option<f64>,
}

impl From<ImageError> for Error {
    fn from(error: ImageError) -> Self {
        Self {
            psnr: error.psnr.is_finite().then_some(error.psnr),
            max: error.max,
            p999: Some(error.p999),
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct BenchReport {
    pub(super) what: &'static str,
    pub(super) scene: String,
    pub(super) splats: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) detail: Option<serde_json::Value>,
    pub(super) timing: Timing,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) error_against_f64: Option<Error>,
    pub(super) machine: Machine,
}

impl DeformArguments {
    /// The scene, its splats repeated as asked for.
    pub(super) fn load_scene(&self) -> Result<Scene, CliError> {
        let scene = self.scene.load()?;
        let Some(splats) = self.splats.filter(|_| !scene.is_empty()) else { return Ok(scene) };
        let indices: Vec<u32> = (0..splats).map(|i| i % scene.len() as u32).collect();
        Ok(scene.gather(&indices))
    }
}

impl Bench {
    pub(crate) fn run(&self) -> Result<(), CliError> {
        let (report, json) = match self {
            Self::Render(arguments) => (render(arguments)?, arguments.json),
            Self::Gradient(arguments) => (gradient::run(arguments)?, arguments.json),
            Self::Deform(arguments) => (deform(arguments)?, arguments.json),
            Self::Load(arguments) => (load(arguments)?, arguments.json),
            Self::Train(arguments) => return train::run(arguments),
            Self::Search(arguments) => return search::run(arguments),
        };
        if json { print_json(&report) } else { print_text(&report) }
    }
}

fn render(arguments: &RenderArguments) -> Result<BenchReport, CliError> {
    match arguments.backend {
        Backend::Cpu => {}
        Backend::Gpu => return bench_gpu::render(arguments),
        Backend::Reference => return Err(not_timed()),
    }
    let scene = Arc::new(arguments.scene.load()?);
    let camera = arguments.view.camera(&scene)?;
    let settings = FrameSettings { time: arguments.time, ..FrameSettings::default() };
    let mut renderer = Renderer::new(scene.clone());
    let mut frame = Frame::default();
    let mut stages = Vec::new();
    let timing = time_runs(arguments.runs, || {
        renderer.render_into(&camera, &settings, &mut frame)?;
        stages.push(renderer.stage_times());
        Ok::<_, CliError>(())
    })?;
    let exact = reference::render(&scene, &camera, &settings).to_frame();
    let error = ImageError::between(&frame.color, &exact.color);
    let stage = |pick: fn(&trapeze_cpu::StageTimes) -> std::time::Duration| {
        Timing::of(&stages.iter().map(pick).collect::<Vec<_>>()).median_ms
    };
    Ok(BenchReport {
        what: "render",
        scene: arguments.scene.scene.display().to_string(),
        splats: scene.len(),
        detail: Some(serde_json::json!({
            "size": [camera.width, camera.height],
            "visible_splats": renderer.visible_splats(),
            "median_stage_ms": {
                "deform": stage(|s| s.deform),
                "project": stage(|s| s.project),
                "sort": stage(|s| s.sort),
                "bin": stage(|s| s.bin),
                "rasterize": stage(|s| s.rasterize),
            },
        })),
        timing,
        error_against_f64: Some(error.into()),
        machine: Machine::this(),
    })
}

/// The reference is there to be right; `trapeze report` times it once.
fn not_timed() -> CliError {
    CliError::argument("--backend", "cpu or gpu", "reference")
}

fn deform(arguments: &DeformArguments) -> Result<BenchReport, CliError> {
    match arguments.backend {
        Backend::Cpu => {}
        Backend::Gpu => return bench_gpu::deform(arguments),
        Backend::Reference => return Err(not_timed()),
    }
    let scene = arguments.load_scene()?;
    let Some(network) = &scene.deformation else {
        return Err(CliError::argument("SCENE", "a scene with a deformation network", "none"));
    };
    let threshold = static_threshold(&scene, arguments.static_percentile)?;
    let mut stage = DeformationStage::new(&scene);
    let mut time = 0.0;
    let timing = time_runs(arguments.runs, || {
        // Another moment each time: the same one again would cost nothing.
        time += 1.0 / 64.0;
        stage.deform(&scene, time, threshold);
        Ok::<_, CliError>(())
    })?;
    let dynamic: Vec<u32> = match (&scene.motion, threshold) {
        (Some(motion), Some(threshold)) => motion.dynamic_indices(threshold),
        _ => (0..scene.len() as u32).collect(),
    };
    Ok(BenchReport {
        what: "deform",
        scene: arguments.scene.scene.display().to_string(),
        splats: scene.len(),
        detail: Some(serde_json::json!({
            "dynamic_splats": dynamic.len(),
            "network": network.describe(),
            "dense_multiply_adds": network.multiply_adds() * dynamic.len(),
        })),
        timing,
        error_against_f64: Some(largest_position_error(
            &scene, &mut stage, time, threshold, &dynamic,
        )),
        machine: Machine::this(),
    })
}

/// Largest difference of a deformed coordinate from the f64 network's, on up to 2 000 splats.
fn largest_position_error(
    scene: &Scene,
    stage: &mut DeformationStage,
    time: f32,
    threshold: Option<f32>,
    dynamic: &[u32],
) -> Error {
    let deformed = stage.deform(scene, time, threshold);
    position_error(scene, &deformed.positions, time, dynamic)
}

/// Largest difference of these splats' positions from what the f64 network gives, on up to 2 000 of
/// them.
pub(super) fn position_error(
    scene: &Scene,
    positions: &[[f32; 3]],
    time: f32,
    dynamic: &[u32],
) -> Error {
    let step = dynamic.len().div_ceil(2000).max(1);
    let mut max = 0.0f64;
    if let Some(network) = &scene.deformation {
        for &i in dynamic.iter().step_by(step) {
            let i = i as usize;
            let exact = reference::deform::deform_splat(
                network,
                &scene.splats,
                i,
                scene.origin,
                f64::from(time),
            );
            for (a, b) in positions[i].iter().zip(exact.position) {
                max = max.max((f64::from(*a) - b).abs());
            }
        }
    }
    Error { psnr: None, max, p999: None }
}

fn load(arguments: &LoadArguments) -> Result<BenchReport, CliError> {
    let folder = tempfile::tempdir().map_err(|e| CliError::file(std::env::temp_dir(), e))?;
    let path = match &arguments.file {
        Some(path) => path.clone(),
        None => {
            let path = folder.path().join("generated.ply");
            write_ply(&path, &generated_scene(arguments.splats as usize))?;
            path
        }
    };
    let bytes = std::fs::metadata(&path).map_err(|e| CliError::file(&path, e))?.len();
    let mut splats = 0;
    let timing = time_runs(arguments.runs, || {
        splats = load_scene(&path)?.len();
        Ok::<_, CliError>(())
    })?;
    let name = arguments
        .file
        .as_ref()
        .map_or("generated PLY, 62 floats per splat".into(), |p| p.display().to_string());
    Ok(BenchReport {
        what: "load",
        scene: name,
        splats,
        detail: Some(serde_json::json!({
            "bytes": bytes,
            "gigabytes_per_second": bytes as f64 / timing.median_ms * 1e-6,
        })),
        timing,
        error_against_f64: None,
        machine: Machine::this(),
    })
}

/// A scene of SH degree 3 whose values are arithmetic noise: loading does not look at them.
fn generated_scene(n: usize) -> Scene {
    let noise = |i: usize, k: usize| {
        let mixed = (i as u32).wrapping_mul(2_654_435_761).wrapping_add(k as u32 * 40_503);
        (mixed >> 8) as f32 / (1 << 24) as f32 - 0.5
    };
    let three =
        |k: usize| (0..n).map(|i| [noise(i, k), noise(i, k + 1), noise(i, k + 2)]).collect();
    Scene::from_splats(Splats {
        positions: three(0),
        log_scales: three(3),
        rotations: (0..n).map(|i| [1.0, noise(i, 6), noise(i, 7), noise(i, 8)]).collect(),
        opacity_logits: (0..n).map(|i| noise(i, 9)).collect(),
        sh_dc: three(10),
        sh_rest: (0..n * 45).map(|i| noise(i, 13)).collect(),
        sh_degree: ShDegree::Three,
    })
}

fn print_text(report: &BenchReport) -> Result<(), CliError> {
    let timing = &report.timing;
    let mut text = format!(
        "{} {} ({} splats): median {:.2} ms, p10 {:.2}, p90 {:.2} over {} runs",
        report.what,
        report.scene,
        report.splats,
        timing.median_ms,
        timing.p10_ms,
        timing.p90_ms,
        timing.runs,
    );
    if let Some(error) = &report.error_against_f64 {
        let psnr = error.psnr.map_or(String::new(), |p| format!(", {p:.1} dB"));
        text += &format!("; against f64: max {:.2e}{psnr}", error.max);
    }
    text += &format!(
        "; {} x {} ({})\n",
        report.machine.threads, report.machine.cpu, report.machine.simd
    );
    std::io::Write::write_all(&mut std::io::stdout(), text.as_bytes()).map_err(CliError::Output)
}
