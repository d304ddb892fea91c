//! What of a trained scene moves, and what may rest.

use std::ops::ControlFlow;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use trapeze_cpu::motion::{
    MotionOptions, ShareOutcome, compare_static_shares, measure_motion, recommended_percentile,
};
use trapeze_formats::dataset::Dataset;
use trapeze_scene::{Camera, Motion, Scene, SceneError};

/// Views on which shares are compared, at most, and the most pixels along their longer side: what a
/// share costs shows in small images too.
const MOST_VIEWS: usize = 8;
const LONGEST_SIDE: u32 = 256;
/// Times at which they are compared.
const TIMES: [f32; 8] = [0.06, 0.19, 0.31, 0.44, 0.56, 0.69, 0.81, 0.94];
/// Shares that are compared first, percent; the recommended one is then found to a percent.
const SHARES: [f32; 4] = [25.0, 50.0, 75.0, 95.0];

/// What the motion mask of a trained scene leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionSummary {
    /// Share of splats that may rest, percent.
    pub recommended_percentile: f32,
    /// Highest motion value of a splat at rest, world units.
    pub threshold: f32,
    /// Splats that the network still moves.
    pub moving_splats: u32,
    /// PSNR of masked against unmasked frames in the worst view at the worst time, dB; `None`
    /// where they are equal.
    pub worst_psnr: Option<f64>,
}

/// Gives a scene that moves its motion values, measured at 64 times, and the share of splats that
/// may rest: the largest that keeps
/// [`RECOMMENDED_MIN_PSNR`](trapeze_cpu::motion::RECOMMENDED_MIN_PSNR) in some of the training views of
/// `dataset` at eight times. A scene without a network comes back as it is.
///
/// `progress` is called every fraction of a second or so; when it breaks, what comes back is
/// unfinished.
///
/// # Errors
/// [`SceneError`] when a camera cannot project.
pub fn with_measured_motion(
    scene: Scene,
    dataset: &Dataset,
    mut progress: impl FnMut() -> ControlFlow<()>,
) -> Result<(Scene, Option<MotionSummary>), SceneError> {
    let measured = match &scene.deformation {
        Some(_) => measure_motion(&scene, &MotionOptions::default(), |_, _| progress()),
        None => None,
    };
    let Some(motion) = measured else { return Ok((scene, None)) };
    let scene = Arc::new(Scene { motion: Some(motion), ..scene });
    let every = dataset.training_views().count().div_ceil(MOST_VIEWS).max(1);
    let views: Vec<Camera> = dataset
        .training_views()
        .step_by(every)
        .map(|index| reduced(&dataset.views[index].camera))
        .collect();
    let outcomes = compare_static_shares(&scene, &SHARES, &views, &TIMES, |_| progress())?;
    let recommended = recommended_percentile(&outcomes);
    let summary = match outcomes.iter().find(|outcome| outcome.percentile == recommended) {
        Some(outcome) => MotionSummary::of(outcome),
        None => MotionSummary::without_rest(scene.len()),
    };
    let mut scene = Arc::unwrap_or_clone(scene);
    if let Some(Motion { recommended_percentile, .. }) = &mut scene.motion {
        *recommended_percentile = Some(recommended);
    }
    Ok((scene, Some(summary)))
}

impl MotionSummary {
    fn of(outcome: &ShareOutcome) -> Self {
        Self {
            recommended_percentile: outcome.percentile,
            threshold: outcome.threshold,
            moving_splats: outcome.dynamic_splats as u32,
            worst_psnr: outcome.worst.psnr.is_finite().then_some(outcome.worst.psnr),
        }
    }

    fn without_rest(splats: usize) -> Self {
        Self {
            recommended_percentile: 0.0,
            threshold: 0.0,
            moving_splats: splats as u32,
            worst_psnr: None,
        }
    }
}

fn reduced(camera: &Camera) -> Camera {
    let by = camera.width.max(camera.height).div_ceil(LONGEST_SIDE).max(1);
    camera.resized((camera.width / by).max(1), (camera.height / by).max(1))
}
