//! `trapeze report`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, ValueEnum};
use trapeze_formats::write_atomically;
use trapeze_gpu::DeviceReport;
use trapeze_scene::Scene;

use super::render::open_gpu;
use crate::error::CliError;
use crate::measure::Machine;
use crate::output::{print_json, progress_bar};
use crate::report::{Moment, Report, cpu_variants, gpu_variants, markdown, measure, plot};
use crate::scene_input::{SceneArguments, ViewArguments};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    view: ViewArguments,
    /// Folder for report.json, report.md and report.svg.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Timed frames per variant, at least.
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(20..=10_000))]
    frames: u32,
    /// Views around the scene, when no camera is given.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=64))]
    views: u32,
    /// Whose variants to compare.
    #[arg(long, value_enum, default_value_t)]
    backend: Compared,
    /// Print JSON instead of the table.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Compared {
    /// Those of the CPU, and those of the GPU where there is one that is no software.
    #[default]
    Auto,
    /// Those of the CPU, and those of the GPU where there is one, software or not.
    All,
    /// Those of the CPU.
    Cpu,
    /// Those of the GPU.
    Gpu,
}

/// Times at which a deformable scene is compared.
const TIMES: [f32; 4] = [0.1, 0.35, 0.6, 0.85];

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let scene = Arc::new(arguments.scene.load()?);
    let name = scene_name(&arguments.scene.scene);
    let report = make_report(&scene, name, arguments)?;
    if let Some(folder) = &arguments.out {
        write_report(folder, &report)?;
    }
    if arguments.json {
        return print_json(&report);
    }
    std::io::stdout().write_all(markdown(&report).as_bytes()).map_err(CliError::Output)
}

/// Name of a scene for people: the last part of its path.
fn scene_name(path: &Path) -> String {
    path.file_name().map_or("scene".into(), |name| name.to_string_lossy().into_owned())
}

fn make_report(
    scene: &Arc<Scene>,
    name: String,
    arguments: &Arguments,
) -> Result<Report, CliError> {
    let cameras = match (&arguments.view.camera, arguments.view.orbit) {
        (None, None) => (0..arguments.views)
            .map(|i| {
                let azimuth = 30.0 + 360.0 * f64::from(i) / f64::from(arguments.views);
                arguments.view.orbit_camera(scene, (azimuth, 20.0))
            })
            .collect::<Result<Vec<_>, _>>()?,
        _ => vec![arguments.view.camera(scene)?],
    };
    let times = if scene.deformation.is_some() { TIMES.to_vec() } else { vec![0.0] };
    let moments: Vec<Moment> = times
        .iter()
        .flat_map(|&time| cameras.iter().map(move |c| Moment { camera: c.clone(), time }))
        .collect();
    let gpu = match arguments.backend {
        Compared::Cpu => None,
        Compared::Gpu => Some(open_gpu()?),
        Compared::All | Compared::Auto => open_gpu()
            .inspect_err(|why| tracing::warn!("the GPU's variants are left out: {why}"))
            .ok(),
    };
    // Its kernels run on the CPU after all, each frame for seconds, and say nothing about a GPU.
    let gpu = gpu.filter(|gpu| arguments.backend != Compared::Auto || !gpu.is_software());
    let mut variants = Vec::new();
    if arguments.backend != Compared::Gpu {
        variants.extend(cpu_variants(scene));
    }
    if gpu.is_some() {
        variants.extend(gpu_variants(scene));
    }
    let progress = progress_bar((moments.len() + variants.len()) as u64, "comparing");
    let rows =
        measure(scene, gpu.as_ref(), &variants, &moments, arguments.frames as usize, &progress)?;
    progress.finish_and_clear();
    Ok(Report {
        scene: name,
        splats: scene.len(),
        size: [cameras[0].width, cameras[0].height],
        views: cameras.len(),
        times,
        machine: serde_json::to_value(Machine::this()).unwrap_or_default(),
        device: gpu
            .as_ref()
            .map(|gpu| serde_json::to_value(DeviceReport::of(gpu)).unwrap_or_default()),
        rows,
    })
}

/// Writes the report as JSON, Markdown and SVG.
fn write_report(folder: &Path, report: &Report) -> Result<(), CliError> {
    std::fs::create_dir_all(folder).map_err(|e| CliError::file(folder, e))?;
    let json = serde_json::to_vec_pretty(report).map_err(|e| CliError::Output(e.into()))?;
    write_atomically(&folder.join("report.json"), |file| file.write_all(&json))?;
    write_atomically(&folder.join("report.md"), |file| {
        file.write_all(markdown(report).as_bytes())
    })?;
    let path = folder.join("report.svg");
    let svg =
        plot(report).map_err(|e| CliError::Encode { path: path.clone(), reason: e.to_string() })?;
    write_atomically(&path, |file| file.write_all(svg.as_bytes()))?;
    Ok(())
}
