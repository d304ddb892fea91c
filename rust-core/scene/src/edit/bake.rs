//! Freezing a deformable scene at one moment.

use super::EditError;
use crate::{Scene, Splats};

/// The smallest linear scale whose logarithm is stored; a deformed scale is never below 1e-6.
const SMALLEST_SCALE: f32 = f32::MIN_POSITIVE;

/// The static scene with the given geometry in place of the canonical one: `positions` relative to
/// the scene's origin, `rotations` as quaternions (w, x, y, z), `linear_scales` as standard
/// deviations. Opacity, colour, clusters and features stay. The network and the motion values
/// belong to the splats as they were and are dropped.
///
/// # Errors
/// [`EditError::Length`] when an array does not have one entry per splat.
pub fn bake(
    scene: &Scene,
    positions: Vec<[f32; 3]>,
    rotations: Vec<[f32; 4]>,
    linear_scales: &[[f32; 3]],
) -> Result<Scene, EditError> {
    let expected = scene.len();
    for (field, found) in [
        ("positions", positions.len()),
        ("rotations", rotations.len()),
        ("scales", linear_scales.len()),
    ] {
        if found != expected {
            return Err(EditError::Length { field, expected, found });
        }
    }
    let log_scales =
        linear_scales.iter().map(|scale| scale.map(|s| s.max(SMALLEST_SCALE).ln())).collect();
    Ok(Scene {
        splats: Splats {
            positions,
            log_scales,
            rotations,
            opacity_logits: scene.splats.opacity_logits.clone(),
            sh_dc: scene.splats.sh_dc.clone(),
            sh_rest: scene.splats.sh_rest.clone(),
            sh_degree: scene.splats.sh_degree,
        },
        origin: scene.origin,
        deformation: None,
        clusters: scene.clusters.clone(),
        motion: None,
        features: scene.features.clone(),
        antialiased: scene.antialiased,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Clusters, Motion};

    fn scene() -> Scene {
        let splats = Splats {
            positions: vec![[0.0; 3]; 2],
            log_scales: vec![[0.0; 3]; 2],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; 2],
            opacity_logits: vec![0.5; 2],
            sh_dc: vec![[0.25; 3]; 2],
            ..Splats::default()
        };
        Scene {
            clusters: Some(Clusters::from_ids(&[1, 2], &[[0.0; 3]; 2]).unwrap()),
            motion: Some(Motion { values: vec![0.0; 2], ..Motion::default() }),
            ..Scene::from_splats(splats)
        }
    }

    #[test]
    fn geometry_is_replaced_and_what_described_the_motion_is_gone() {
        let positions = vec![[1.0; 3], [2.0; 3]];
        let scales = [[1.0, 0.5, 0.0], [1.0; 3]];
        let baked =
            bake(&scene(), positions.clone(), vec![[0.0, 1.0, 0.0, 0.0]; 2], &scales).unwrap();
        baked.validate().unwrap();
        assert_eq!(baked.splats.positions, positions);
        assert_eq!(baked.splats.log_scales[0][..2], [0.0, -std::f32::consts::LN_2]);
        assert!(baked.splats.log_scales[0][2].is_finite());
        assert_eq!(baked.splats.opacity_logits, [0.5; 2]);
        assert_eq!(baked.clusters, scene().clusters);
        assert!(baked.motion.is_none() && baked.deformation.is_none());
    }

    #[test]
    fn geometry_of_another_length_is_refused_by_name() {
        let error =
            bake(&scene(), vec![[0.0; 3]; 2], vec![[0.0; 4]; 3], &[[1.0; 3]; 2]).unwrap_err();
        assert_eq!(error.to_string(), "rotations: expected 2 values, found 3");
    }
}
