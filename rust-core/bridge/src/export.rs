//! Writing a scene.

use std::path::Path;

use trapeze_formats::spz::{SpzOptions, write_spz};
use trapeze_formats::{SplatFormat, ply, save_scene};
use trapeze_scene::Scene;

use crate::failure::{Code, Failure};
use crate::ffi::{ExportFormat, Stage};
use crate::work::Work;

/// What was written.
#[derive(Debug)]
pub(crate) struct Exported {
    splats: u64,
    bytes: u64,
    warnings: Vec<String>,
}

impl Exported {
    pub(crate) fn splat_count(&self) -> u64 {
        self.splats
    }

    pub(crate) fn file_bytes(&self) -> u64 {
        self.bytes
    }

    pub(crate) fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}

/// Writes a scene; what is there is replaced only when the new file is whole.
pub(crate) fn export(
    scene: &Scene,
    path: &Path,
    format: ExportFormat,
    work: &Work,
) -> Result<Exported, Failure> {
    work.step(Stage::Writing, None)?;
    let warnings = match format {
        ExportFormat::Ply => {
            ply::write_ply(path, scene)?;
            left_out(scene, "PLY")
        }
        ExportFormat::Spz => {
            write_spz(path, scene, &SpzOptions::default())?;
            left_out(scene, "SPZ")
        }
        ExportFormat::Folder => {
            // `save_scene` would take it for one file.
            if SplatFormat::of_name(path).is_some() {
                let found = path.display();
                return Err(Failure::argument("folder", "a name that is no file's", found));
            }
            save_scene(path, scene)?;
            Vec::new()
        }
    };
    let bytes = bytes_at(path).map_err(|error| {
        Failure::new(Code::UnreadableFile, format!("{}: {error}", path.display()))
    })?;
    Ok(Exported { splats: scene.len() as u64, bytes, warnings })
}

/// What a splat file cannot hold of a scene.
fn left_out(scene: &Scene, format: &str) -> Vec<String> {
    [
        ("deformation network", scene.deformation.is_some()),
        ("clusters", scene.clusters.is_some()),
        ("motion values", scene.motion.is_some()),
    ]
    .into_iter()
    .filter(|&(_, present)| present)
    .map(|(part, _)| format!("{part}: {format} files have none, a scene folder has"))
    .collect()
}

/// Length of a file, or of the files in a folder.
fn bytes_at(path: &Path) -> std::io::Result<u64> {
    if !path.is_dir() {
        return Ok(path.metadata()?.len());
    }
    std::fs::read_dir(path)?.map(|entry| Ok(entry?.metadata()?.len())).sum()
}
