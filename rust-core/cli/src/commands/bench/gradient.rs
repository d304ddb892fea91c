//! `trapeze bench gradient`: both passes of a frame, stage by stage, the deformation network's
//! included, and how far the gradients are from those of another implementation.

use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use glam::DVec3;
use serde_json::{Map, Value, json};
use trapeze_cpu::{DifferentiableRenderer, ImageGradient, RendererOptions, reference};
use trapeze_gpu::{
    DeformationTimes, DeviceReport, DifferentiableDeformation, ForwardSettings, Gpu,
    ImageGradientBuffers, ParameterBuffers, PassTimes,
};
use trapeze_scene::{Camera, DeformationNetwork, FrameSettings, Scene, Splats};
use trapeze_train::{ParameterGroup, network_parameters};

use super::{BenchReport, not_timed};
use crate::commands::render::{Backend, open_gpu};
use crate::error::CliError;
use crate::measure::{Machine, Timing, warm_up_gpu};
use crate::scene_input::{SceneArguments, ViewArguments};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    view: ViewArguments,
    /// Time of the frames, in scenes that move.
    #[arg(long, default_value_t = 0.5)]
    time: f32,
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

/// What a backend has found and how long it took.
struct Measured {
    gradients: Splats,
    /// By the network's parameters, in the order of `weights.bin`.
    by_network: Vec<f32>,
    /// Arithmetic of the network's kernels, TFLOP/s.
    network_tflops: Option<Value>,
    total: Vec<Duration>,
    /// Median of each stage, milliseconds.
    stages: Value,
    device: Option<DeviceReport>,
    visible: usize,
    entries: Option<u32>,
}

pub(super) fn run(arguments: &Arguments) -> Result<BenchReport, CliError> {
    let scene = arguments.scene.load()?;
    let camera = arguments.view.camera(&scene)?;
    let weights = weights(&camera);
    let runs = arguments.runs.max(1);
    let measured = match arguments.backend {
        Backend::Cpu => on_cpu(&scene, &camera, arguments.time, &weights, runs)?,
        Backend::Gpu => on_gpu(&scene, &camera, arguments.time, &weights, runs)?,
        Backend::Reference => return Err(not_timed()),
    };
    let errors = match arguments.against {
        Against::Cpu => {
            let exact = on_cpu(&scene, &camera, arguments.time, &weights, 1)?;
            let network = wide(&exact.by_network);
            errors(&measured, &network, |group| wide(group.of(&exact.gradients)))
        }
        Against::Reference => {
            let gradient = ImageGradient { color: &weights, expected_depth: None };
            let settings = settings(arguments.time);
            let exact = reference::gradients(&scene, &camera, &settings, &gradient);
            let by_network = reference::network_gradient(&scene, &settings, &exact.outputs);
            let layers = by_network.into_iter().flat_map(|gradient| gradient.layers);
            let network: Vec<f64> =
                layers.flat_map(|layer| layer.weight.into_iter().chain(layer.bias)).collect();
            let stride = scene.splats.sh_rest_stride();
            errors(&measured, &network, |group| exact_group(&exact.splats, group, stride))
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
            "network_tflops": measured.network_tflops,
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

fn settings(time: f32) -> FrameSettings {
    FrameSettings { time, ..FrameSettings::default() }
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
    time: f32,
    weights: &[[f32; 4]],
    runs: usize,
) -> Result<Measured, CliError> {
    let mut renderer = DifferentiableRenderer::new(RendererOptions::default());
    let gradient = ImageGradient { color: weights, expected_depth: None };
    let (mut gradients, mut by_network) = (Splats::default(), Vec::new());
    let (mut total, mut times) = (Vec::new(), Vec::new());
    for _ in 0..runs {
        let start = Instant::now();
        renderer.forward(scene, camera, &settings(time))?;
        renderer.backward_with_network(scene, &gradient, &mut gradients, &mut by_network)?;
        total.push(start.elapsed());
        times.push(renderer.times());
    }
    let stages = medians(
        &times,
        &[
            ("deform", |t| t.forward.deform),
            ("project", |t| t.forward.project),
            ("sort", |t| t.forward.sort),
            ("bin", |t| t.forward.bin),
            ("rasterize", |t| t.forward.rasterize),
            ("rasterize_backward", |t| t.rasterize_backward),
            ("project_backward", |t| t.project_backward),
            ("deform_backward", |t| t.deform_backward),
        ],
    );
    let visible = renderer.visible_splats();
    Ok(Measured {
        gradients,
        by_network,
        network_tflops: None,
        total,
        stages,
        device: None,
        visible,
        entries: None,
    })
}

/// Activations of the network that a chunk of splats may take, as in training.
const ACTIVATION_BYTES: u64 = 512 << 20;

fn on_gpu(
    scene: &Scene,
    camera: &Camera,
    time: f32,
    weights: &[[f32; 4]],
    runs: usize,
) -> Result<Measured, CliError> {
    let gpu: Gpu = open_gpu()?;
    let count = scene.len() as u32;
    let mut network = match &scene.deformation {
        None => None,
        Some(_) if scene.origin != DVec3::ZERO => {
            return Err(CliError::argument("SCENE", "splats relative to zero", "an origin"));
        }
        Some(network) => Some(DifferentiableDeformation::new(
            &gpu,
            network,
            &network_parameters(network),
            count,
            ACTIVATION_BYTES,
        )?),
    };
    let camera = camera.relative_to(scene.origin);
    let settings = ForwardSettings::default();
    let canonical = ParameterBuffers::from_splats(&gpu, &scene.splats, count)?;
    let drawn = network.as_ref().map_or(canonical.clone(), |n| n.deformed(&canonical));
    let mut renderer =
        trapeze_gpu::DifferentiableRenderer::new(&gpu, count, count.saturating_mul(4))?;
    let by_color = gpu.storage_of("weights", weights)?;
    let by_image = ImageGradientBuffers { color: &by_color, expected_depth: None };
    let mut out = ParameterBuffers::zeroed(&gpu, count, scene.splats.sh_degree)?;
    out.count = count;
    if let Some(network) = &mut network {
        network.timed_forward(&canonical, time)?;
    }
    // Makes room for the frame's tile entries.
    let (_, status) = renderer.forward_and_wait(&drawn, &camera, settings)?;
    let mut passes = || -> Result<Option<_>, CliError> {
        let mut deform = DeformationTimes::default();
        if let Some(network) = &mut network {
            deform += network.timed_forward(&canonical, time)?.unwrap_or_default();
        }
        let times = renderer.timed_passes(&drawn, &camera, settings, by_image, &out)?;
        if let Some(network) = &mut network {
            deform += network.timed_backward(&canonical, &out)?.unwrap_or_default();
        }
        Ok(times.map(|times| (deform, times)))
    };
    warm_up_gpu(&mut passes)?;
    let mut times = Vec::new();
    for _ in 0..runs {
        times.extend(passes()?);
    }
    if times.is_empty() {
        let expected = "a device with timestamp queries";
        return Err(CliError::argument("--backend", expected, "one without"));
    }
    let stages = medians(&times, &GPU_STAGES);
    let by_network = match &network {
        None => Vec::new(),
        Some(network) => network.read_packed(network.gradients())?,
    };
    Ok(Measured {
        gradients: out.read(&gpu)?,
        by_network,
        network_tflops: scene.deformation.as_ref().map(|n| network_tflops(n, count, &stages)),
        total: times.iter().map(|(deform, passes)| deform.total() + passes.total()).collect(),
        stages,
        device: Some(DeviceReport::of(&gpu)),
        visible: status.visible as usize,
        entries: Some(status.most_entries),
    })
}

/// The stages of both passes on the GPU, in their order.
const GPU_STAGES: [Stage<(DeformationTimes, PassTimes)>; 14] = [
    ("deform_encode", |t| t.0.encode),
    ("deform_layers", |t| t.0.layers),
    ("deform_apply", |t| t.0.apply),
    ("project", |t| t.1.project),
    ("sort", |t| t.1.sort),
    ("bin", |t| t.1.bin),
    ("rasterize", |t| t.1.rasterize),
    ("rasterize_backward", |t| t.1.rasterize_backward),
    ("sum_slots", |t| t.1.sum_slots),
    ("project_backward", |t| t.1.project_backward),
    ("deform_apply_backward", |t| t.0.apply_backward),
    ("deform_weights_backward", |t| t.0.weights_backward),
    ("deform_weights_sum", |t| t.0.weights_sum),
    ("deform_layers_backward", |t| t.0.layers_backward),
];

/// Arithmetic of the network's matrix products, TFLOP/s: two operations per weight and splat, without
/// what padding adds.
fn network_tflops(network: &DeformationNetwork, splats: u32, stages: &Value) -> Value {
    let hidden: usize = network.hidden.iter().map(|layer| layer.weight.len()).sum();
    let all = network.multiply_adds();
    // No gradient goes into γ: that of layer 0, and in front of the layer after the skip.
    let by_inputs = all - 2 * network.input_width() * network.width();
    let products = [
        ("deform_layers", hidden),
        ("deform_weights_backward", all),
        ("deform_layers_backward", by_inputs),
    ];
    let speed = |(name, multiply_adds): (&str, usize)| {
        let operations = 2.0 * multiply_adds as f64 * f64::from(splats);
        let ms = stages[name].as_f64().unwrap_or(f64::NAN);
        (name.to_owned(), json!(operations / ms * 1e-9))
    };
    products.into_iter().map(speed).collect::<Map<_, _>>().into()
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

/// ‖g − g*‖₂ / ‖g*‖₂ and ‖g − g*‖∞ / ‖g*‖∞ of each group that the scene has, and of the network's
/// parameters.
fn errors(
    found: &Measured,
    exact_network: &[f64],
    exact: impl Fn(ParameterGroup) -> Vec<f64>,
) -> Value {
    let mut all = Map::new();
    let mut add = |name: &str, found: &[f32], exact: &[f64]| {
        let difference = found.iter().zip(exact).map(|(&a, b)| f64::from(a) - b);
        let (mut squares, mut largest) = (0.0, 0.0f64);
        for d in difference {
            squares += d * d;
            largest = if d.abs() <= largest { largest } else { d.abs() };
        }
        let norm: f64 = exact.iter().map(|g| g * g).sum();
        let most = exact.iter().fold(0.0f64, |m, g| m.max(g.abs()));
        if norm > 0.0 {
            let error = json!({ "l2": (squares / norm).sqrt(), "max": largest / most });
            all.insert(name.to_owned(), error);
        }
    };
    for group in ParameterGroup::ALL {
        add(group.name(), group.of(&found.gradients), &exact(group));
    }
    add("network", &found.by_network, exact_network);
    all.into()
}
