//! From where a cluster is seen best.

use glam::DVec3;
use trapeze_scene::{Bounds, Camera, FrameSettings, Orbit, Scene, ShDegree};

use super::{CropOptions, CropRenderer, Member};
use crate::SearchError;

/// Side of a trial render, pixels.
const TRIAL_SIZE: u32 = 64;
/// Pixels of a trial render below which a cluster counts as not seen.
const LEAST_TRIAL_PIXELS: usize = 6;
/// Directions that are tried: azimuths at two heights above the horizon, degrees.
const AZIMUTHS: u32 = 8;
const ELEVATIONS: [f64; 2] = [12.0, 42.0];
/// A view less than this from a chosen one shows little that is new, degrees.
const SEPARATION: f64 = 40.0;
/// Vertical field of view of all crops: little perspective, and room for a camera in a room.
const FIELD_OF_VIEW: f64 = 35.0;
/// Share of a cluster's splats that its box leaves out at each end of each axis.
const TRIM: f64 = 0.02;
/// A cluster moves when its splats travel more than this share of its radius.
const MOVED_SHARE: f64 = 0.05;

/// Box around the splats `members` at `positions`, without the outermost ones, in world units; `None`
/// when none is finite.
#[must_use]
pub fn extent(scene: &Scene, members: &[u32], positions: &[[f32; 3]]) -> Option<Bounds> {
    let finite: Vec<[f32; 3]> = members
        .iter()
        .map(|&i| positions[i as usize])
        .filter(|p| p.iter().all(|c| c.is_finite()))
        .collect();
    let last = finite.len().checked_sub(1)?;
    let trim = (last as f64 * TRIM) as usize;
    let mut bounds = Bounds { min: DVec3::ZERO, max: DVec3::ZERO };
    let mut values = Vec::with_capacity(finite.len());
    for axis in 0..3 {
        values.clear();
        values.extend(finite.iter().map(|p| p[axis]));
        let low = *values.select_nth_unstable_by(trim, f32::total_cmp).1;
        let high = *values.select_nth_unstable_by(last - trim, f32::total_cmp).1;
        bounds.min[axis] = f64::from(low) + scene.origin[axis];
        bounds.max[axis] = f64::from(high) + scene.origin[axis];
    }
    Some(bounds)
}

/// A camera on a cluster, and how well it sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewpoint {
    /// The camera, which frames the cluster.
    pub camera: Camera,
    /// Unit vector from the cluster to the camera.
    pub direction: DVec3,
    /// Pixels of the trial render that show it.
    pub seen: usize,
}

/// Whether the splats `members` travel between the times.
#[must_use]
pub fn moves(extent: &Bounds, members: &[u32], positions: &[Vec<[f32; 3]>]) -> bool {
    let Some((first, later)) = positions.split_first() else { return false };
    let radius = extent.radius().max(f64::MIN_POSITIVE);
    later.iter().any(|now| {
        let travelled: f64 = members
            .iter()
            .map(|&i| {
                let at = |positions: &[[f32; 3]]| DVec3::from(positions[i as usize].map(f64::from));
                at(first).distance(at(now))
            })
            .filter(|distance| distance.is_finite())
            .sum();
        travelled > MOVED_SHARE * radius * members.len() as f64
    })
}

/// At most `count` cameras at `time` that see the cluster, the best first: each next one is the best
/// of those that look from another side.
pub(crate) fn choose(
    renderer: &mut dyn CropRenderer,
    member: Member<'_>,
    extent: &Bounds,
    time: f32,
    count: usize,
    options: &CropOptions,
) -> Result<Vec<Viewpoint>, SearchError> {
    let mut tried = Vec::new();
    for (direction, camera) in candidates(extent, options) {
        // Only who is in front counts: no view-dependent colour.
        let settings = FrameSettings {
            time,
            top_contributor: true,
            max_sh_degree: ShDegree::Zero,
            ..FrameSettings::default()
        };
        let trial = camera.resized(TRIAL_SIZE, TRIAL_SIZE);
        let frame = renderer.render(&trial, &settings).map_err(SearchError::Render)?;
        let seen = frame.top_contributor.iter().filter(|&&splat| member.owns(splat)).count();
        if seen >= LEAST_TRIAL_PIXELS {
            tried.push(Viewpoint { camera, direction, seen });
        }
    }
    Ok(choose_viewpoints(tried, count))
}

/// The best of the tried viewpoints, from different sides first.
#[must_use]
pub fn choose_viewpoints(mut tried: Vec<Viewpoint>, count: usize) -> Vec<Viewpoint> {
    // A stable sort: of equally good ones the first stays first.
    tried.sort_by_key(|viewpoint| std::cmp::Reverse(viewpoint.seen));
    let mut chosen: Vec<Viewpoint> = Vec::with_capacity(count);
    let least_cosine = SEPARATION.to_radians().cos();
    while chosen.len() < count && !tried.is_empty() {
        let apart = tried.iter().position(|viewpoint| {
            chosen.iter().all(|other| other.direction.dot(viewpoint.direction) < least_cosine)
        });
        chosen.push(tried.remove(apart.unwrap_or(0)));
    }
    chosen
}

/// Cameras around the cluster.
fn candidates(extent: &Bounds, options: &CropOptions) -> Vec<(DVec3, Camera)> {
    let size = (options.size, options.size);
    let centre = extent.centre();
    let mut cameras = Vec::new();
    for (ring, elevation) in ELEVATIONS.into_iter().enumerate() {
        for step in 0..AZIMUTHS {
            // The upper ring looks from between the directions of the lower one.
            let azimuth = 360.0 * (f64::from(step) + 0.5 * ring as f64) / f64::from(AZIMUTHS);
            let orbit = Orbit { azimuth, elevation, up: options.up };
            let camera = orbit.frame(extent, FIELD_OF_VIEW.to_radians(), size);
            let direction = (camera.centre() - centre).normalize_or(DVec3::Z);
            cameras.push((direction, camera));
        }
    }
    cameras
}

#[cfg(test)]
mod tests {
    use super::*;

    fn viewpoint(direction: DVec3, seen: usize) -> Viewpoint {
        let camera = Camera::look_at(direction, DVec3::ZERO, DVec3::Y, 1.0, (8, 8));
        Viewpoint { camera, direction: direction.normalize(), seen }
    }

    #[test]
    fn another_side_is_chosen_before_a_better_view_of_the_same() {
        let tried = vec![
            viewpoint(DVec3::X, 90),
            viewpoint(DVec3::new(1.0, 0.1, 0.0), 100),
            viewpoint(DVec3::NEG_Z, 20),
        ];
        let seen = |count| -> Vec<usize> {
            choose_viewpoints(tried.clone(), count).iter().map(|v| v.seen).collect()
        };
        assert_eq!(seen(2), [100, 20]);
        assert_eq!(seen(5), [100, 20, 90]);
    }

    #[test]
    fn a_cluster_that_only_trembles_stays() {
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
        let at = |x: f32| vec![[x, 0.0, 0.0]; 3];
        assert!(!moves(&bounds, &[0, 2], &[at(0.0), at(0.01)]));
        assert!(moves(&bounds, &[0, 2], &[at(0.0), at(0.01), at(0.3)]));
        assert!(!moves(&bounds, &[0], &[at(0.0), at(f32::NAN)]));
    }
}
