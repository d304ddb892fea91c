//! Filters that look at one splat at a time.

use glam::DVec3;

use super::EditError;
use crate::{Bounds, ClusterSet, Clusters, Scene, sigmoid};

/// Ids that an error message lists at most.
const LISTED_IDS: usize = 10;

/// The splats of the clusters with these ids.
///
/// # Errors
/// [`EditError`] names the first id that the scene does not have.
pub fn keep_clusters(scene: &Scene, ids: &[u32]) -> Result<Vec<u32>, EditError> {
    let (clusters, chosen) = chosen_clusters(scene, ids)?;
    Ok(indices_where(&clusters.labels, |&label| chosen.contains(label)))
}

/// The splats of all clusters but those with these ids.
///
/// # Errors
/// [`EditError`] names the first id that the scene does not have.
pub fn drop_clusters(scene: &Scene, ids: &[u32]) -> Result<Vec<u32>, EditError> {
    let (clusters, chosen) = chosen_clusters(scene, ids)?;
    Ok(indices_where(&clusters.labels, |&label| !chosen.contains(label)))
}

/// The splats with their centre inside a box in world coordinates, its faces included. Centres
/// that are not finite are outside of every box.
#[must_use]
pub fn crop_box(scene: &Scene, bounds: &Bounds) -> Vec<u32> {
    indices_where(&scene.splats.positions, |&position| {
        bounds.contains(scene.origin + DVec3::from(position.map(f64::from)))
    })
}

/// The splats with an opacity of at least `opacity`, in 0–1. A logit that is not a number is an
/// invisible splat.
#[must_use]
pub fn min_opacity(scene: &Scene, opacity: f64) -> Vec<u32> {
    indices_where(&scene.splats.opacity_logits, |&logit| sigmoid(f64::from(logit)) >= opacity)
}

fn chosen_clusters<'a>(
    scene: &'a Scene,
    ids: &[u32],
) -> Result<(&'a Clusters, ClusterSet), EditError> {
    let clusters = scene.clusters.as_ref().ok_or(EditError::NoClusters)?;
    let label = |&id| {
        clusters
            .label_of(id)
            .ok_or_else(|| EditError::UnknownCluster { id, known: ids_of(clusters) })
    };
    Ok((clusters, ids.iter().map(label).collect::<Result<_, _>>()?))
}

fn ids_of(clusters: &Clusters) -> String {
    let ids: Vec<String> =
        clusters.table.iter().take(LISTED_IDS).map(|cluster| cluster.id.to_string()).collect();
    let more = if clusters.table.len() > LISTED_IDS { ", …" } else { "" };
    ids.join(", ") + more
}

pub(super) fn indices_where<T>(values: &[T], keep: impl Fn(&T) -> bool) -> Vec<u32> {
    (0..).zip(values).filter(|(_, value)| keep(value)).map(|(index, _)| index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, Splats};

    fn scene() -> Scene {
        let n = 4;
        let splats = Splats {
            positions: vec![[0.0; 3], [1.0; 3], [f32::NAN, 0.0, 0.0], [2.0; 3]],
            log_scales: vec![[0.0; 3]; n],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; n],
            opacity_logits: vec![0.0, -10.0, f32::NAN, f32::INFINITY],
            sh_dc: vec![[0.0; 3]; n],
            ..Splats::default()
        };
        Scene {
            origin: DVec3::new(1e6, 0.0, 0.0),
            clusters: Some(Clusters::from_ids(&[7, 3, 7, 9], &[[0.0; 3]; 4]).unwrap()),
            motion: Some(Motion { values: vec![0.0, 1.0, 2.0, 3.0], ..Motion::default() }),
            ..Scene::from_splats(splats)
        }
    }

    #[test]
    fn clusters_are_kept_and_dropped_by_id() {
        assert_eq!(keep_clusters(&scene(), &[7, 3, 7]).unwrap(), [0, 1, 2]);
        assert_eq!(drop_clusters(&scene(), &[7]).unwrap(), [1, 3]);
        assert!(keep_clusters(&scene(), &[]).unwrap().is_empty());
    }

    #[test]
    fn an_unknown_cluster_is_refused_by_its_id() {
        let error = keep_clusters(&scene(), &[7, 8]).unwrap_err().to_string();
        assert_eq!(error, "cluster 8: expected one of 3, 7, 9");
        let without = Scene { clusters: None, ..scene() };
        assert_eq!(drop_clusters(&without, &[7]), Err(EditError::NoClusters));
        let ids: Vec<u32> = (0..100).collect();
        let many = Scene {
            clusters: Some(Clusters::from_ids(&ids, &[[0.0; 3]; 100]).unwrap()),
            ..scene()
        };
        let error = keep_clusters(&many, &[100]).unwrap_err().to_string();
        assert!(error.ends_with("7, 8, 9, …"), "{error}");
    }

    #[test]
    fn the_crop_box_is_in_world_coordinates() {
        let bounds =
            Bounds { min: DVec3::new(1e6, 0.0, 0.0), max: DVec3::new(1e6 + 1.0, 1.0, 1.0) };
        assert_eq!(crop_box(&scene(), &bounds), [0, 1]);
        let everything =
            Bounds { min: DVec3::splat(f64::NEG_INFINITY), max: DVec3::splat(f64::INFINITY) };
        assert_eq!(crop_box(&scene(), &everything), [0, 1, 3]);
    }

    #[test]
    fn faint_splats_leave() {
        assert_eq!(min_opacity(&scene(), 0.5), [0, 3]);
        assert_eq!(min_opacity(&scene(), 0.0), [0, 1, 2, 3]);
        assert_eq!(min_opacity(&scene(), 1.0), [3]);
    }

    #[test]
    fn filters_compose_and_keep_every_part_with_its_splat() {
        let scene = scene();
        let first = scene.gather(&keep_clusters(&scene, &[7, 9]).unwrap());
        let second = first.gather(&min_opacity(&first, 0.5));
        second.validate().unwrap();
        assert_eq!(second.motion.unwrap().values, [0.0, 3.0]);
        let clusters = second.clusters.unwrap();
        assert_eq!(clusters.table.iter().map(|c| c.id).collect::<Vec<_>>(), [7, 9]);
    }
}
