//! From stored parameters to splats in the world: deformation, activations, colour.

use glam::DVec3;
use rayon::prelude::*;
use trapeze_scene::{Camera, ColorSource, FrameSettings, Scene, is_dynamic, sh_basis, sigmoid};

use super::deform::{Pose, canonical_pose, deform_splat};
use crate::project::{MAX_CHANNEL, flat_color, motion_reference};

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
                    view_color(scene, i as usize, position - eye, settings)
                }
                source => DVec3::from(
                    flat_color(scene, source, i as usize, heat_reference).map(f64::from),
                ),
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

fn pose(scene: &Scene, i: usize, settings: &FrameSettings) -> Pose {
    let Some(network) = &scene.deformation else { return canonical_pose(&scene.splats, i) };
    let held = match (&scene.motion, settings.static_threshold) {
        (Some(motion), Some(threshold)) => !is_dynamic(motion.values[i], threshold),
        _ => false,
    };
    let time = if held { 0.0 } else { f64::from(settings.time) };
    deform_splat(network, &scene.splats, i, scene.origin, time)
}

/// max(0, 0.5 + Σ cₖ Yₖ(direction)), each channel limited to [`MAX_CHANNEL`]; NaN gives 0.
fn view_color(scene: &Scene, i: usize, to_splat: DVec3, settings: &FrameSettings) -> DVec3 {
    let splats = &scene.splats;
    let degree = splats.sh_degree.min(settings.max_sh_degree);
    let basis = sh_basis(to_splat.try_normalize().unwrap_or(DVec3::Z).to_array());
    let mut color = [0.0; 3];
    for (channel, value) in color.iter_mut().enumerate() {
        let mut sum = 0.5 + basis[0] * f64::from(splats.sh_dc[i][channel]);
        for k in 1..degree.coefficients() {
            sum += basis[k] * f64::from(splats.sh_rest_of(i)[(k - 1) * 3 + channel]);
        }
        // `f64::max` returns the other operand for NaN.
        *value = sum.max(0.0).min(f64::from(MAX_CHANNEL));
    }
    DVec3::from(color)
}
