//! Changes of a scene, collected and then applied in one go.

use std::sync::{Arc, Mutex};

use trapeze_scene::edit::{
    EditError, FloaterRule, crop_box, drop_clusters, keep_clusters, min_opacity, without_floaters,
};
use trapeze_scene::{Bounds, Cluster, Scene};

use crate::failure::{Code, Failure, guarded_or, poisoned};
use crate::ffi::{Box3, Stage};
use crate::scene::bounds_of;
use crate::work::Work;

#[derive(Clone, Debug)]
enum Edit {
    Crop(Bounds),
    Delete(Vec<u32>),
    Keep(Vec<u32>),
    DeleteFaint(f64),
    RemoveFloaters(f64),
    Rename(u32, Option<String>),
    Recolor(u32, [f32; 3]),
}

/// A list of edits, in the order in which they are made.
#[derive(Debug, Default)]
pub(crate) struct Edits(Mutex<Vec<Edit>>);

impl Edits {
    pub(crate) fn new() -> Self {
        Self::default()
    }

    pub(crate) fn crop(&self, bounds: Box3) {
        self.add(Edit::Crop(bounds_of(&bounds)));
    }

    pub(crate) fn delete_clusters(&self, clusters: &[u32]) {
        self.add(Edit::Delete(clusters.to_vec()));
    }

    pub(crate) fn keep_clusters(&self, clusters: &[u32]) {
        self.add(Edit::Keep(clusters.to_vec()));
    }

    pub(crate) fn delete_faint(&self, below: f64) {
        self.add(Edit::DeleteFaint(below));
    }

    pub(crate) fn remove_floaters(&self, sigmas: f64) {
        self.add(Edit::RemoveFloaters(sigmas));
    }

    pub(crate) fn rename(&self, cluster: u32, name: Option<String>) {
        self.add(Edit::Rename(cluster, name));
    }

    pub(crate) fn recolor(&self, cluster: u32, red: f32, green: f32, blue: f32) {
        self.add(Edit::Recolor(cluster, [red, green, blue]));
    }

    fn add(&self, edit: Edit) {
        guarded_or((), || self.0.lock().expect("nothing panics while it is held").push(edit));
    }

    /// The scene after the edits. The one before is not changed.
    pub(crate) fn apply(&self, before: &Arc<Scene>, work: &Work) -> Result<Scene, Failure> {
        let edits = self.0.lock().map_err(poisoned)?.clone();
        // Copied when something changes for the first time.
        let mut scene: Option<Scene> = None;
        for (done, edit) in edits.iter().enumerate() {
            work.step(Stage::Preparing, Some(done as f64 / edits.len() as f64))?;
            let now = scene.as_ref().unwrap_or(before);
            scene = Some(match edit.kept(now)? {
                Some(indices) if indices.is_empty() => {
                    let message = "edit: expected one that leaves splats, found none left";
                    return Err(Failure::new(Code::InvalidEdit, message));
                }
                Some(indices) => now.gather(&indices),
                None => {
                    let mut changed = scene.take().unwrap_or_else(|| Scene::clone(before));
                    edit.describe(&mut changed)?;
                    changed
                }
            });
        }
        work.check()?;
        Ok(scene.unwrap_or_else(|| Scene::clone(before)))
    }
}

impl Edit {
    /// The splats that stay; `None` for edits that take none away.
    fn kept(&self, scene: &Scene) -> Result<Option<Vec<u32>>, Failure> {
        Ok(Some(match self {
            Self::Crop(bounds) => {
                if !(bounds.min.cmple(bounds.max).all()) {
                    let found = format!("{} to {}", bounds.min, bounds.max);
                    return Err(Failure::argument("crop", "a box with min below max", found));
                }
                crop_box(scene, bounds)
            }
            Self::Delete(ids) => drop_clusters(scene, ids)?,
            Self::Keep(ids) => keep_clusters(scene, ids)?,
            Self::DeleteFaint(opacity) => {
                if !(0.0..=1.0).contains(opacity) {
                    return Err(Failure::argument("opacity", "0 to 1", opacity));
                }
                min_opacity(scene, *opacity)
            }
            Self::RemoveFloaters(sigmas) => {
                if !(0.0..=100.0).contains(sigmas) {
                    return Err(Failure::argument("sigmas", "0 to 100", sigmas));
                }
                without_floaters(scene, &FloaterRule { sigmas: *sigmas, ..FloaterRule::default() })
            }
            Self::Rename(..) | Self::Recolor(..) => return Ok(None),
        }))
    }

    /// Changes what is known about a cluster.
    fn describe(&self, scene: &mut Scene) -> Result<(), Failure> {
        match self {
            Self::Rename(id, name) => {
                let name = name.as_deref().map(str::trim).filter(|name| !name.is_empty());
                cluster_of(scene, *id)?.name = name.map(str::to_owned);
            }
            Self::Recolor(id, color) => {
                if !color.iter().all(|c| (0.0..=1.0).contains(c)) {
                    return Err(Failure::argument("colour", "0 to 1", format!("{color:?}")));
                }
                cluster_of(scene, *id)?.color = *color;
            }
            _ => {}
        }
        Ok(())
    }
}

fn cluster_of(scene: &mut Scene, id: u32) -> Result<&mut Cluster, EditError> {
    let clusters = scene.clusters.as_mut().ok_or(EditError::NoClusters)?;
    let known = || clusters.table.iter().map(|c| c.id.to_string()).take(10).collect::<Vec<_>>();
    let unknown = || EditError::UnknownCluster { id, known: known().join(", ") };
    let label = clusters.label_of(id).ok_or_else(unknown)?;
    Ok(&mut clusters.table[label as usize])
}

#[cfg(test)]
mod tests {
    use trapeze_scene::{Clusters, Splats};

    use super::*;

    fn scene() -> Arc<Scene> {
        let splats = Splats {
            positions: vec![[0.0; 3], [1.0; 3], [2.0; 3]],
            log_scales: vec![[0.0; 3]; 3],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; 3],
            opacity_logits: vec![0.0; 3],
            sh_dc: vec![[0.0; 3]; 3],
            ..Splats::default()
        };
        let clusters = Some(Clusters::from_ids(&[7, 7, 9], &[[0.5; 3]; 3]).unwrap());
        Arc::new(Scene { clusters, ..Scene::from_splats(splats) })
    }

    #[test]
    fn edits_are_made_in_order_and_leave_the_scene_before_as_it_was() {
        let (before, edits) = (scene(), Edits::new());
        edits.rename(7, Some(" cup ".into()));
        edits.delete_clusters(&[9]);
        edits.recolor(7, 1.0, 0.0, 0.25);
        let after = edits.apply(&before, &Work::new()).unwrap();
        let table = &after.clusters.as_ref().unwrap().table;
        assert_eq!((after.len(), table.len(), table[0].id), (2, 1, 7));
        assert_eq!((table[0].name.as_deref(), table[0].color), (Some("cup"), [1.0, 0.0, 0.25]));
        assert_eq!(*before, *scene());
    }

    #[test]
    fn edits_of_what_is_not_there_or_leaves_nothing_are_refused() {
        let refused = |add: &dyn Fn(&Edits)| {
            let edits = Edits::new();
            add(&edits);
            edits.apply(&scene(), &Work::new()).unwrap_err()
        };
        assert_eq!(refused(&|e| e.delete_clusters(&[7, 9])).kind(), Code::InvalidEdit);
        assert_eq!(refused(&|e| e.rename(8, None)).kind(), Code::InvalidEdit);
        assert_eq!(refused(&|e| e.delete_faint(f64::NAN)).kind(), Code::InvalidArgument);
        assert_eq!(refused(&|e| e.recolor(7, 2.0, 0.0, 0.0)).kind(), Code::InvalidArgument);
        assert_eq!(refused(&|e| e.crop(crate::scene::box_of(None))).kind(), Code::InvalidArgument);
    }

    #[test]
    fn a_cancelled_list_of_edits_is_not_applied() {
        let (edits, work) = (Edits::new(), Work::new());
        edits.delete_clusters(&[9]);
        work.cancel();
        assert_eq!(edits.apply(&scene(), &work).unwrap_err().kind(), Code::Cancelled);
    }
}
