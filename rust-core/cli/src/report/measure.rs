//! Measuring the variants.

use std::sync::Arc;
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use trapeze_cpu::{Renderer, reference};
use trapeze_scene::{Camera, Frame, FrameSettings, ImageError, Scene};

use super::Row;
use super::variant::Variant;
use crate::error::CliError;
use crate::measure::Timing;

/// A frame to render.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    pub(crate) camera: Camera,
    pub(crate) time: f32,
}

/// Renders all moments with the f64 reference and with every variant, at least `min_frames` timed
/// frames each; the reference is timed on its one pass.
pub(crate) fn measure(
    scene: &Arc<Scene>,
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
    let mut rows = vec![row("f64 reference", &reference_timing, &reference_timing, none, moving)];
    for variant in variants {
        let mut renderer = Renderer::with_options(scene.clone(), variant.options);
        let (error, durations) =
            measure_variant(&mut renderer, variant, moments, &exact, min_frames)?;
        let moved = match (&scene.motion, variant.settings.static_threshold) {
            (Some(motion), Some(threshold)) => motion.dynamic_indices(threshold).len(),
            _ => moving,
        };
        rows.push(row(&variant.name, &Timing::of(&durations), &reference_timing, error, moved));
        progress.inc(1);
    }
    Ok(rows)
}

fn measure_variant(
    renderer: &mut Renderer,
    variant: &Variant,
    moments: &[Moment],
    exact: &[Frame],
    min_frames: usize,
) -> Result<(ImageError, Vec<Duration>), CliError> {
    let settings = |time: f32| FrameSettings { time, ..variant.settings.clone() };
    let mut frame = Frame::default();
    // One pass for the error, which also warms up; all pixels of all frames count together.
    let (mut pixels, mut truth) = (Vec::new(), Vec::new());
    for (moment, exact) in moments.iter().zip(exact) {
        renderer.render_into(&moment.camera, &settings(moment.time), &mut frame)?;
        pixels.extend_from_slice(&frame.color);
        truth.extend_from_slice(&exact.color);
    }
    let error = ImageError::between(&pixels, &truth);
    let mut durations = Vec::new();
    for _ in 0..min_frames.div_ceil(moments.len()) {
        for moment in moments {
            // A little later each frame: the same time again would leave out the network.
            let time = moment.time + durations.len() as f32 * 1e-4;
            let start = Instant::now();
            renderer.render_into(&moment.camera, &settings(time), &mut frame)?;
            durations.push(start.elapsed());
        }
    }
    Ok((error, durations))
}

fn row(
    variant: &str,
    timing: &Timing,
    reference: &Timing,
    error: ImageError,
    deformed_splats: usize,
) -> Row {
    Row {
        variant: variant.into(),
        backend: if variant.starts_with("f64") { "reference" } else { "cpu" }.into(),
        median_ms: timing.median_ms,
        p10_ms: timing.p10_ms,
        p90_ms: timing.p90_ms,
        frames: timing.runs,
        speed_up: reference.median_ms / timing.median_ms,
        psnr: error.psnr.is_finite().then_some(error.psnr),
        max: error.max,
        p999: error.p999,
        deformed_splats,
    }
}
