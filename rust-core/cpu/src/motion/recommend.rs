//! Which share of the splats can rest without being missed.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use trapeze_scene::{Camera, Frame, FrameSettings, ImageError, Motion, Scene, SceneError};

use crate::Renderer;
use crate::deform::DeformationStage;

/// A masked share must stay this close to the unmasked image in every view and at every time, dB.
pub const RECOMMENDED_MIN_PSNR: f64 = 40.0;

/// What one static share costs and saves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShareOutcome {
    /// Share of static splats that was asked for, 0–100.
    pub percentile: f32,
    /// Threshold on the motion values, world units.
    pub threshold: f32,
    /// Splats that the network still moves.
    pub dynamic_splats: usize,
    /// Error against the unmasked frame on the worst view and time.
    pub worst: ImageError,
    /// Median time of the network over a frame, milliseconds.
    pub network_ms: f64,
    /// Median time of the network over an unmasked frame, divided by `network_ms`.
    pub speed_up: f64,
}

/// Compares masked with unmasked frames, over all views and times.
struct Comparison<'a> {
    scene: &'a Arc<Scene>,
    motion: &'a Motion,
    views: &'a [Camera],
    times: &'a [f32],
    renderer: Renderer,
    /// Unmasked frames.
    references: Vec<Frame>,
    /// Median time of the network over an unmasked frame, milliseconds.
    full_ms: f64,
}

impl Comparison<'_> {
    fn share(&mut self, percentile: f32) -> Result<ShareOutcome, SceneError> {
        let threshold = self.motion.threshold_at_percentile(percentile);
        let frames = render_all(&mut self.renderer, self.views, self.times, Some(threshold))?;
        let errors = frames.iter().zip(&self.references);
        let worst = errors
            .map(|(frame, reference)| ImageError::between(&frame.color, &reference.color))
            .reduce(ImageError::worst);
        let network_ms = network_ms(self.scene, self.times, Some(threshold));
        Ok(ShareOutcome {
            percentile,
            threshold,
            dynamic_splats: self.motion.dynamic_indices(threshold).len(),
            worst: worst.unwrap_or(ImageError { psnr: f64::INFINITY, max: 0.0, p999: 0.0 }),
            network_ms,
            speed_up: self.full_ms / network_ms,
        })
    }
}

/// Compares masked with unmasked frames for each of `percentiles`, over all `views` and `times`,
/// and then for the whole percents between the largest share that keeps [`RECOMMENDED_MIN_PSNR`]
/// and the smallest that does not, by bisection. The outcomes ascend in share.
///
/// `progress` is called after each share with the shares done; when it breaks the outcomes so far
/// are returned.
///
/// # Errors
/// [`SceneError`] when the scene has no motion values for its splats, or a camera cannot project.
pub fn compare_static_shares(
    scene: &Arc<Scene>,
    percentiles: &[f32],
    views: &[Camera],
    times: &[f32],
    mut progress: impl FnMut(usize) -> ControlFlow<()>,
) -> Result<Vec<ShareOutcome>, SceneError> {
    let missing = SceneError::Length { field: "motion values", expected: scene.len(), found: 0 };
    let motion = scene.motion.as_ref().ok_or(missing)?;
    let mut renderer = Renderer::new(scene.clone());
    let references = render_all(&mut renderer, views, times, None)?;
    let full_ms = network_ms(scene, times, None);
    let mut comparison = Comparison { scene, motion, views, times, renderer, references, full_ms };
    let mut outcomes = Vec::with_capacity(percentiles.len());
    let mut listed = percentiles.iter().copied();
    while let Some(percentile) = listed.next().or_else(|| share_between(&outcomes)) {
        outcomes.push(comparison.share(percentile)?);
        if progress(outcomes.len()).is_break() {
            break;
        }
    }
    outcomes.sort_by(|a, b| a.percentile.total_cmp(&b.percentile));
    Ok(outcomes)
}

/// The whole percent half-way between the recommended share and the next one that was compared;
/// `None` when they are a percent apart.
fn share_between(outcomes: &[ShareOutcome]) -> Option<f32> {
    let kept = recommended_percentile(outcomes);
    let missed = outcomes.iter().map(|o| o.percentile).filter(|&p| p > kept);
    let middle = ((kept + missed.reduce(f32::min)?) / 2.0).floor();
    (middle > kept).then_some(middle)
}

/// The largest share whose worst view and time keeps [`RECOMMENDED_MIN_PSNR`], when all smaller
/// shares in the list keep it too; 0 when none does.
#[must_use]
pub fn recommended_percentile(outcomes: &[ShareOutcome]) -> f32 {
    let mut sorted: Vec<&ShareOutcome> = outcomes.iter().collect();
    sorted.sort_by(|a, b| a.percentile.total_cmp(&b.percentile));
    sorted
        .iter()
        .take_while(|outcome| outcome.worst.psnr >= RECOMMENDED_MIN_PSNR)
        .last()
        .map_or(0.0, |outcome| outcome.percentile)
}

fn render_all(
    renderer: &mut Renderer,
    views: &[Camera],
    times: &[f32],
    static_threshold: Option<f32>,
) -> Result<Vec<Frame>, SceneError> {
    let mut frames = Vec::with_capacity(views.len() * times.len());
    // Views inside: the geometry of a moment is computed once.
    for &time in times {
        let settings = FrameSettings { time, static_threshold, ..FrameSettings::default() };
        for view in views {
            frames.push(renderer.render(view, &settings)?);
        }
    }
    Ok(frames)
}

/// Median time of the deformation stage over at least 15 changes of time, milliseconds.
fn network_ms(scene: &Scene, times: &[f32], static_threshold: Option<f32>) -> f64 {
    let mut stage = DeformationStage::new(scene);
    stage.deform(scene, 0.0, static_threshold);
    let mut durations: Vec<f64> = times
        .iter()
        .cycle()
        .take(times.len().max(15))
        .enumerate()
        .map(|(i, &time)| {
            // No two frames in a row show the same moment, or the second would cost nothing.
            let time = time + 1e-4 * (i + 1) as f32;
            let start = Instant::now();
            stage.deform(scene, time, static_threshold);
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    durations.sort_unstable_by(f64::total_cmp);
    durations.get(durations.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(percentile: f32, psnr: f64) -> ShareOutcome {
        ShareOutcome {
            percentile,
            threshold: 0.0,
            dynamic_splats: 0,
            worst: ImageError { psnr, max: 0.0, p999: 0.0 },
            network_ms: 1.0,
            speed_up: 1.0,
        }
    }

    #[test]
    fn the_largest_share_that_keeps_the_quality_is_recommended() {
        let outcomes = [outcome(60.0, 39.0), outcome(20.0, 55.0), outcome(40.0, 41.0)];
        assert_eq!(recommended_percentile(&outcomes), 40.0);
    }

    #[test]
    fn a_lucky_share_behind_a_bad_one_is_not_recommended() {
        let outcomes = [outcome(20.0, 55.0), outcome(40.0, 30.0), outcome(60.0, 41.0)];
        assert_eq!(recommended_percentile(&outcomes), 20.0);
        assert_eq!(recommended_percentile(&[outcome(5.0, 10.0)]), 0.0);
    }

    #[test]
    fn the_recommendation_is_narrowed_down_to_whole_percents() {
        let mut outcomes = vec![outcome(80.0, 50.0), outcome(90.0, 30.0)];
        let mut asked = Vec::new();
        while let Some(percentile) = share_between(&outcomes) {
            asked.push(percentile);
            outcomes.push(outcome(percentile, if percentile <= 86.0 { 41.0 } else { 39.0 }));
        }
        assert_eq!(asked, [85.0, 87.0, 86.0]);
        assert_eq!(recommended_percentile(&outcomes), 86.0);
        assert_eq!(share_between(&[outcome(95.0, 50.0)]), None);
    }
}
