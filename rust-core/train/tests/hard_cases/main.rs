//! The hard cases of the stability suite that concern training, on the CPU backend: 4 (opacity),
//! 6 (equal splats) and 11 (degenerate images, rates that explode).

mod case_04_opacity;
mod case_06_order;
mod case_11_images_and_rates;

use std::sync::Arc;

use glam::DVec3;
use trapeze_scene::{Camera, Splats};
use trapeze_train::backend::{StepReport, TrainingBackend, TrainingView};
use trapeze_train::config::TrainingConfig;
use trapeze_train::loss::{Channels, TargetImage};
use trapeze_train::{CpuBackend, ParameterGroup, TrainingState};

/// A camera on the −z axis that looks at the origin.
fn camera(width: u32, height: u32) -> Camera {
    Camera::look_at(DVec3::new(0.0, 0.0, -4.0), DVec3::ZERO, DVec3::NEG_Y, 0.7, (width, height))
}

/// Splats in a cube around the origin, all different, of SH degree 0.
fn splats(n: usize) -> Splats {
    // Steps of the golden ratio and its relatives fill the unit cube evenly.
    let place = |i: usize, k: usize| {
        let step = [0.819_172_5, 0.671_043_6, 0.549_700_5, 0.754_877_7][k % 4];
        (((i + 1) * (k / 4 + 1)) as f64 * step).fract() as f32
    };
    let three = |first: usize, scale: f32, offset: f32| {
        (0..n).map(|i| [0, 1, 2].map(|k| offset + scale * place(i, first + k))).collect()
    };
    Splats {
        positions: three(0, 2.0, -1.0),
        log_scales: three(4, 1.0, -3.0),
        rotations: (0..n).map(|i| [0, 1, 2, 3].map(|k| place(i, 8 + k) - 0.4)).collect(),
        opacity_logits: (0..n).map(|i| 4.0 * place(i, 12) - 2.0).collect(),
        sh_dc: three(13, 3.0, -1.5),
        ..Splats::default()
    }
}

/// A photograph with a gradient and stripes.
fn photograph(width: u32, height: u32) -> TargetImage {
    let pixel = |i: u32| {
        let (x, y) = (i % width, i / width);
        [(x * 5) as u8, (y * 7) as u8, if x % 4 == 0 { 200 } else { 60 }]
    };
    let pixels = (0..width * height).flat_map(pixel).collect();
    TargetImage::new(width, height, Channels::Rgb, pixels).unwrap()
}

/// A backend that holds some splats and one photograph, and the photograph's view.
fn loaded(splats: Splats, camera: Camera, target: TargetImage) -> (CpuBackend, TrainingView) {
    let mut backend = CpuBackend::default();
    let capacity = 2 * splats.len() as u32;
    backend.load(&TrainingState::new(splats), capacity).unwrap();
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

fn is_finite(splats: &Splats) -> bool {
    ParameterGroup::ALL.iter().all(|group| group.of(splats).iter().all(|v| v.is_finite()))
}
