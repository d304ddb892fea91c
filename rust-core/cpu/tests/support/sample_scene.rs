//! The sample scene.

use std::path::{Path, PathBuf};

use trapeze_formats::load_scene;
use trapeze_scene::Scene;

/// A file of the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// The sample scene, with its network and the original app's motion values.
pub(crate) fn load() -> Scene {
    load_scene(&repository("assets/sample-scene")).unwrap()
}
