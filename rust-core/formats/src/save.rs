//! Saving a scene.

use std::path::Path;

use trapeze_scene::Scene;

use crate::scene_path::SplatFormat;
use crate::spz::SpzOptions;
use crate::weights_bin::expect_standard;
use crate::{
    WriteError, ply, splat_file, spz, write_cluster_names, write_clusters_bin, write_mask_bin,
    write_mask_json, write_weights_bin,
};

/// Saves a scene: to one splat file when the name ends like one (`.ply`, `.compressed.ply`,
/// `.splat`, `.spz`), else to a folder, as [`save_scene_folder`].
///
/// # Errors
/// [`WriteError`] when the format cannot hold the scene, or with the operating system's reason.
pub fn save_scene(path: &Path, scene: &Scene) -> Result<(), WriteError> {
    match SplatFormat::of_name(path) {
        Some(format) => save_splats(path, scene, format),
        None => save_scene_folder(path, scene),
    }
}

fn save_splats(path: &Path, scene: &Scene, format: SplatFormat) -> Result<(), WriteError> {
    match format {
        SplatFormat::Ply => ply::write_ply(path, scene),
        SplatFormat::CompressedPly => ply::write_compressed_ply(path, scene),
        SplatFormat::Splat => splat_file::write_splat_file(path, scene),
        SplatFormat::Spz => spz::write_spz(path, scene, &SpzOptions::default()),
        SplatFormat::Sog => Err(WriteError::Unrepresentable {
            path: path.into(),
            what: "format".into(),
            expected: ".ply, .compressed.ply, .splat, .spz or a folder".into(),
            found: ".sog, which is only read".into(),
        }),
    }
}

/// Saves a scene to a folder, whatever its name: `point_cloud.ply`, and everything that the scene has
/// beside it. Files of parts that it does not have are removed: they would belong to other splats.
///
/// # Errors
/// [`WriteError`] when the files cannot hold the scene, or with the operating system's reason.
pub fn save_scene_folder(folder: &Path, scene: &Scene) -> Result<(), WriteError> {
    let io = |path: &Path| {
        let path = path.to_owned();
        move |source| WriteError::Io { path, source }
    };
    // Everything that can be refused is refused before the first file changes.
    refuse_invalid(folder, scene)?;
    refuse_checkpoints(folder, scene)?;
    if let Some(network) = &scene.deformation {
        expect_standard(&folder.join("weights.bin"), network)?;
    }
    std::fs::create_dir_all(folder).map_err(io(folder))?;
    ply::write_ply(&folder.join("point_cloud.ply"), scene)?;
    let mut stale = Vec::new();
    match &scene.deformation {
        Some(network) => write_weights_bin(&folder.join("weights.bin"), network)?,
        None => stale.push("weights.bin"),
    }
    match &scene.clusters {
        Some(clusters) => {
            write_clusters_bin(&folder.join("clusters.bin"), clusters)?;
            write_cluster_names(&folder.join("cluster-names.json"), clusters)?;
        }
        None => stale.extend(["clusters.bin", "cluster-names.json"]),
    }
    match &scene.motion {
        Some(motion) => {
            write_mask_bin(&folder.join("mask.bin"), motion)?;
            write_mask_json(&folder.join("mask.json"), motion)?;
        }
        None => stale.extend(["mask.bin", "mask.json"]),
    }
    for name in stale {
        let path = folder.join(name);
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(io(&path)(error));
            }
            _ => {}
        }
    }
    Ok(())
}

fn refuse_invalid(folder: &Path, scene: &Scene) -> Result<(), WriteError> {
    scene.validate().map_err(|error| WriteError::Unrepresentable {
        path: folder.into(),
        what: "scene".into(),
        expected: "parts that belong together".into(),
        found: error.to_string(),
    })
}

/// A checkpoint that is already in the folder would be loaded as a part that the scene does not
/// have. It may be the only copy of something, so it is not removed either.
fn refuse_checkpoints(folder: &Path, scene: &Scene) -> Result<(), WriteError> {
    let parts =
        [("deform.pth", scene.deformation.is_some()), ("clusters.pt", scene.clusters.is_some())];
    match parts.iter().find(|(name, present)| !present && folder.join(name).exists()) {
        None => Ok(()),
        Some((name, _)) => Err(WriteError::Unrepresentable {
            path: folder.into(),
            what: "folder".into(),
            expected: format!("one without {name}, which belongs to another scene"),
            found: (*name).into(),
        }),
    }
}
