//! The sample scene.

use std::path::{Path, PathBuf};

use trapeze_formats::{ply, read_mask_bin, read_weights_bin};
use trapeze_scene::{Motion, MotionMeasure, Scene};

/// A file of the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// Splats, network and motion values of the sample scene.
pub(crate) fn load() -> Scene {
    let folder = repository("assets/sample-scene");
    let mut scene = ply::read_ply(&folder.join("point_cloud.ply")).unwrap();
    scene.deformation = Some(read_weights_bin(&folder.join("weights.bin")).unwrap());
    let values = read_mask_bin(&folder.join("mask.bin"), scene.len(), None).unwrap();
    scene.motion =
        Some(Motion { values, measure: MotionMeasure::PositionOnly, ..Motion::default() });
    scene
}
