//! From stored parameters to splats in the world: deformation, activations, colour.

use glam::DVec3;
use rayon::prelude::*;
use trapeze_scene::{Camera, ColorSource, FrameSettings, Scene, is_dynamic, sigmoid};

use super::SplatParameters;
use super::deform::{Pose, canonical_pose, deform_splat};
use crate::project::{flat_color, motion_reference};

/// A splat at the time of the frame, activated.
#[derive(Clone, Debug, PartialEq)]
pub struct PosedSplat {
    /// Index of the splat in the scene.
    pub index: u32,
    /// Centre, world units, relative to the scene's origin.
    pub position: DVec3,
    /// Quaternion (w, x, y, z) as it enters the covariance.
    pub rotation: [f64; 4],
    /// Standard deviations, world units.
    pub scale: DVec3,
    /// o, 0–1.
    pub opacity: f64,
    /// r g b seen from the camera.
    pub color: DVec3,
}

/// Poses all splats that the frame shows. `camera` is relative to the scene's origin.
///
/// A masked frame (`static_threshold`) leaves splats whose motion value is at most the threshold
/// in their deformed state at t = 0.
#[must_use]
pub fn pose_scene(scene: &Scene, camera: &Camera, settings: &FrameSettings) -> Vec<PosedSplat> {
    let eye = camera.centre();
    let heat_reference = motion_reference(scene);
    (0..scene.len() as u32)
        .into_par_iter()
        .filter(|&i| {
            scene.clusters.as_ref().is_none_or(|c| settings.selection.shows(c.labels[i as usize]))
        })
        .map(|i| {
            let Pose { position, rotation, scale } = pose(scene, i as usize, settings);
            let position = DVec3::from(position);
            let color = match settings.color_source {
                ColorSource::SphericalHarmonics => {
                    let degree = scene.splats.sh_degree.min(settings.max_sh_degree);
                    let parameters = SplatParameters::of(&scene.splats, i as usize);
                    parameters.color(position - eye, degree)
                }
                source => {
                    let depth = camera.world_to_camera.transform_point3(position).z as f32;
                    let color = flat_color(scene, source, i as usize, heat_reference, depth);
                    DVec3::from(color.map(f64::from))
                }
            };
            PosedSplat {
                index: i,
                position,
                rotation,
                scale: DVec3::from(scale),
                opacity: sigmoid(f64::from(scene.splats.opacity_logits[i as usize])),
                color,
            }
        })
        .collect()
}

pub(super) fn pose(scene: &Scene, i: usize, settings: &FrameSettings) -> Pose {
    let Some(network) = &scene.deformation else { return canonical_pose(&scene.splats, i) };
    deform_splat(network, &scene.splats, i, scene.origin, network_time(scene, i, settings))
}

/// The time at which the network sees splat `i`: a static splat of a masked frame rests at 0.
pub(super) fn network_time(scene: &Scene, i: usize, settings: &FrameSettings) -> f64 {
    let held = match (&scene.motion, settings.static_threshold) {
        (Some(motion), Some(threshold)) => !is_dynamic(motion.values[i], threshold),
        _ => false,
    };
    if held { 0.0 } else { f64::from(settings.time) }
}
