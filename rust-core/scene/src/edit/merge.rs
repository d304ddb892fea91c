//! Putting one scene into another.

use glam::DVec3;

use super::EditError;
use crate::{Cluster, Clusters, Features, Motion, Scene, Splats};

/// Where the added scene goes: a point p of it lands at `translation` + `scale` · p, in world
/// coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// World position of the added scene's zero.
    pub translation: DVec3,
    /// Enlargement, more than 0.
    pub scale: f64,
}

impl Default for Placement {
    /// The added scene stays where it is.
    fn default() -> Self {
        Self { translation: DVec3::ZERO, scale: 1.0 }
    }
}

/// `scene` with the splats of `added` behind its own.
///
/// A placement neither turns nor shears, so quaternions and spherical harmonics stay as they are;
/// positions scale, and ln `scale` is added to the log-scales. The lower SH degree is raised to the
/// higher. Where either scene has clusters the result has: those of `added` are renumbered after
/// the highest id of `scene` and keep colours and names, and splats without clusters become one.
/// Motion values of the added splats are 0 where `scene` has motion values: nothing is known of
/// them, and until it is measured they rest. Features stay where both scenes have them in one
/// length.
///
/// The network of `scene` stays, and will move the added splats too; where it moves nothing is for
/// the caller to find.
///
/// # Errors
/// [`EditError`] when `added` has a network, when the placement is not a finite one with a positive
/// scale, or when there are no ids left for the added clusters.
pub fn merge(scene: &Scene, added: &Scene, placement: &Placement) -> Result<Scene, EditError> {
    if added.deformation.is_some() {
        return Err(EditError::SecondNetwork);
    }
    let Placement { translation, scale } = *placement;
    if !(translation.is_finite() && scale.is_finite() && scale > 0.0) {
        return Err(EditError::Placement { found: format!("{translation}, {scale}") });
    }
    Ok(Scene {
        splats: joined_splats(scene, added, placement),
        origin: scene.origin,
        deformation: scene.deformation.clone(),
        clusters: joined_clusters(scene, added)?,
        motion: scene.motion.as_ref().map(|motion| Motion {
            values: joined(&motion.values, std::iter::repeat_n(0.0, added.len())),
            // The share belongs to the splats as they were.
            recommended_percentile: None,
            ..motion.clone()
        }),
        features: joined_features(scene, added),
        antialiased: scene.antialiased || added.antialiased,
    })
}

fn joined_splats(scene: &Scene, added: &Scene, placement: &Placement) -> Splats {
    let degree = scene.splats.sh_degree.max(added.splats.sh_degree);
    let (first, second) = (&scene.splats, &added.splats);
    // In f64, for coordinates of captures that lie far from the world's zero.
    let offset = placement.translation + placement.scale * added.origin - scene.origin;
    let place = |p: &[f32; 3]| {
        (offset + placement.scale * DVec3::from(p.map(f64::from))).as_vec3().to_array()
    };
    let enlarged = placement.scale.ln() as f32;
    let rest = |splats: &Splats| splats.clone().with_sh_degree(degree).sh_rest;
    Splats {
        positions: joined(&first.positions, second.positions.iter().map(place)),
        log_scales: joined(
            &first.log_scales,
            second.log_scales.iter().map(|scales| scales.map(|s| s + enlarged)),
        ),
        rotations: joined(&first.rotations, second.rotations.iter().copied()),
        opacity_logits: joined(&first.opacity_logits, second.opacity_logits.iter().copied()),
        sh_dc: joined(&first.sh_dc, second.sh_dc.iter().copied()),
        sh_rest: joined(&rest(first), rest(second)),
        sh_degree: degree,
    }
}

/// The clusters of both scenes; `None` when neither has any.
fn joined_clusters(scene: &Scene, added: &Scene) -> Result<Option<Clusters>, EditError> {
    if scene.clusters.is_none() && added.clusters.is_none() {
        return Ok(None);
    }
    let first = scene.clusters.clone().unwrap_or_else(|| one_cluster(scene.len(), 0));
    let next_id = first.table.last().map_or(0, |cluster| u64::from(cluster.id) + 1);
    let known = first.table.len() as u32;
    let second = added.clusters.clone().unwrap_or_else(|| one_cluster(added.len(), known));
    let mut table = first.table;
    for (id, cluster) in (next_id..).zip(second.table) {
        let id = u32::try_from(id).map_err(|_| EditError::ClusterIds)?;
        table.push(Cluster { id, ..cluster });
    }
    let labels = joined(&first.labels, second.labels.iter().map(|label| label + known));
    Ok(Some(Clusters { labels, table }))
}

/// All splats of a scene as one cluster, in the palette's colour number `color`.
fn one_cluster(splats: usize, color: u32) -> Clusters {
    let cluster = Cluster { id: 0, color: Clusters::palette(color), name: None };
    let table = if splats == 0 { Vec::new() } else { vec![cluster] };
    Clusters { labels: vec![0; splats], table }
}

fn joined_features(scene: &Scene, added: &Scene) -> Option<Features> {
    let (first, second) = (scene.features.as_ref()?, added.features.as_ref()?);
    (first.dimensions == second.dimensions).then(|| Features {
        dimensions: first.dimensions,
        values: joined(&first.values, second.values.iter().copied()),
    })
}

fn joined<T: Copy>(first: &[T], second: impl IntoIterator<Item = T>) -> Vec<T> {
    first.iter().copied().chain(second).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ShDegree;

    /// `n` splats at `x`, of the given degree, with SH values that count up from 1.
    fn scene(n: usize, x: f32, degree: ShDegree) -> Scene {
        let rest = n * degree.rest_coefficients() * 3;
        Scene::from_splats(Splats {
            positions: vec![[x, 0.0, 0.0]; n],
            log_scales: vec![[-1.0; 3]; n],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; n],
            opacity_logits: vec![0.5; n],
            sh_dc: vec![[0.25; 3]; n],
            sh_rest: (0..rest).map(|i| i as f32 + 1.0).collect(),
            sh_degree: degree,
        })
    }

    fn with_clusters(scene: Scene, ids: &[u32]) -> Scene {
        let clusters = Clusters::from_ids(ids, &vec![[0.5; 3]; ids.len()]).unwrap();
        Scene { clusters: Some(clusters), ..scene }
    }

    fn ids_of(scene: &Scene) -> Vec<u32> {
        scene.clusters.as_ref().unwrap().table.iter().map(|cluster| cluster.id).collect()
    }

    #[test]
    fn placing_scales_about_the_added_zero_and_then_moves() {
        let placement = Placement { translation: DVec3::new(0.0, 5.0, 0.0), scale: 0.5 };
        let first = scene(1, 1.0, ShDegree::Zero);
        let merged = merge(&first, &scene(1, 4.0, ShDegree::Zero), &placement).unwrap();
        merged.validate().unwrap();
        assert_eq!(merged.splats.positions, [[1.0, 0.0, 0.0], [2.0, 5.0, 0.0]]);
        assert_eq!(merged.splats.log_scales[0], [-1.0; 3]);
        assert_eq!(merged.splats.log_scales[1], [-1.0 - std::f32::consts::LN_2; 3]);
    }

    #[test]
    fn origins_are_differences_in_double_precision() {
        // 2²⁵ + 1 is no single-precision number: the offset must not pass through one.
        let far = f64::from(1 << 25);
        let first = Scene { origin: DVec3::new(far, 0.0, 0.0), ..scene(1, 0.0, ShDegree::Zero) };
        let second =
            Scene { origin: DVec3::new(far + 1.0, 0.0, 0.0), ..scene(1, 0.25, ShDegree::Zero) };
        let merged = merge(&first, &second, &Placement::default()).unwrap();
        assert_eq!(merged.origin, first.origin);
        assert_eq!(merged.splats.positions[1], [1.25, 0.0, 0.0]);
    }

    #[test]
    fn the_lower_sh_degree_is_raised_with_zeros_on_either_side() {
        let (low, high) = (scene(1, 0.0, ShDegree::One), scene(1, 0.0, ShDegree::Two));
        for (a, b, low_at) in [(&low, &high, 0), (&high, &low, 1)] {
            let merged = merge(a, b, &Placement::default()).unwrap();
            merged.validate().unwrap();
            assert_eq!(merged.splats.sh_degree, ShDegree::Two);
            let raised = merged.splats.sh_rest_of(low_at);
            assert_eq!(raised[..9], low.splats.sh_rest[..]);
            assert!(raised[9..].iter().all(|&c| c == 0.0));
            assert_eq!(merged.splats.sh_rest_of(1 - low_at), high.splats.sh_rest);
        }
    }

    #[test]
    fn added_clusters_are_renumbered_behind_the_highest_id() {
        let first = with_clusters(scene(2, 0.0, ShDegree::Zero), &[3, 9]);
        let second = with_clusters(scene(3, 0.0, ShDegree::Zero), &[9, 0, 9]);
        let merged = merge(&first, &second, &Placement::default()).unwrap();
        merged.validate().unwrap();
        assert_eq!(ids_of(&merged), [3, 9, 10, 11]);
        assert_eq!(merged.clusters.unwrap().labels, [0, 1, 3, 2, 3]);
    }

    #[test]
    fn splats_without_clusters_become_one_of_their_own() {
        let plain = scene(2, 0.0, ShDegree::Zero);
        let clustered = with_clusters(scene(2, 0.0, ShDegree::Zero), &[4, 4]);
        let merged = merge(&clustered, &plain, &Placement::default()).unwrap();
        merged.validate().unwrap();
        assert_eq!(ids_of(&merged), [4, 5]);
        let colors = merged.clusters.unwrap().table;
        assert_eq!(colors[1].color, Clusters::palette(1));
        let merged = merge(&plain, &clustered, &Placement::default()).unwrap();
        merged.validate().unwrap();
        assert_eq!(ids_of(&merged), [0, 1]);
        let neither = merge(&plain, &plain, &Placement::default()).unwrap();
        assert!(neither.clusters.is_none());
    }

    #[test]
    fn cluster_ids_that_would_not_fit_are_refused() {
        let first = with_clusters(scene(1, 0.0, ShDegree::Zero), &[u32::MAX]);
        let second = scene(1, 0.0, ShDegree::Zero);
        assert_eq!(merge(&first, &second, &Placement::default()), Err(EditError::ClusterIds));
        let empty = scene(0, 0.0, ShDegree::Zero);
        assert!(merge(&first, &empty, &Placement::default()).is_ok());
    }

    #[test]
    fn added_splats_rest_until_their_motion_is_measured() {
        let motion =
            Motion { values: vec![0.5], recommended_percentile: Some(40.0), ..Motion::default() };
        let first = Scene { motion: Some(motion), ..scene(1, 0.0, ShDegree::Zero) };
        let merged = merge(&first, &scene(2, 0.0, ShDegree::Zero), &Placement::default()).unwrap();
        merged.validate().unwrap();
        let motion = merged.motion.unwrap();
        assert_eq!((motion.values, motion.recommended_percentile), (vec![0.5, 0.0, 0.0], None));
    }

    #[test]
    fn features_stay_only_where_both_have_them_in_one_length() {
        let with = |dimensions: usize| Scene {
            features: Some(Features { dimensions, values: vec![1.0; dimensions] }),
            ..scene(1, 0.0, ShDegree::Zero)
        };
        let features = |a: &Scene, b: &Scene| merge(a, b, &Placement::default()).unwrap().features;
        assert_eq!(features(&with(2), &with(2)).unwrap().values, [1.0; 4]);
        assert!(features(&with(2), &with(3)).is_none());
        assert!(features(&with(2), &scene(1, 0.0, ShDegree::Zero)).is_none());
    }

    #[test]
    fn placements_that_are_none_are_refused() {
        let one = scene(1, 0.0, ShDegree::Zero);
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let placement = Placement { scale, ..Placement::default() };
            let message = merge(&one, &one, &placement).unwrap_err().to_string();
            assert!(message.starts_with("placement: expected "), "{message}");
        }
        let translation = DVec3::new(f64::NAN, 0.0, 0.0);
        assert!(merge(&one, &one, &Placement { translation, scale: 1.0 }).is_err());
    }
}
