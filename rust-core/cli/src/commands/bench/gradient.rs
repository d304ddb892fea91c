//! `trapeze bench gradient`: both passes of a frame, stage by stage, and how far the gradients are
//! from those of another implementation.

use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use serde_json::{Map, Value, json};
use trapeze_cpu::{DifferentiableRenderer, ImageGradient, RendererOptions, reference};
use trapeze_gpu::{DeviceReport, ForwardSettings, Gpu, ImageGradientBuffers, ParameterBuffers};
use trapeze_scene::{Camera, FrameSettings, Scene, Splats};
use trapeze_train::ParameterGroup;

use super::{BenchReport, not_timed};
use crate::commands::render::{Backend, open_gpu};
use crate::error::CliError;
use crate::measure::{Machine, Timing};
use crate::scene_input::{SceneArguments, ViewArguments};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    view: ViewArguments,
    /// What computes the gradients.
    #[arg(long, value_enum, default_value_t)]
    backend: Backend,
    /// What they are compared with.
    #[arg(long, value_enum, default_value_t)]
    against: Against,
    /// Timed runs.
    #[arg(long, default_value_t = 30)]
    runs: usize,
    /// Print JSON.
    #[arg(long)]
    pub(super) json: bool,
}

/// What gradients are compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Against {
    /// The f64 specification.
    #[default]
    Reference,
    /// The CPU backend, for large frames.
    Cpu,
}

/// Time before the first measured run: a GPU takes that long to raise its clocks.
const WARM_UP: Duration = Duration::from_secs(1);

/// What a backend has found and how long it took.
struct Measured {
    gradients: Splats,
    total: Vec<Duration>,
    /// Median of each stage, milliseconds.
    stages: Value,
    device: Option<DeviceReport>,
    visible: usize,
    entries: Option<u32>,
}

pub(super) fn run(arguments: &Arguments) -> Result<BenchReport, CliError> {
    let scene = arguments.scene.load()?;
    if scene.deformation.is_some() {
        return Err(CliError::argument("SCENE", "a scene without a network", "one with it"));
    }
    let camera = arguments.view.camera(&scene)?;
    let weights = weights(&camera);
    let runs = arguments.runs.max(1);
    let measured = match arguments.backend {
        Backend::Cpu => on_cpu(&scene, &camera, &weights, runs)?,
        Backend::Gpu => on_gpu(&scene, &camera, &weights, runs)?,
        Backend::Reference => return Err(not_timed()),
    };
    let errors = match arguments.against {
        Against::Cpu => {
            let exact = on_cpu(&scene, &camera, &weights, 1)?.gradients;
            errors(&measured.gradients, |group| wide(group.of(&exact)))
        }
        Against::Reference => {
            let gradient = ImageGradient { color: &weights, expected_depth: None };
            let settings = FrameSettings::default();
            let exact = reference::gradients(&scene, &camera, &settings, &gradient).splats;
            let stride = scene.splats.sh_rest_stride();
            errors(&measured.gradients, |group| exact_group(&exact, group, stride))
        }
    };
    Ok(BenchReport {
        what: "gradient",
        scene: arguments.scene.scene.display().to_string(),
        splats: scene.len(),
        detail: Some(json!({
            "device": measured.device,
            "size": [camera.width, camera.height],
            "sh_degree": scene.splats.sh_degree as u32,
            "visible_splats": measured.visible,
            "tile_entries": measured.entries,
            "median_stage_ms": measured.stages,
            "against": match arguments.against {
                Against::Reference => "f64 reference",
                Against::Cpu => "CPU backend, f32",
            },
            "relative_error": errors,
        })),
        timing: Timing::of(&measured.total),
        error_against_f64: None,
        machine: Machine::this(),
    })
}

/// ∂L/∂image of the loss that the gradient goldens have: waves, different for each channel.
fn weights(camera: &Camera) -> Vec<[f32; 4]> {
    let rows = (0..camera.height).map(f64::from);
    let pixels = rows.flat_map(|y| (0..camera.width).map(move |x| (f64::from(x), y)));
    let weight = |(x, y): (f64, f64)| {
        [
            (0.05 * x + 0.03 * y).cos(),
            (0.04 * x - 0.02 * y).sin(),
            (0.02 * x + 0.05 * y + 1.0).cos(),
            0.0,
        ]
    };
    pixels.map(|at| weight(at).map(|w| w as f32)).collect()
}

fn on_cpu(
    scene: &Scene,
    camera: &Camera,
    weights: &[[f32; 4]],
    runs: usize,
) -> Result<Measured, CliError> {
    let mut renderer = DifferentiableRenderer::new(RendererOptions::default());
    let gradient = ImageGradient { color: weights, expected_depth: None };
    let mut gradients = Splats::default();
    let (mut total, mut times) = (Vec::new(), Vec::new());
    for _ in 0..runs {
        let start = Instant::now();
        renderer.forward(scene, camera, &FrameSettings::default())?;
        renderer.backward(scene, &gradient, &mut gradients)?;
        total.push(start.elapsed());
        times.push(renderer.times());
    }
    let stages = medians(
        &times,
        &[
            ("project", |t| t.forward.project),
            ("sort", |t| t.forward.sort),
            ("bin", |t| t.forward.bin),
            ("rasterize", |t| t.forward.rasterize),
            ("rasterize_backward", |t| t.rasterize_backward),
            ("project_backward", |t| t.project_backward),
        ],
    );
    let visible = renderer.visible_splats();
    Ok(Measured { gradients, total, stages, device: None, visible, entries: None })
}

fn on_gpu(
    scene: &Scene,
    camera: &Camera,
    weights: &[[f32; 4]],
    runs: usize,
) -> Result<Measured, CliError> {
    let gpu: Gpu = open_gpu()?;
    let count = scene.len() as u32;
    let camera = camera.relative_to(scene.origin);
    let settings = ForwardSettings::default();
    let parameters = ParameterBuffers::from_splats(&gpu, &scene.splats, count)?;
    let mut renderer =
        trapeze_gpu::DifferentiableRenderer::new(&gpu, count, count.saturating_mul(4))?;
    let (_, status) = renderer.forward_and_wait(&parameters, &camera, settings)?;
    let gradients = renderer.backward_and_wait(&parameters, weights, None)?;

    let by_color = gpu.storage_of("weights", weights)?;
    let by_image = ImageGradientBuffers { color: &by_color, expected_depth: None };
    let out = ParameterBuffers::zeroed(&gpu, count, scene.splats.sh_degree)?;
    let mut passes = || renderer.timed_passes(&parameters, &camera, settings, by_image, &out);
    let start = Instant::now();
    while start.elapsed() < WARM_UP {
        passes()?;
    }
    let mut times = Vec::new();
    for _ in 0..runs {
        times.extend(passes()?);
    }
    if times.is_empty() {
        let expected = "a device with timestamp queries";
        return Err(CliError::argument("--backend", expected, "one without"));
    }
    let stages = medians(
        &times,
        &[
            ("project", |t| t.project),
            ("sort", |t| t.sort),
            ("bin", |t| t.bin),
            ("rasterize", |t| t.rasterize),
            ("rasterize_backward", |t| t.rasterize_backward),
            ("sum_slots", |t| t.sum_slots),
            ("project_backward", |t| t.project_backward),
        ],
    );
    Ok(Measured {
        gradients,
        total: times.iter().map(trapeze_gpu::PassTimes::total).collect(),
        stages,
        device: Some(DeviceReport::of(&gpu)),
        visible: status.visible as usize,
        entries: Some(status.most_entries),
    })
}

/// A stage's name, and its time among those of a pass.
type Stage<T> = (&'static str, fn(&T) -> Duration);

/// Median of each stage by its name, milliseconds.
fn medians<T>(times: &[T], stages: &[Stage<T>]) -> Value {
    let median = |pick: &fn(&T) -> Duration| {
        Timing::of(&times.iter().map(pick).collect::<Vec<_>>()).median_ms
    };
    stages
        .iter()
        .map(|(name, pick)| ((*name).to_owned(), json!(median(pick))))
        .collect::<Map<_, _>>()
        .into()
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&v| f64::from(v)).collect()
}

/// The numbers of a group of the specification's gradients.
fn exact_group(
    exact: &[reference::SplatParameters],
    group: ParameterGroup,
    stride: usize,
) -> Vec<f64> {
    exact
        .iter()
        .flat_map(|splat| match group {
            ParameterGroup::Positions => splat.position.to_array().to_vec(),
            ParameterGroup::LogScales => splat.log_scale.to_array().to_vec(),
            ParameterGroup::Rotations => splat.rotation.to_vec(),
            ParameterGroup::OpacityLogits => vec![splat.opacity_logit],
            ParameterGroup::ShDc => splat.sh[0].to_vec(),
            ParameterGroup::ShRest => splat.sh[1..].as_flattened()[..stride].to_vec(),
        })
        .collect()
}

/// ‖g − g*‖₂ / ‖g*‖₂ and ‖g − g*‖∞ / ‖g*‖∞ of each group that the scene has.
fn errors(found: &Splats, exact: impl Fn(ParameterGroup) -> Vec<f64>) -> Value {
    let mut all = Map::new();
    for group in ParameterGroup::ALL {
        let exact = exact(group);
        let difference = group.of(found).iter().zip(&exact).map(|(&a, b)| f64::from(a) - b);
        let (mut squares, mut largest) = (0.0, 0.0f64);
        for d in difference {
            squares += d * d;
            largest = if d.abs() <= largest { largest } else { d.abs() };
        }
        let norm: f64 = exact.iter().map(|g| g * g).sum();
        let most = exact.iter().fold(0.0f64, |m, g| m.max(g.abs()));
        if norm > 0.0 {
            let error = json!({ "l2": (squares / norm).sqrt(), "max": largest / most });
            all.insert(group.name().to_owned(), error);
        }
    }
    all.into()
}
