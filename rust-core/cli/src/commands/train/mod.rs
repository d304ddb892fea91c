//! `trapeze train`.

mod configuration;
mod display;
mod interrupt;
mod metrics;
mod output;
mod previews;
mod settings;

use std::ops::ControlFlow;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use sysinfo::System;
use trapeze_formats::dataset::Dataset;
use trapeze_formats::load_scene;
use trapeze_gpu::NetworkProducts;
use trapeze_train::backend::TrainingBackend;
use trapeze_train::trainer::{Event, TrainingSummary};
use trapeze_train::{
    CpuBackend, GpuBackend, GpuBackendOptions, Trainer, TrainerOptions, with_measured_motion,
};

use super::eval::evaluate_scene;
use super::render::{self, open_gpu};
use crate::dataset_input::DatasetArguments;
use crate::error::CliError;
use configuration::TrainingArguments;
use display::Display;
use interrupt::Interrupt;
use metrics::Metrics;
use output::{OutputFolder, SceneFormat};
use previews::Previews;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    dataset: DatasetArguments,
    /// Folder for the scene, its training summary, and the checkpoints while it is trained.
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    training: TrainingArguments,
    /// What trains.
    #[arg(long, value_enum, default_value_t)]
    backend: Backend,
    /// Go on with the run in the folder; where there is none, begin it. Takes the same arguments as
    /// the run that it goes on with.
    #[arg(long)]
    resume: bool,
    /// Write a PNG of the first training view into previews/ every N steps.
    #[arg(long, value_name = "STEPS", value_parser = clap::value_parser!(u32).range(1..))]
    preview: Option<u32>,
    /// File format of the splats.
    #[arg(long, value_enum, default_value_t)]
    format: SceneFormat,
    /// Do not compute the network of a scene that moves on the GPU's matrix units, which take each number
    /// as the sum of two halves.
    #[arg(long)]
    single_products: bool,
    /// Megabytes that the run may take; by default what the system has available.
    #[arg(long, value_name = "MB")]
    memory_limit: Option<u64>,
    /// Write figures as JSON lines to a file, or without a name to standard output.
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Backend {
    /// The processor's vector instructions.
    #[default]
    Cpu,
    /// Metal or Vulkan.
    Gpu,
}

/// Steps between two looks at whether the user wants to stop.
const BATCH: u32 = 5;
/// Steps between two reports, at least: each waits for the backend and renders.
const LEAST_INTERVAL: u32 = 10;
/// Reports of a run, about; and the most steps between two.
const REPORTS: u32 = 100;
/// The same on a GPU.
const GPU_REPORTS: u32 = 10;
const MOST_GPU_INTERVAL: u32 = 1_000;
const MEGABYTE: u64 = 1 << 20;

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let folder = OutputFolder::open(&arguments.out, arguments.resume)?;
    if let Some(summary) = folder.finished_run()? {
        eprintln!("{}: this run is complete", arguments.out.display());
        return Metrics::to(arguments.json.as_deref(), 0)?.finish(&summary);
    }
    let dataset = arguments.dataset.load()?;
    let limit = arguments.memory_limit.map_or_else(available_memory, |mb| mb * MEGABYTE);
    let config = arguments.training.configuration(&dataset, &arguments.dataset, limit)?;
    let options = TrainerOptions {
        checkpoints: Some(folder.checkpoints()),
        memory_limit: Some(limit),
        report_interval: arguments.backend.report_interval(config.steps),
        ..TrainerOptions::default()
    };
    match arguments.backend {
        // The folder is empty unless `--resume` was given.
        Backend::Cpu => {
            let trainer = Trainer::resume(&dataset, config, CpuBackend::default(), options)?;
            train(arguments, &dataset, &folder, trainer)
        }
        Backend::Gpu => {
            let trainer =
                Trainer::resume(&dataset, config, gpu_backend(arguments, limit)?, options)?;
            train(arguments, &dataset, &folder, trainer)
        }
    }
}

impl Backend {
    /// Steps between two reports.
    fn report_interval(self, steps: u32) -> u32 {
        match self {
            Self::Cpu => (steps / REPORTS).clamp(LEAST_INTERVAL, REPORTS),
            // A report waits, renders and compares: as much as a dozen steps.
            Self::Gpu => (steps / GPU_REPORTS).clamp(LEAST_INTERVAL, MOST_GPU_INTERVAL),
        }
    }

    /// What evaluates the result.
    fn renderer(self) -> render::Backend {
        match self {
            Self::Cpu => render::Backend::Cpu,
            Self::Gpu => render::Backend::Gpu,
        }
    }
}

/// Training on the device that GPU commands run on.
fn gpu_backend(arguments: &Arguments, limit: u64) -> Result<GpuBackend, CliError> {
    let gpu = open_gpu()?;
    let mut options = GpuBackendOptions::within(&gpu, limit);
    if arguments.single_products {
        options.network_products = NetworkProducts::Single;
    }
    Ok(GpuBackend::new(&gpu, options)?)
}

fn train<B: TrainingBackend>(
    arguments: &Arguments,
    dataset: &Dataset,
    folder: &OutputFolder,
    mut trainer: Trainer<B>,
) -> Result<(), CliError> {
    let interrupt = Interrupt::listen();
    let mut metrics = Metrics::to(arguments.json.as_deref(), trainer.step())?;
    let mut previews = arguments.preview.map(|every| Previews::new(folder, every, trainer.step()));
    let display = Display::new(&trainer);
    let mut failure = None;
    while !trainer.is_finished() {
        trainer.advance(BATCH, &mut |event| {
            display.show(&event);
            if let Event::Report(report) = &event
                && let Err(error) = metrics.report(report)
            {
                failure.get_or_insert(error);
            }
        })?;
        if let Some(error) = failure.take() {
            return Err(error);
        }
        display.set_step(trainer.step());
        if let Some(previews) = &mut previews {
            previews.write_if_due(&mut trainer)?;
        }
        if interrupt.is_asked() && !trainer.is_finished() {
            trainer.save(&mut |event| display.show(&event))?;
            let (step, steps) = (trainer.step(), trainer.config().steps);
            return Err(CliError::Interrupted { step, steps });
        }
    }
    display.finish();
    let scene = trainer.scene()?;
    let mut summary = trainer.summary();
    summary.count(&scene);
    drop(trainer);
    let (scene, motion) = with_measured_motion(scene, dataset, || ControlFlow::Continue(()))?;
    summary.motion = motion;
    let scene = folder.save_scene(&scene, arguments.format)?;
    // The file is evaluated, as anyone else would load it, not what was in memory.
    let views: Vec<usize> = dataset.test_views().collect();
    let renderer = arguments.backend.renderer();
    summary.test = evaluate_scene(load_scene(&scene)?, dataset, &views, None, renderer)?;
    folder.finish(&summary)?;
    describe(&summary, &scene);
    metrics.finish(&summary)
}

fn describe(summary: &TrainingSummary, scene: &std::path::Path) {
    let test = summary.test.as_ref().map_or("no view held out".into(), |test| {
        let (mean, views) = (&test.mean, test.views.len());
        format!("{:.2} dB, SSIM {:.4} on {views} held-out views", mean.psnr, mean.ssim)
    });
    eprintln!(
        "{}: {} splats, SH degree {}, {} steps in {:.1} s ({:.1} it/s), {test}",
        scene.display(),
        summary.splats,
        summary.sh_degree,
        summary.steps,
        summary.seconds,
        summary.steps_per_second,
    );
    if summary.left_out > 0 {
        eprintln!("{} more were trained and are too faint to be drawn: left out", summary.left_out);
    }
    if let Some(rest) = summary.rest.filter(|rest| rest.spared > 0) {
        eprintln!(
            "training spared {:.0} % of the network's evaluations: {} splats rested at the end",
            100.0 * rest.spared_share(),
            rest.resting,
        );
    }
    if let Some(motion) = &summary.motion {
        eprintln!(
            "{} of {} splats move, the others may rest ({} %): {}",
            motion.moving_splats,
            summary.splats,
            motion.recommended_percentile,
            motion.worst_psnr.map_or("equal images".into(), |psnr| {
                format!("{psnr:.1} dB from the full network at worst")
            }),
        );
    }
}

/// Bytes that may be taken without pushing others out, the limit of a container respected.
fn available_memory() -> u64 {
    let mut system = System::new();
    system.refresh_memory();
    let container = system.cgroup_limits().map_or(u64::MAX, |limits| limits.free_memory);
    system.available_memory().min(container)
}
