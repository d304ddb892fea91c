//! The GPU backend as a whole, beside the CPU's.

mod deformation;
mod removal;
mod rest;
mod runs;
mod steps;
#[path = "../support/mod.rs"]
mod support;

use std::sync::{Arc, OnceLock};

use glam::DVec3;
use trapeze_gpu::{Gpu, GpuError, GpuOptions};
use trapeze_scene::Camera;
use trapeze_train::backend::{StepReport, TrainingBackend, TrainingView};
use trapeze_train::config::TrainingConfig;
use trapeze_train::{GpuBackend, GpuBackendOptions, ParameterGroup, TrainingState};

use support::{is_finite, multiply_rates, photograph, splats};

/// The device that the tests share, or none, loudly.
fn device() -> Option<Gpu> {
    static DEVICE: OnceLock<Option<Gpu>> = OnceLock::new();
    DEVICE.get_or_init(own_device).clone()
}

/// A device of a test's own.
fn own_device() -> Option<Gpu> {
    match Gpu::open(&GpuOptions::default()) {
        Ok(gpu) => Some(gpu),
        Err(GpuError::NoAdapter { .. }) => {
            eprintln!("SKIPPED: GPU tests need a Vulkan or Metal device (mesa-vulkan-drivers)");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn backend(gpu: &Gpu) -> GpuBackend {
    GpuBackend::new(gpu, GpuBackendOptions::default()).unwrap()
}

/// A camera that looks at the origin from around it.
fn camera(i: u32, size: (u32, u32)) -> Camera {
    let angle = f64::from(i) * 0.4;
    let eye = DVec3::new(4.0 * angle.sin(), 0.0, -4.0 * angle.cos());
    Camera::look_at(eye, DVec3::ZERO, DVec3::NEG_Y, 0.7, size)
}

/// Views of different sizes, their photographs resident.
fn admitted(backend: &mut dyn TrainingBackend, views: u32) -> Vec<TrainingView> {
    let admit = |id| {
        let size = (40 + 7 * id, 30);
        backend.admit_target(id, Arc::new(photograph(id, size))).unwrap();
        TrainingView { id, camera: camera(id, size), time: 0.0 }
    };
    (0..views).map(admit).collect()
}

/// Takes the steps of a run from `first` on, its changes of the set included.
fn take_steps(
    backend: &mut dyn TrainingBackend,
    views: &[TrainingView],
    config: &TrainingConfig,
    steps: std::ops::Range<u32>,
) {
    for step in steps {
        if let Some(plan) = config.densify_plan(step, backend.splat_count()) {
            backend.densify(&plan).unwrap();
        }
        let view = &views[step as usize % views.len()];
        backend.step(&config.step_plan(step, 1.0, 1.0), view).unwrap();
    }
}
