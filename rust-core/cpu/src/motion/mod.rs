//! How far each splat ever gets from where it starts.

mod recommend;

use std::ops::ControlFlow;

use glam::{DMat3, DQuat, DVec3};
use rayon::prelude::*;
use trapeze_scene::{Clusters, Motion, MotionMeasure, Scene};

use crate::deform::{DeformationStage, Deformed, SplatPose};

pub use recommend::{
    RECOMMENDED_MIN_PSNR, ShareOutcome, compare_static_shares, recommended_percentile,
};

/// What is measured, and when.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionOptions {
    /// [`MotionMeasure::PositionOnly`], or position and covariance.
    pub measure: MotionMeasure,
    /// Times at which the scene is compared with t = 0.
    pub times: Vec<f32>,
    /// Every splat takes the highest value of its cluster, so that an object is masked as a whole.
    pub per_cluster: bool,
}

impl Default for MotionOptions {
    /// Position and covariance at 64 times after 0, up to 1.
    fn default() -> Self {
        Self {
            measure: MotionMeasure::PositionAndCovariance,
            times: (1..=64u8).map(|i| f32::from(i) / 64.0).collect(),
            per_cluster: false,
        }
    }
}

impl MotionOptions {
    /// The original app's measure: positions only, at 11 times from 0 to 1.
    #[must_use]
    pub fn original() -> Self {
        Self {
            measure: MotionMeasure::PositionOnly,
            times: (0..=10u8).map(|i| f32::from(i) / 10.0).collect(),
            per_cluster: false,
        }
    }
}

/// Motion value of every splat: max over the times of ‖x(t) − x(0)‖, and, unless only positions
/// are asked for, √‖Σ(t) − Σ(0)‖_F; world units. 0 in a scene without a network, and for splats
/// whose pose is not a number.
///
/// `progress` is called after each time with the times done and their number; when it breaks, the
/// result is `None`.
pub fn measure_motion(
    scene: &Scene,
    options: &MotionOptions,
    mut progress: impl FnMut(usize, usize) -> ControlFlow<()>,
) -> Option<Motion> {
    let mut values = vec![0.0; scene.len()];
    if scene.deformation.is_some() {
        let mut stage = DeformationStage::new(scene);
        let initial = stage.evaluate(0.0, None).clone();
        for (done, &time) in options.times.iter().enumerate() {
            let deformed = stage.evaluate(time, None);
            raise(&mut values, &initial, deformed, options.measure);
            if progress(done + 1, options.times.len()).is_break() {
                return None;
            }
        }
    }
    if let (true, Some(clusters)) = (options.per_cluster, &scene.clusters) {
        spread_over_clusters(&mut values, clusters);
    }
    Some(Motion { values, measure: options.measure, recommended_percentile: None })
}

/// Raises each value to the distance between the two moments.
fn raise(values: &mut [f32], initial: &Deformed, now: &Deformed, measure: MotionMeasure) {
    values.par_iter_mut().enumerate().with_min_len(4096).for_each(|(i, value)| {
        let (then, now) = (initial.pose(i), now.pose(i));
        let moved = world(now.position).distance(world(then.position));
        let reshaped = match measure {
            MotionMeasure::PositionOnly => 0.0,
            _ => frobenius_distance(&covariance(&now), &covariance(&then)).sqrt(),
        };
        // `f64::max` passes over NaN.
        *value = f64::from(*value).max(moved).max(reshaped) as f32;
    });
}

fn world(position: [f32; 3]) -> DVec3 {
    DVec3::from(position.map(f64::from))
}

/// Σ = R S Sᵀ Rᵀ.
fn covariance(pose: &SplatPose) -> DMat3 {
    let [w, x, y, z] = pose.rotation.map(f64::from);
    let rotation = DMat3::from_quat(DQuat::from_xyzw(x, y, z, w));
    let factor = rotation * DMat3::from_diagonal(DVec3::from(pose.scale.map(f64::from)));
    factor * factor.transpose()
}

fn frobenius_distance(a: &DMat3, b: &DMat3) -> f64 {
    let difference = *a - *b;
    difference.to_cols_array().iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn spread_over_clusters(values: &mut [f32], clusters: &Clusters) {
    let mut highest = vec![0.0f32; clusters.table.len()];
    for (&value, &label) in values.iter().zip(&clusters.labels) {
        highest[label as usize] = highest[label as usize].max(value);
    }
    for (value, &label) in values.iter_mut().zip(&clusters.labels) {
        *value = highest[label as usize];
    }
}
