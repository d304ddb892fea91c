//! `trapeze bench train`: the same run on every instruction set or on the GPU, and on the f64
//! reference.

use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use fearless_simd::Level;
use serde::Serialize;
use trapeze_formats::dataset::Dataset;
use trapeze_gpu::{DeviceReport, Gpu, NetworkProducts};
use trapeze_scene::FrameSettings;
use trapeze_train::backend::TrainingBackend;
use trapeze_train::config::TrainingConfig;
use trapeze_train::evaluation::evaluate;
use trapeze_train::{
    CpuBackend, CpuBackendOptions, GpuBackend, GpuBackendOptions, GpuStepTimes, ReferenceBackend,
    Trainer, TrainerOptions, background_for_training, deformation_for_training, prepare_for_motion,
};

use super::super::render::open_gpu;
use crate::dataset_input::DatasetArguments;
use crate::error::CliError;
use crate::measure::{Machine, Timing, level_name, simd_levels};
use crate::output::{print_json, print_line};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    dataset: DatasetArguments,
    /// What trains.
    #[arg(long, value_enum, default_value_t)]
    backend: Backend,
    /// Steps of the run on each instruction set, or on the GPU.
    #[arg(long, default_value_t = 500, value_parser = clap::value_parser!(u32).range(1..))]
    steps: u32,
    /// Steps after which all are compared; the f64 reference takes no more. 0 leaves it out.
    #[arg(long, default_value_t = 10)]
    reference_steps: u32,
    /// SH degree, from the first step.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=3))]
    sh_degree: u32,
    /// Random splats to start from where a dataset has no points.
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..))]
    random_splats: u32,
    /// Train a static scene, whatever the times of the photographs.
    #[arg(long = "static")]
    rests: bool,
    /// Seed of every random choice.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Backend {
    /// Every instruction set of the processor.
    #[default]
    Cpu,
    /// Metal or Vulkan.
    Gpu,
}

#[derive(Debug, Serialize)]
struct Report {
    what: &'static str,
    dataset: String,
    splats: u32,
    sh_degree: u32,
    reference_steps: u32,
    rows: Vec<Row>,
    #[serde(skip_serializing_if = "Option::is_none")]
    device: Option<DeviceReport>,
    machine: Machine,
}

/// One variant. A speed is never shown without what it reaches.
#[derive(Debug, Serialize)]
struct Row {
    variant: &'static str,
    /// Time of a step.
    timing: Timing,
    /// Steps by the seconds of the whole run, loading of photographs included.
    steps_per_second: f64,
    steps: u32,
    /// On the held-out views after the steps that the reference takes, dB.
    psnr_at_reference_steps: Option<f64>,
    /// On the held-out views after all steps, dB.
    psnr: f64,
    /// Median over some steps after the run, on the GPU's own clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    median_stage_ms: Option<StageMedians>,
}

/// Medians of the stages of a step on the GPU, ms.
#[derive(Debug, Serialize)]
struct StageMedians {
    /// The deformation network forward and backward; zero in a static scene.
    deform: f64,
    deform_backward: f64,
    project: f64,
    sort: f64,
    bin: f64,
    rasterize: f64,
    loss: f64,
    rasterize_backward: f64,
    sum_slots: f64,
    project_backward: f64,
    update: f64,
    total: f64,
}

impl StageMedians {
    fn of(times: &[GpuStepTimes]) -> Option<Self> {
        if times.is_empty() {
            return None;
        }
        let median = |pick: fn(&GpuStepTimes) -> Duration| {
            Timing::of(&times.iter().map(pick).collect::<Vec<_>>()).median_ms
        };
        Some(Self {
            deform: median(|t| t.deform.forward()),
            deform_backward: median(|t| t.deform.backward()),
            project: median(|t| t.passes.project),
            sort: median(|t| t.passes.sort),
            bin: median(|t| t.passes.bin),
            rasterize: median(|t| t.passes.rasterize),
            loss: median(|t| t.loss),
            rasterize_backward: median(|t| t.passes.rasterize_backward),
            sum_slots: median(|t| t.passes.sum_slots),
            project_backward: median(|t| t.passes.project_backward),
            update: median(|t| t.update),
            total: median(GpuStepTimes::total),
        })
    }

    fn text(&self) -> String {
        let stages = [
            ("project", self.project),
            ("sort", self.sort),
            ("bin", self.bin),
            ("rasterize", self.rasterize),
            ("loss", self.loss),
            ("rasterize_backward", self.rasterize_backward),
            ("sum_slots", self.sum_slots),
            ("project_backward", self.project_backward),
            ("deform", self.deform),
            ("deform_backward", self.deform_backward),
            ("update", self.update),
            ("total", self.total),
        ];
        let each: Vec<String> =
            stages.iter().map(|(name, ms)| format!("{name} {ms:.3} ms")).collect();
        each.join(", ")
    }
}

/// Steps that are taken apart after a run on the GPU.
const TIMED_STEPS: u32 = 30;

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let dataset = arguments.dataset.load()?;
    let mut rows = Vec::new();
    let mut splats = 0;
    let mut measure = |row: (Row, u32)| {
        splats = row.1;
        rows.push(row.0);
    };
    if arguments.reference_steps > 0 {
        let backend = ReferenceBackend::default();
        let steps = arguments.reference_steps;
        measure(measured(arguments, &dataset, backend, "f64 reference", steps, |_| Ok(None))?);
    }
    let mut device = None;
    match arguments.backend {
        Backend::Cpu => {
            for level in simd_levels().into_iter().rev() {
                let (backend, name, steps) = (on_level(level), level_name(level), arguments.steps);
                measure(measured(arguments, &dataset, backend, name, steps, |_| Ok(None))?);
            }
        }
        Backend::Gpu => {
            let gpu = open_gpu()?;
            let deformation = deformation_for_training(&dataset, arguments.steps)?;
            let moves = !arguments.rests && deformation.is_some();
            for (name, products) in products_of(&gpu, moves) {
                let options = GpuBackendOptions {
                    memory_budget: u64::MAX,
                    network_products: products,
                    ..Default::default()
                };
                let backend = GpuBackend::new(&gpu, options)?;
                measure(measured(arguments, &dataset, backend, name, arguments.steps, stages)?);
            }
            device = Some(DeviceReport::of(&gpu));
        }
    }
    let report = Report {
        what: "train",
        dataset: arguments.dataset.dataset.display().to_string(),
        splats,
        sh_degree: arguments.sh_degree,
        reference_steps: arguments.reference_steps,
        rows,
        device,
        machine: Machine::this(),
    };
    if arguments.json { print_json(&report) } else { print_text(&report) }
}

/// The ways to compute a network's products that the device has; one where nothing moves.
fn products_of(gpu: &Gpu, moves: bool) -> Vec<(&'static str, NetworkProducts)> {
    let single = ("gpu, network in f32", NetworkProducts::Single);
    let split = ("gpu, network on cooperative matrices", NetworkProducts::Split);
    match NetworkProducts::Split.suited(gpu, &[]) {
        _ if !moves => vec![("gpu", NetworkProducts::Single)],
        NetworkProducts::Single => vec![single],
        NetworkProducts::Split => vec![single, split],
    }
}

fn on_level(level: Level) -> CpuBackend {
    CpuBackend::new(CpuBackendOptions { level, ..CpuBackendOptions::default() })
}

/// A run of `steps` steps, its figures and its number of splats.
fn measured<B: TrainingBackend>(
    arguments: &Arguments,
    dataset: &Dataset,
    backend: B,
    variant: &'static str,
    steps: u32,
    stages: impl FnOnce(&mut Trainer<B>) -> Result<Option<StageMedians>, CliError>,
) -> Result<(Row, u32), CliError> {
    // The schedule of the longest run, so that every variant takes the same first steps.
    let mut config = TrainingConfig::fixed(arguments.steps.max(steps));
    config.sh_degree = arguments.sh_degree;
    config.sh_interval = 0;
    config.seed = arguments.seed;
    config.initial.random_count = arguments.random_splats;
    config.checkpoint_interval = u32::MAX;
    config.background = background_for_training(dataset)?;
    if !arguments.rests {
        config.deformation = deformation_for_training(dataset, config.steps)?;
    }
    if config.deformation.is_some() {
        prepare_for_motion(&mut config);
    }
    let options = TrainerOptions { report_interval: u32::MAX, ..TrainerOptions::default() };
    let mut trainer = Trainer::start(dataset, config, backend, options)?;
    let mut times = Vec::new();
    let mut early = None;
    for step in 1..=steps {
        let start = Instant::now();
        trainer.advance(1, &mut |_| ())?;
        times.push(start.elapsed());
        if step == arguments.reference_steps && step < steps {
            early = Some(held_out_psnr(&mut trainer, dataset)?);
        }
    }
    let psnr = held_out_psnr(&mut trainer, dataset)?;
    let seconds = times.iter().sum::<Duration>().as_secs_f64();
    let splats = trainer.splat_count();
    let row = Row {
        variant,
        timing: Timing::of(&times),
        steps_per_second: f64::from(steps) / seconds,
        steps,
        psnr_at_reference_steps: early.or((steps == arguments.reference_steps).then_some(psnr)),
        psnr,
        median_stage_ms: stages(&mut trainer)?,
    };
    Ok((row, splats))
}

/// Takes further steps apart.
fn stages(trainer: &mut Trainer<GpuBackend>) -> Result<Option<StageMedians>, CliError> {
    let config = trainer.config().clone();
    let (extent, views) = (trainer.progress().extent, trainer.view_count() as u32);
    let mut times = Vec::new();
    for i in 0..TIMED_STEPS {
        let view = trainer.view(i % views).clone();
        let backend = trainer.backend();
        if backend.has_target(view.id) {
            let plan = config.step_plan(config.steps, extent, 1.0);
            let measured = backend.time_stages(&plan, &view);
            times.extend(measured.map_err(trapeze_train::TrainError::from)?);
        }
    }
    Ok(StageMedians::of(&times))
}

/// Mean PSNR of the held-out views, dB.
fn held_out_psnr<B: TrainingBackend>(
    trainer: &mut Trainer<B>,
    dataset: &Dataset,
) -> Result<f64, CliError> {
    let views: Vec<usize> = dataset.test_views().collect();
    let evaluation = evaluate(dataset, &views, None, |index| {
        let settings = FrameSettings {
            time: dataset.views[index].time.unwrap_or(0.0),
            ..FrameSettings::default()
        };
        let frame = trainer.backend().render(&dataset.local_camera(index), &settings);
        Ok::<_, CliError>(frame.map_err(trapeze_train::TrainError::from)?)
    })?;
    let missing = || CliError::argument("DATASET", "a held-out view", "none");
    Ok(evaluation.ok_or_else(missing)?.mean.psnr)
}

fn print_text(report: &Report) -> Result<(), CliError> {
    print_line(&format!(
        "`{}`: {} splats, SH degree {}; {} threads of {} ({}).\n",
        report.dataset,
        report.splats,
        report.sh_degree,
        report.machine.threads,
        report.machine.cpu,
        report.machine.simd,
    ))?;
    print_line(&format!(
        "| variant | it/s | median ms | p10–p90 ms | test dB after {} steps | steps | test dB |",
        report.reference_steps
    ))?;
    print_line("|---|---:|---:|---:|---:|---:|---:|")?;
    for row in &report.rows {
        let timing = &row.timing;
        let early = row.psnr_at_reference_steps.map_or("–".into(), |psnr| format!("{psnr:.3}"));
        print_line(&format!(
            "| {} | {:.2} | {:.1} | {:.1}–{:.1} | {early} | {} | {:.2} |",
            row.variant,
            row.steps_per_second,
            timing.median_ms,
            timing.p10_ms,
            timing.p90_ms,
            row.steps,
            row.psnr,
        ))?;
    }
    for row in &report.rows {
        if let Some(stages) = &row.median_stage_ms {
            print_line(&format!("\n{}: {}.", row.variant, stages.text()))?;
        }
    }
    Ok(())
}
