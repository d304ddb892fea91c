//! Loading a scene from wherever it lies.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use trapeze_scene::{Motion, MotionMeasure, Scene};

use crate::error::InFile;
use crate::scene_path::SplatFormat;
use crate::{
    ParseError, ReadError, apply_cluster_names, ply, read_cluster_names, read_clusters_bin,
    read_clusters_pt, read_deform_pth, read_mask_bin, read_mask_json, read_weights_bin, sog,
    splat_file, spz,
};

/// Names under which a scene folder holds its splats, in the order in which they are looked for.
const SPLATS: [&str; 4] =
    ["point_cloud.ply", "point_cloud.compressed.ply", "point_cloud.spz", "point_cloud.splat"];

/// A part of a scene, in the order in which the parts are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadPart {
    /// The splats: nearly all of the bytes.
    Splats,
    /// The deformation network.
    Network,
    /// Clusters and their names.
    Clusters,
    /// Motion values.
    Motion,
}

/// Loads a scene: a splat file, a folder with SOG's `meta.json` (or that file itself), or a scene
/// folder of the original app with splats and any of `weights.bin`, `deform.pth`, `clusters.bin`,
/// `clusters.pt`, `cluster-names.json`, `mask.bin` and `mask.json`.
///
/// # Errors
/// [`ReadError`] names the file, the field and what was expected; a part whose count does not match
/// the splats is refused with both numbers.
pub fn load_scene(path: &Path) -> Result<Scene, ReadError> {
    let scene = load_scene_with(path, |_| ControlFlow::Continue(()))?;
    // Nobody breaks off.
    Ok(scene.unwrap_or_default())
}

/// The same, telling `observer` which part comes next; `None` when it broke off.
///
/// # Errors
/// Those of [`load_scene`].
pub fn load_scene_with(
    path: &Path,
    mut observer: impl FnMut(LoadPart) -> ControlFlow<()>,
) -> Result<Option<Scene>, ReadError> {
    let is_sog = match path.is_dir() {
        true => path.join("meta.json").is_file(),
        false => path.file_name().is_some_and(|name| name == "meta.json"),
    };
    if observer(LoadPart::Splats).is_break() {
        return Ok(None);
    }
    let scene = if is_sog {
        sog::read_sog(path)?
    } else if path.is_dir() {
        match load_folder(path, &mut observer)? {
            Some(scene) => scene,
            None => return Ok(None),
        }
    } else {
        load_splats(path)?
    };
    scene.validate().in_file(path)?;
    Ok(Some(scene))
}

fn load_splats(path: &Path) -> Result<Scene, ReadError> {
    match SplatFormat::of_file(path)? {
        SplatFormat::Ply | SplatFormat::CompressedPly => ply::read_ply(path),
        SplatFormat::Splat => splat_file::read_splat_file(path),
        SplatFormat::Spz => spz::read_spz(path),
        SplatFormat::Sog => sog::read_sog(path),
    }
}

/// `None` when `observer` broke off.
fn load_folder(
    folder: &Path,
    observer: &mut dyn FnMut(LoadPart) -> ControlFlow<()>,
) -> Result<Option<Scene>, ReadError> {
    // What is there under a part's name is that part: a link to nothing or a folder is an error.
    let present = |name: &str| -> Option<PathBuf> {
        Some(folder.join(name)).filter(|path| path.symlink_metadata().is_ok())
    };
    let splats = SPLATS.iter().find_map(|name| present(name));
    let Some(splats) = splats else {
        let error = ParseError::value("scene folder", "point_cloud.ply or point_cloud.spz", "none");
        return Err(ReadError::new(folder, error));
    };
    let mut scene = load_splats(&splats)?;
    if observer(LoadPart::Network).is_break() {
        return Ok(None);
    }
    scene.deformation = match (present("weights.bin"), present("deform.pth")) {
        (Some(path), _) => Some(read_weights_bin(&path)?),
        (None, Some(path)) => Some(read_deform_pth(&path)?),
        (None, None) => None,
    };
    if observer(LoadPart::Clusters).is_break() {
        return Ok(None);
    }
    let clusters = match (present("clusters.bin"), present("clusters.pt")) {
        (Some(path), _) => Some((read_clusters_bin(&path)?, path)),
        (None, Some(path)) => Some((read_clusters_pt(&path)?, path)),
        (None, None) => None,
    };
    if let Some((mut clusters, path)) = clusters {
        expect_count("cluster ids", scene.len(), clusters.labels.len()).in_file(&path)?;
        if let Some(path) = present("cluster-names.json") {
            apply_cluster_names(&mut clusters, read_cluster_names(&path)?);
        }
        scene.clusters = Some(clusters);
    }
    if observer(LoadPart::Motion).is_break() {
        return Ok(None);
    }
    if let Some(path) = present("mask.bin") {
        scene.motion = Some(load_motion(&path, present("mask.json").as_deref(), &scene)?);
    }
    Ok(Some(scene))
}

fn load_motion(mask: &Path, settings: Option<&Path>, scene: &Scene) -> Result<Motion, ReadError> {
    let values = read_mask_bin(mask, scene.len(), scene.clusters.as_ref())?;
    let settings = settings.map(read_mask_json).transpose()?.unwrap_or_default();
    Ok(Motion {
        values,
        measure: settings.measure.unwrap_or(MotionMeasure::Unknown),
        recommended_percentile: settings.recommended_percentile,
    })
}

fn expect_count(field: &'static str, expected: usize, found: usize) -> Result<(), ParseError> {
    if expected == found {
        return Ok(());
    }
    Err(ParseError::value(field, format!("{expected}, one per splat"), found))
}
