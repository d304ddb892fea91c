//! The sample scene, read without the `formats` crate.

use std::path::{Path, PathBuf};

use trapeze_scene::deformation::{NamedTensors, Tensor};
use trapeze_scene::{DeformationNetwork, Scene, Splats};

/// A file of the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// The folder of the sample scene.
pub(crate) fn folder() -> Option<PathBuf> {
    let committed = repository("assets/sample-scene");
    if committed.is_dir() {
        return Some(committed);
    }
    let data = std::env::var_os("TRAPEZE_DATA").map(|data| Path::new(&data).join("sample-scene"));
    let folder = data.filter(|folder| folder.is_dir());
    if folder.is_none() {
        eprintln!("SKIPPED: the sample scene needs TRAPEZE_DATA");
    }
    folder
}

pub(crate) fn f32s(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
}

/// Positions, scales, rotations and network of the scene in `folder`.
pub(crate) fn load(folder: &Path) -> Scene {
    let ply = std::fs::read(folder.join("point_cloud.ply")).unwrap();
    let end = ply.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    // x y z nx ny nz f_dc×3 f_rest×45 opacity scale×3 rot×4
    let vertices = f32s(&ply[end..]);
    let vertices = vertices.chunks_exact(62);
    let n = vertices.len();
    let splats = Splats {
        positions: vertices.clone().map(|v| [v[0], v[1], v[2]]).collect(),
        log_scales: vertices.clone().map(|v| [v[55], v[56], v[57]]).collect(),
        rotations: vertices.map(|v| [v[58], v[59], v[60], v[61]]).collect(),
        opacity_logits: vec![0.0; n],
        sh_dc: vec![[0.0; 3]; n],
        ..Splats::default()
    };
    let weights = f32s(&std::fs::read(folder.join("weights.bin")).unwrap());
    Scene { deformation: Some(network(&weights)), ..Scene::from_splats(splats) }
}

fn network(mut rest: &[f32]) -> DeformationNetwork {
    let hidden = (0..8).map(|i| {
        let inputs = match i {
            0 => 84,
            5 => 340,
            _ => 256,
        };
        (format!("linear.{i}"), 256, inputs)
    });
    let heads = [("gaussian_warp", 3), ("gaussian_rotation", 4), ("gaussian_scaling", 3)]
        .map(|(name, outputs)| (name.to_owned(), outputs, 256));
    let mut tensors = NamedTensors::new();
    for (name, outputs, inputs) in hidden.chain(heads) {
        for (part, shape) in [("weight", vec![outputs, inputs]), ("bias", vec![outputs])] {
            let (data, after) = rest.split_at(shape.iter().product());
            rest = after;
            tensors.insert(format!("{name}.{part}"), Tensor { shape, data: data.to_vec() });
        }
    }
    assert!(rest.is_empty());
    DeformationNetwork::from_tensors(tensors).unwrap()
}
