//! Training of scenes that move, on the CPU: what is learned, what is left alone, what goes wrong.

mod faults;
mod learning;

use std::sync::Arc;

use glam::DVec3;
use trapeze_cpu::Renderer;
use trapeze_scene::{Camera, Frame, FrameSettings, Scene, Splats};
use trapeze_train::backend::{StepReport, TrainingBackend, TrainingView};
use trapeze_train::config::{Background, DeformationTraining, TrainingConfig};
use trapeze_train::loss::{Channels, TargetImage};
use trapeze_train::{CpuBackend, TrainedNetwork, TrainingState};

/// Size of every photograph.
const SIZE: (u32, u32) = (48, 36);

/// A camera that looks at the origin from one of a few sides.
fn camera(side: u32) -> Camera {
    let angle = 0.5 * f64::from(side);
    let eye = DVec3::new(4.0 * angle.sin(), 0.3, -4.0 * angle.cos());
    Camera::look_at(eye, DVec3::ZERO, DVec3::NEG_Y, 0.7, SIZE)
}

/// Five coloured balls at time `t`: two stay, three move by up to half a unit.
fn balls(t: f32) -> Splats {
    let swing = (5.0 * t).sin();
    Splats {
        positions: vec![
            [-0.8, -0.5, 0.0],
            [0.8, 0.6, 0.2],
            [-0.5 + 0.9 * t, 0.3, -0.2],
            [0.4, -0.6 + 0.7 * t * t, 0.1],
            [0.1 + 0.4 * swing, 0.1, 0.5],
        ],
        log_scales: vec![[-1.8; 3]; 5],
        rotations: vec![[1.0, 0.0, 0.0, 0.0]; 5],
        opacity_logits: vec![3.0; 5],
        sh_dc: vec![
            [1.5, -1.0, -1.0],
            [-1.0, 1.5, -1.0],
            [-1.0, -1.0, 1.5],
            [1.2, 1.2, -1.0],
            [1.2, -1.0, 1.2],
        ],
        ..Splats::default()
    }
}

fn photograph_of(splats: Splats, camera: &Camera) -> TargetImage {
    let mut renderer = Renderer::new(Arc::new(Scene::from_splats(splats)));
    let frame = renderer.render(camera, &FrameSettings::default()).unwrap();
    let byte = |c: f32| (c.clamp(0.0, 1.0) * 255.0).round() as u8;
    let pixels = frame.color.iter().flat_map(|&[r, g, b, _]| [r, g, b].map(byte)).collect();
    TargetImage::new(SIZE.0, SIZE.1, Channels::Rgb, pixels).unwrap()
}

/// Views at `times`, from three sides in turn.
fn views(times: &[f32]) -> Vec<TrainingView> {
    (0..).zip(times).map(|(id, &time)| TrainingView { id, camera: camera(id % 3), time }).collect()
}

/// A backend that holds splats, a network where the configuration trains one, and photographs of
/// the balls.
fn loaded(splats: Splats, config: &TrainingConfig, views: &[TrainingView]) -> CpuBackend {
    let mut backend = CpuBackend::default();
    let network = config.deformation.map(|_| TrainedNetwork::standard(config.seed));
    let capacity = splats.len() as u32;
    let state = TrainingState { network, ..TrainingState::new(splats) };
    backend.load(state, capacity).unwrap();
    for view in views {
        let target = photograph_of(balls(view.time), &view.camera);
        backend.admit_target(view.id, Arc::new(target)).unwrap();
    }
    backend
}

fn take_steps(
    backend: &mut CpuBackend,
    views: &[TrainingView],
    config: &TrainingConfig,
) -> Vec<StepReport> {
    for step in 0..config.steps {
        // Another order in each epoch, without a generator.
        let view = (step as usize * 7 + step as usize / views.len()) % views.len();
        backend.step(&config.step_plan(step, 1.0, 1.0), &views[view]).unwrap();
    }
    backend.reports(config.steps).unwrap()
}

fn render(backend: &mut CpuBackend, view: &TrainingView) -> Frame {
    let settings = FrameSettings { time: view.time, ..FrameSettings::default() };
    backend.render(&view.camera, &settings).unwrap()
}

/// A short run without densification over black.
fn config(steps: u32, deformation: Option<DeformationTraining>) -> TrainingConfig {
    TrainingConfig {
        background: Background::Fixed([0.0; 3]),
        sh_degree: 0,
        deformation,
        ..TrainingConfig::fixed(steps)
    }
}
