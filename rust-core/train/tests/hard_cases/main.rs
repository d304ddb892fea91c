//! The hard cases of the stability suite that concern training, on the CPU backend: 4 (opacity),
//! 6 (equal splats) and 11 (degenerate images, rates that explode).

mod case_04_opacity;
mod case_06_order;
mod case_11_images_and_rates;
#[path = "../support/mod.rs"]
mod support;

use std::sync::Arc;

use glam::DVec3;
use trapeze_scene::{Camera, Splats};
use trapeze_train::backend::{StepReport, TrainingBackend, TrainingView};
use trapeze_train::config::TrainingConfig;
use trapeze_train::loss::{Channels, TargetImage};
use trapeze_train::{CpuBackend, TrainingState};

use support::{is_finite, multiply_rates, photograph, splats};

/// A camera on the −z axis that looks at the origin.
fn camera(width: u32, height: u32) -> Camera {
    Camera::look_at(DVec3::new(0.0, 0.0, -4.0), DVec3::ZERO, DVec3::NEG_Y, 0.7, (width, height))
}

/// A backend that holds some splats and one photograph, and the photograph's view.
fn loaded(splats: Splats, camera: Camera, target: TargetImage) -> (CpuBackend, TrainingView) {
    let mut backend = CpuBackend::default();
    let capacity = 2 * splats.len() as u32;
    backend.load(TrainingState::new(splats), capacity).unwrap();
    backend.admit_target(0, Arc::new(target)).unwrap();
    (backend, TrainingView { id: 0, camera, time: 0.0 })
}

/// Takes the steps of a configuration and returns what they reported.
fn take_steps(
    backend: &mut CpuBackend,
    view: &TrainingView,
    config: &TrainingConfig,
) -> Vec<StepReport> {
    for step in 0..config.steps {
        backend.step(&config.step_plan(step, 1.0, 1.0), view).unwrap();
    }
    backend.reports(config.steps).unwrap()
}
