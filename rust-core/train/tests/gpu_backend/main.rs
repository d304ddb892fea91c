//! The GPU backend as a whole, beside the CPU's.

mod runs;
mod steps;

use std::sync::{Arc, OnceLock};

use glam::DVec3;
use trapeze_gpu::{Gpu, GpuError, GpuOptions};
use trapeze_scene::{Camera, Splats};
use trapeze_train::backend::{StepReport, TrainingBackend, TrainingView};
use trapeze_train::config::TrainingConfig;
use trapeze_train::loss::{Channels, TargetImage};
use trapeze_train::{GpuBackend, GpuBackendOptions, ParameterGroup, TrainingState};

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

/// A photograph with a gradient and stripes; another one for each view.
fn photograph(view: u32, (width, height): (u32, u32)) -> Arc<TargetImage> {
    let pixel = |i: u32| {
        let (x, y) = (i % width, i / width);
        [(x * 5) as u8, (y * 7) as u8, if (x + view).is_multiple_of(4) { 200 } else { 60 }]
    };
    let pixels = (0..width * height).flat_map(pixel).collect();
    Arc::new(TargetImage::new(width, height, Channels::Rgb, pixels).unwrap())
}

/// Views of different sizes, their photographs resident.
fn admitted(backend: &mut dyn TrainingBackend, views: u32) -> Vec<TrainingView> {
    let admit = |id| {
        let size = (40 + 7 * id, 30);
        backend.admit_target(id, photograph(id, size)).unwrap();
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

fn is_finite(splats: &Splats) -> bool {
    ParameterGroup::ALL.iter().all(|group| group.of(splats).iter().all(|v| v.is_finite()))
}
