//! Measuring the variants.

use std::sync::Arc;
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use trapeze_cpu::reference;
use trapeze_gpu::Gpu;
use trapeze_scene::{Camera, Frame, FrameSettings, ImageError, Scene};

use super::Row;
use super::engine::{Engine, device_bytes};
use super::variant::{Variant, VariantBackend};
use crate::error::CliError;
use crate::measure::Timing;

/// A frame to render.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    pub(crate) camera: Camera,
    pub(crate) time: f32,
}

/// Renders all moments with the f64 reference and with every variant, at least `min_frames` timed
/// frames each; the reference is timed on its one pass. `gpu` is for the variants that need one.
pub(crate) fn measure(
    scene: &Arc<Scene>,
    gpu: Option<&Gpu>,
    variants: &[Variant],
    moments: &[Moment],
    min_frames: usize,
    progress: &ProgressBar,
) -> Result<Vec<Row>, CliError> {
    let mut exact = Vec::with_capacity(moments.len());
    let mut durations = Vec::with_capacity(moments.len());
    for moment in moments {
        let settings = FrameSettings { time: moment.time, ..FrameSettings::default() };
        let start = Instant::now();
        exact.push(reference::render(scene, &moment.camera, &settings).to_frame());
        durations.push(start.elapsed());
        progress.inc(1);
    }
    let reference_timing = Timing::of(&durations);
    let none = ImageError { psnr: f64::INFINITY, max: 0.0, p999: 0.0 };
    let moving = if scene.deformation.is_some() { scene.len() } else { 0 };
    let reference_row = Row {
        variant: "f64 reference".into(),
        backend: "reference".into(),
        deformed_splats: moving,
        ..row(&reference_timing, &reference_timing, none)
    };
    let mut rows = vec![reference_row];
    for variant in variants {
        let mut engine = Engine::new(scene, variant.backend, gpu)?;
        let (error, durations) =
            measure_variant(&mut engine, variant, moments, &exact, min_frames)?;
        let moved = match (&scene.motion, variant.settings.static_threshold) {
            (Some(motion), Some(threshold)) => motion.dynamic_indices(threshold).len(),
            _ => moving,
        };
        let (backend, most) = match variant.backend {
            VariantBackend::Cpu(_) => ("cpu", None),
            VariantBackend::Gpu(options) => ("gpu", options.max_splats),
        };
        let camera = &moments[0].camera;
        rows.push(Row {
            variant: variant.name.clone(),
            backend: backend.into(),
            deformed_splats: most.map_or(moved, |most| moved.min(most as usize)),
            network_kernel: engine.network_kernel().map(Into::into),
            device_bytes: device_bytes(scene, variant.backend, [camera.width, camera.height])?,
            ..row(&Timing::of(&durations), &reference_timing, error)
        });
        progress.inc(1);
    }
    Ok(rows)
}

fn measure_variant(
    engine: &mut Engine,
    variant: &Variant,
    moments: &[Moment],
    exact: &[Frame],
    min_frames: usize,
) -> Result<(ImageError, Vec<Duration>), CliError> {
    let settings = |time: f32| FrameSettings { time, ..variant.settings.clone() };
    // One pass for the error, which also warms up; all pixels of all frames count together.
    let (mut pixels, mut truth) = (Vec::new(), Vec::new());
    for (moment, exact) in moments.iter().zip(exact) {
        pixels.extend(engine.render(&moment.camera, &settings(moment.time))?.color);
        truth.extend_from_slice(&exact.color);
    }
    let error = ImageError::between(&pixels, &truth);
    engine.warm_up(&moments[0].camera, &settings(moments[0].time))?;
    let mut durations = Vec::new();
    for _ in 0..min_frames.div_ceil(moments.len()) {
        for moment in moments {
            // A little later each frame: the same time again would leave out the network.
            let time = moment.time + durations.len() as f32 * 1e-4;
            durations.push(engine.time(&moment.camera, &settings(time))?);
        }
    }
    Ok((error, durations))
}

/// The figures of a row; who they belong to is left open.
fn row(timing: &Timing, reference: &Timing, error: ImageError) -> Row {
    Row {
        median_ms: timing.median_ms,
        p10_ms: timing.p10_ms,
        p90_ms: timing.p90_ms,
        frames: timing.runs,
        speed_up: reference.median_ms / timing.median_ms,
        psnr: error.psnr.is_finite().then_some(error.psnr),
        max: error.max,
        p999: error.p999,
        ..Row::default()
    }
}
