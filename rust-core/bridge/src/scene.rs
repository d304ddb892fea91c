//! Scenes: opening one, what is in it, and what an edit makes of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use trapeze_cpu::deform::DeformationStage;
use trapeze_cpu::motion::{MotionOptions, measure_motion};
use trapeze_formats::{LoadPart, load_scene_with};
use trapeze_scene::{Bounds, Splats};

use crate::edits::Edits;
use crate::export::{Exported, export};
use crate::failure::{Failure, guarded, guarded_or};
use crate::ffi::{Box3, ClusterFigures, ExportFormat, SceneFigures, Stage};
use crate::work::Work;

/// A scene in memory. It never changes: an edit makes another one.
#[derive(Debug)]
pub(crate) struct Scene {
    scene: Arc<trapeze_scene::Scene>,
    /// Splats of each cluster.
    cluster_sizes: Vec<usize>,
    source: Source,
}

/// What a scene was before it was edited.
#[derive(Clone, Debug)]
struct Source {
    /// Where it was read from; `None` for one that was trained.
    location: Option<PathBuf>,
    /// Checksum of its positions and labels.
    key: u32,
}

/// Version of the core.
pub(crate) fn core_version() -> String {
    env!("CARGO_PKG_VERSION").into()
}

/// Reads a splat file or a scene folder. Between two parts of it the work can be cancelled.
pub(crate) fn open_scene(path: String, work: &Work) -> Result<Scene, Failure> {
    guarded(|| {
        let scene = load_scene_with(Path::new(&path), |part| {
            work.flow(Stage::Reading, Some(share_before(part)))
        })?;
        let mut scene = Scene::new(scene.ok_or_else(Work::cancelled)?);
        scene.source.location = Some(path.into());
        Ok(scene)
    })
}

/// The splats are nearly all of the bytes.
fn share_before(part: LoadPart) -> f64 {
    match part {
        LoadPart::Splats => 0.0,
        LoadPart::Network => 0.9,
        LoadPart::Clusters => 0.95,
        LoadPart::Motion => 0.98,
    }
}

impl Scene {
    pub(crate) fn new(scene: trapeze_scene::Scene) -> Self {
        let sizes = scene.clusters.as_ref().map(trapeze_scene::Clusters::sizes);
        let cluster_sizes = sizes.unwrap_or_default();
        let source = Source { location: None, key: checksum(&scene) };
        Self { scene: Arc::new(scene), cluster_sizes, source }
    }

    /// The scene that an edit has made of this one.
    fn followed_by(&self, scene: trapeze_scene::Scene) -> Self {
        Self { source: self.source.clone(), ..Self::new(scene) }
    }

    /// Where it was read from, before any edit.
    pub(crate) fn location(&self) -> Option<&Path> {
        self.source.location.as_deref()
    }

    /// Recognises the scene by what it was before any edit, wherever its file lies.
    pub(crate) fn key(&self) -> u32 {
        self.source.key
    }

    pub(crate) fn shared(&self) -> &Arc<trapeze_scene::Scene> {
        &self.scene
    }

    pub(crate) fn figures(&self) -> SceneFigures {
        let nothing = SceneFigures {
            splats: 0,
            harmonics_degree: 0,
            framing: box_of(None),
            deformable: false,
            has_motion: false,
            recommended_percentile: f64::NAN,
            memory_bytes: 0,
            clusters: 0,
        };
        guarded_or(nothing, || {
            let scene = &self.scene;
            let recommended = scene.motion.as_ref().and_then(|m| m.recommended_percentile);
            SceneFigures {
                splats: scene.len() as u64,
                harmonics_degree: scene.splats.sh_degree as u32,
                framing: box_of(scene.framing_bounds()),
                deformable: scene.deformation.is_some(),
                has_motion: scene.motion.is_some(),
                recommended_percentile: recommended.map_or(f64::NAN, f64::from),
                memory_bytes: scene.memory().total(),
                clusters: self.cluster_sizes.len(),
            }
        })
    }

    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.scene.antialiased {
            warnings.push("trained with a 2-D Mip filter, which is not applied".into());
        }
        warnings
    }

    pub(crate) fn cluster(&self, index: usize) -> ClusterFigures {
        let entry = self.scene.clusters.as_ref().and_then(|clusters| clusters.table.get(index));
        let [red, green, blue] = entry.map_or([0.0; 3], |cluster| cluster.color);
        ClusterFigures {
            id: entry.map_or(0, |cluster| cluster.id),
            red,
            green,
            blue,
            splats: self.cluster_sizes.get(index).map_or(0, |&size| size as u64),
        }
    }

    pub(crate) fn cluster_name(&self, index: usize) -> Option<String> {
        self.scene.clusters.as_ref()?.table.get(index)?.name.clone()
    }

    pub(crate) fn static_threshold(&self, percentile: f64) -> f32 {
        guarded_or(f32::NAN, || {
            let motion = self.scene.motion.as_ref();
            motion.map_or(f32::NAN, |m| m.threshold_at_percentile(percentile as f32))
        })
    }

    /// Box around a cluster's splats at a time, the furthest 2 % along each axis left out.
    pub(crate) fn cluster_bounds(&self, cluster: u32, time: f64) -> Result<Box3, Failure> {
        guarded(|| {
            let Some(clusters) = &self.scene.clusters else { return Ok(box_of(None)) };
            let Some(label) = clusters.label_of(cluster) else { return Ok(box_of(None)) };
            let members = (0..).zip(&clusters.labels).filter(|&(_, &l)| l == label);
            let part = self.scene.gather(&members.map(|(index, _)| index).collect::<Vec<u32>>());
            let positions =
                DeformationStage::new(&part).evaluate(time as f32, None).positions.clone();
            let bounds = Splats { positions, ..Splats::default() }.framing_bounds();
            let origin = self.scene.origin;
            let in_world = |b: Bounds| Bounds { min: b.min + origin, max: b.max + origin };
            Ok(box_of(bounds.map(in_world)))
        })
    }

    pub(crate) fn edited(&self, edits: &Edits, work: &Work) -> Result<Scene, Failure> {
        guarded(|| Ok(self.followed_by(edits.apply(&self.scene, work)?)))
    }

    /// The same scene with the motion value of every splat.
    pub(crate) fn with_motion(&self, work: &Work) -> Result<Scene, Failure> {
        guarded(|| {
            let progress = |done: usize, of: usize| {
                work.flow(Stage::Measuring, Some(done as f64 / of.max(1) as f64))
            };
            let motion = measure_motion(&self.scene, &MotionOptions::default(), progress);
            let motion = Some(motion.ok_or_else(Work::cancelled)?);
            let scene = trapeze_scene::Scene { motion, ..trapeze_scene::Scene::clone(&self.scene) };
            Ok(self.followed_by(scene))
        })
    }

    pub(crate) fn export_to(
        &self,
        path: String,
        format: ExportFormat,
        work: &Work,
    ) -> Result<Exported, Failure> {
        guarded(|| export(&self.scene, Path::new(&path), format, work))
    }
}

fn checksum(scene: &trapeze_scene::Scene) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(bytemuck::cast_slice(&scene.splats.positions));
    if let Some(clusters) = &scene.clusters {
        hasher.update(bytemuck::cast_slice(&clusters.labels));
    }
    hasher.finalize()
}

/// All NaN for no box.
pub(crate) fn box_of(bounds: Option<Bounds>) -> Box3 {
    let nowhere = Bounds { min: DVec3::NAN, max: DVec3::NAN };
    let Bounds { min, max } = bounds.unwrap_or(nowhere);
    Box3 { min_x: min.x, min_y: min.y, min_z: min.z, max_x: max.x, max_y: max.y, max_z: max.z }
}

pub(crate) fn bounds_of(b: &Box3) -> Bounds {
    Bounds {
        min: DVec3::new(b.min_x, b.min_y, b.min_z),
        max: DVec3::new(b.max_x, b.max_y, b.max_z),
    }
}
