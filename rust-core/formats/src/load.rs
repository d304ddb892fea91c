//! Loading a scene from wherever it lies.

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

/// Loads a scene: a splat file, a folder with SOG's `meta.json` (or that file itself), or a scene
/// folder of the original app with splats and any of `weights.bin`, `deform.pth`, `clusters.bin`,
/// `clusters.pt`, `cluster-names.json`, `mask.bin` and `mask.json`.
///
/// # Errors
/// [`ReadError`] names the file, the field and what was expected; a part whose count does not match
/// the splats is refused with both numbers.
pub fn load_scene(path: &Path) -> Result<Scene, ReadError> {
    let scene = if path.is_dir() {
        if path.join("meta.json").is_file() { sog::read_sog(path)? } else { load_folder(path)? }
    } else if path.file_name().is_some_and(|name| name == "meta.json") {
        sog::read_sog(path)?
    } else {
        load_splats(path)?
    };
    scene.validate().in_file(path)?;
    Ok(scene)
}

fn load_splats(path: &Path) -> Result<Scene, ReadError> {
    match SplatFormat::of_file(path)? {
        SplatFormat::Ply | SplatFormat::CompressedPly => ply::read_ply(path),
        SplatFormat::Splat => splat_file::read_splat_file(path),
        SplatFormat::Spz => spz::read_spz(path),
        SplatFormat::Sog => sog::read_sog(path),
    }
}

fn load_folder(folder: &Path) -> Result<Scene, ReadError> {
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
    scene.deformation = match (present("weights.bin"), present("deform.pth")) {
        (Some(path), _) => Some(read_weights_bin(&path)?),
        (None, Some(path)) => Some(read_deform_pth(&path)?),
        (None, None) => None,
    };
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
    if let Some(path) = present("mask.bin") {
        scene.motion = Some(load_motion(&path, present("mask.json").as_deref(), &scene)?);
    }
    Ok(scene)
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
