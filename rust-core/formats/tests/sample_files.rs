//! The files beside the splats, as the original system and the reference renderers wrote them.

use std::path::PathBuf;

use trapeze_formats::{
    NpyValues, apply_cluster_names, read_camera, read_cluster_names, read_clusters_bin,
    read_mask_bin, read_mask_json, read_npy, read_npz, read_views, read_weights_bin,
    write_clusters_bin, write_mask_bin, write_weights_bin,
};
use trapeze_scene::Motion;

const SPLATS: usize = 34_670;

/// A folder of test data, or a loud skip.
fn data(path: &str) -> Option<PathBuf> {
    let found = std::env::var_os("TRAPEZE_DATA").map(|root| PathBuf::from(root).join(path));
    let found = found.filter(|path| path.exists());
    if found.is_none() {
        eprintln!("SKIPPED: {path} needs TRAPEZE_DATA");
    }
    found
}

#[test]
fn the_sample_scene_is_written_back_byte_for_byte() {
    let Some(folder) = data("sample-scene") else { return };
    let written = tempfile::tempdir().unwrap();
    let same = |name: &str| {
        let (a, b) = (folder.join(name), written.path().join(name));
        assert!(std::fs::read(a).unwrap() == std::fs::read(b).unwrap(), "{name} differs");
    };
    let network = read_weights_bin(&folder.join("weights.bin")).unwrap();
    write_weights_bin(&written.path().join("weights.bin"), &network).unwrap();
    same("weights.bin");

    let mut clusters = read_clusters_bin(&folder.join("clusters.bin")).unwrap();
    write_clusters_bin(&written.path().join("clusters.bin"), &clusters).unwrap();
    same("clusters.bin");
    assert_eq!(clusters.labels.len(), SPLATS);
    assert_eq!(clusters.table.iter().map(|c| c.id).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
    let names = read_cluster_names(&folder.join("cluster-names.json")).unwrap();
    apply_cluster_names(&mut clusters, names);
    assert_eq!(clusters.table[1].name.as_deref(), Some("monkey head"));

    let values = read_mask_bin(&folder.join("mask.bin"), SPLATS, Some(&clusters)).unwrap();
    let motion = Motion { values, ..Motion::default() };
    write_mask_bin(&written.path().join("mask.bin"), &motion).unwrap();
    same("mask.bin");
    let settings = read_mask_json(&folder.join("mask.json")).unwrap();
    assert_eq!(settings.recommended_percentile, Some(45.0));
    assert_eq!(settings.measure, None, "the original does not say");
}

#[test]
fn the_reference_views_and_their_images_are_read() {
    let Some(folder) = data("goldens/sample-scene") else { return };
    let views = read_views(&folder.join("views.json")).unwrap();
    assert_eq!(views.len(), 10);
    assert!(views.windows(2).all(|pair| pair[0].time < pair[1].time));
    assert!(views.iter().all(|view| (view.camera.rotation().determinant() - 1.0).abs() < 1e-5));
    let image = read_npy(&folder.join(views[3].image.as_ref().unwrap())).unwrap();
    assert_eq!(image.shape, [400, 400, 4]);
    let NpyValues::F32(values) = image.values else { panic!("f16 is read as f32") };
    assert!(values.iter().all(|v| v.is_finite()) && values.iter().any(|&v| v > 0.5));
}

#[test]
fn a_camera_in_full_hd_is_read() {
    let Some(folder) = data("goldens/guitar") else { return };
    let camera = read_camera(&folder.join("camera_1080p.json")).unwrap();
    assert_eq!((camera.width, camera.height, camera.cx), (1920, 1080, 963.25));
}

#[test]
fn the_reference_archives_are_read() {
    let Some(folder) = data("goldens") else { return };
    let deform = read_npz(&folder.join("deform_f64.npz")).unwrap();
    assert_eq!(deform["t0.5"].shape, [1000, 10]);
    assert!(matches!(deform["t0.5"].values, NpyValues::F64(_)));
    assert_eq!(deform["index"].shape, [1000]);
    assert!(deform["index"].values.to_f64().iter().all(|&i| (i as usize) < SPLATS));
    let gradients = read_npz(&folder.join("grad_stone.npz")).unwrap();
    assert_eq!(gradients["sh"].shape, [1500, 16, 3]);
    assert_eq!(gradients["w2c"].shape, [4, 4]);
}
