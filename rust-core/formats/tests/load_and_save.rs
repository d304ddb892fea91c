//! Scenes as files and folders: what is saved is loaded again, and parts that do not fit together
//! are refused by name.

#[path = "support/checkpoint.rs"]
mod checkpoint;
#[allow(dead_code, reason = "shared by all test binaries")]
mod scenes;

use std::ops::ControlFlow;
use std::path::Path;

use scenes::random_scene;
use tempfile::tempdir;
use trapeze_formats::{
    LoadPart, WEIGHTS_BIN_BYTES, load_scene, load_scene_with, parse_deform_pth, parse_weights_bin,
    save_scene,
};
use trapeze_scene::{Clusters, Motion, MotionMeasure, Scene, ShDegree, edit};

/// A scene with every part that a folder keeps.
fn complete_scene(n: usize) -> Scene {
    let splats = random_scene(n, ShDegree::Two, 5).splats;
    let ids: Vec<u32> = (0..n as u32).map(|i| 10 + i % 3).collect();
    let colors: Vec<[f32; 3]> = ids.iter().map(|&id| Clusters::palette(id)).collect();
    let mut clusters = Clusters::from_ids(&ids, &colors).unwrap();
    clusters.table[1].name = Some("green ball".into());
    let weights = (0..WEIGHTS_BIN_BYTES / 4).flat_map(|i| (i as f32).to_le_bytes());
    Scene {
        deformation: Some(parse_weights_bin(&weights.collect::<Vec<u8>>()).unwrap()),
        clusters: Some(clusters),
        motion: Some(Motion {
            values: (0..n).map(|i| i as f32 * 0.5).collect(),
            measure: MotionMeasure::PositionAndCovariance,
            recommended_percentile: Some(40.0),
        }),
        ..Scene::from_splats(splats)
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn load_error(path: &Path) -> String {
    let message = load_scene(path).unwrap_err().to_string();
    assert!(message.contains(path.to_str().unwrap()) && !message.contains('\n'), "{message}");
    message
}

#[test]
fn the_sample_scene_is_loaded_with_all_its_parts() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    let scene = load_scene(&assets.join("sample-scene")).unwrap();
    assert_eq!((scene.len(), scene.splats.sh_degree), (34_670, ShDegree::Three));
    assert!(scene.deformation.as_ref().unwrap().is_standard());
    let clusters = scene.clusters.as_ref().unwrap();
    let names: Vec<_> = clusters.table.iter().filter_map(|c| c.name.as_deref()).collect();
    assert_eq!(names, ["plate", "monkey head", "red ball", "green ball", "box"]);
    let motion = scene.motion.as_ref().unwrap();
    assert_eq!(motion.measure, MotionMeasure::Unknown);
    assert_eq!(motion.recommended_percentile, Some(45.0));
}

#[test]
fn a_folder_keeps_every_part_and_what_is_left_stays_consistent() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("new").join("scene");
    let scene = complete_scene(30);
    save_scene(&path, &scene).unwrap();
    assert_eq!(
        names(&path),
        [
            "cluster-names.json",
            "clusters.bin",
            "mask.bin",
            "mask.json",
            "point_cloud.ply",
            "weights.bin"
        ]
    );
    assert_eq!(load_scene(&path).unwrap(), scene);

    // Over the old one, with fewer splats.
    let kept = edit::drop_clusters(&scene, &[10]).unwrap();
    let edited = scene.gather(&kept);
    save_scene(&path, &edited).unwrap();
    assert_eq!(load_scene(&path).unwrap(), edited);
    assert_eq!(names(&path).len(), 6);
}

#[test]
fn a_load_can_be_broken_off_before_each_of_its_parts() {
    let folder = tempdir().unwrap();
    save_scene(folder.path(), &complete_scene(20)).unwrap();
    let parts = [LoadPart::Splats, LoadPart::Network, LoadPart::Clusters, LoadPart::Motion];
    for (i, last) in parts.into_iter().enumerate() {
        let mut told = Vec::new();
        let scene = load_scene_with(folder.path(), |part| {
            told.push(part);
            if part == last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(scene.unwrap(), None);
        assert_eq!(told, parts[..=i]);
    }
}

#[test]
fn every_format_is_known_by_its_extension_or_its_first_bytes() {
    let folder = tempdir().unwrap();
    let scene = random_scene(7, ShDegree::One, 5);
    for (name, has_magic) in
        [("a.ply", true), ("b.compressed.ply", true), ("c.SPZ", true), ("d.splat", false)]
    {
        let path = folder.path().join(name);
        save_scene(&path, &scene).unwrap();
        assert_eq!(load_scene(&path).unwrap().len(), 7, "{name}");
        let unnamed = folder.path().join("unnamed");
        std::fs::copy(&path, &unnamed).unwrap();
        if has_magic {
            assert_eq!(load_scene(&unnamed).unwrap().len(), 7, "{name}");
        } else {
            assert!(
                load_error(&unnamed)
                    .contains("format: expected a splat file (.ply, .compressed.ply, .splat")
            );
        }
    }
}

#[test]
fn counts_that_do_not_match_are_refused_with_both_numbers() {
    let folder = tempdir().unwrap();
    let (ten, eleven) = (folder.path().join("ten"), folder.path().join("eleven"));
    save_scene(&ten, &complete_scene(10)).unwrap();
    save_scene(&eleven, &complete_scene(11)).unwrap();

    std::fs::copy(eleven.join("mask.bin"), ten.join("mask.bin")).unwrap();
    let message = load_error(&ten);
    assert!(message.contains("mask.bin: motion values: expected 10 values"), "{message}");
    assert!(message.contains("3 (one per cluster), found 11"), "{message}");

    std::fs::copy(eleven.join("clusters.bin"), ten.join("clusters.bin")).unwrap();
    let message = load_error(&ten);
    let expected = "clusters.bin: cluster ids: expected 10, one per splat, found 11";
    assert!(message.ends_with(expected), "{message}");

    let mut broken = complete_scene(4);
    broken.motion.as_mut().unwrap().values.pop();
    let error = save_scene(&folder.path().join("x"), &broken).unwrap_err();
    assert!(error.to_string().contains("motion values: expected 4 values, found 3"), "{error}");
}

#[test]
fn the_forms_of_pytorch_and_masks_per_cluster_are_read_from_a_folder() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("scene");
    save_scene(&path, &random_scene(4, ShDegree::Zero, 5)).unwrap();
    std::fs::write(path.join("deform.pth"), checkpoint::tiny_network()).unwrap();
    std::fs::write(path.join("clusters.pt"), checkpoint::tiny_clusters()).unwrap();
    std::fs::write(path.join("cluster-names.json"), r#"{"8": "ball"}"#).unwrap();
    std::fs::write(path.join("mask.bin"), checkpoint::floats(&[0.0, 1.0])).unwrap();
    let scene = load_scene(&path).unwrap();
    assert_eq!(scene.deformation.unwrap().width(), 2);
    assert_eq!(scene.clusters.unwrap().table[1].name.as_deref(), Some("ball"));
    let motion = scene.motion.unwrap();
    assert_eq!(motion.values, [0.0, 1.0, 0.0, 0.0]);
    assert_eq!(motion.measure, MotionMeasure::Unknown);
    assert_eq!(motion.recommended_percentile, None);
}

#[test]
fn a_network_that_cannot_be_written_leaves_the_folder_as_it_was() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("scene");
    let scene = complete_scene(5);
    save_scene(&path, &scene).unwrap();
    let network = parse_deform_pth(&checkpoint::tiny_network()).unwrap();
    let variant = Scene { deformation: Some(network), ..complete_scene(6) };
    let message = save_scene(&path, &variant).unwrap_err().to_string();
    assert!(message.starts_with(path.join("weights.bin").to_str().unwrap()), "{message}");
    assert!(message.contains("deformation network: expected 8 × 256"), "{message}");
    assert!(message.contains("found 3 × 2, 24 inputs"), "{message}");
    assert_eq!(load_scene(&path).unwrap(), scene);
    assert_eq!(names(&path).len(), 6, "no litter");
}

#[test]
fn a_saved_folder_holds_nothing_of_the_scene_before() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("scene");
    save_scene(&path, &complete_scene(5)).unwrap();
    let plain = random_scene(6, ShDegree::Zero, 5);
    std::fs::write(path.join("notes.txt"), "not ours").unwrap();
    save_scene(&path, &plain).unwrap();
    assert_eq!(load_scene(&path).unwrap(), plain);
    assert_eq!(names(&path), ["notes.txt", "point_cloud.ply"]);

    // What this program cannot write it does not delete either.
    for name in ["deform.pth", "clusters.pt"] {
        std::fs::write(path.join(name), "precious").unwrap();
        let message = save_scene(&path, &plain).unwrap_err().to_string();
        assert!(message.contains(&format!("one without {name}")), "{message}");
        std::fs::remove_file(path.join(name)).unwrap();
    }
}

#[test]
fn folders_and_pipes_in_the_place_of_files_are_refused() {
    let folder = tempdir().unwrap();
    assert!(load_error(folder.path()).contains("scene folder: expected point_cloud.ply"));
    assert!(load_error(&folder.path().join("missing.ply")).contains("No such file"));

    let path = folder.path().join("scene");
    std::fs::create_dir_all(path.join("point_cloud.ply")).unwrap();
    assert!(load_error(&path).contains("expected a regular file, found a folder"));

    std::fs::remove_dir(path.join("point_cloud.ply")).unwrap();
    save_scene(&path, &complete_scene(2)).unwrap();
    for name in names(&path) {
        let (file, aside) = (path.join(&name), folder.path().join("aside"));
        std::fs::rename(&file, &aside).unwrap();
        std::fs::create_dir(&file).unwrap();
        let message = load_error(&path);
        assert!(message.contains(&name) && message.contains("found a folder"), "{message}");
        std::fs::remove_dir(&file).unwrap();
        std::fs::rename(&aside, &file).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn links_are_followed_dangling_ones_are_named_and_pipes_do_not_hang() {
    let folder = tempdir().unwrap();
    let (path, linked) = (folder.path().join("scene"), folder.path().join("linked"));
    let scene = complete_scene(2);
    save_scene(&path, &scene).unwrap();
    std::fs::create_dir(&linked).unwrap();
    for name in names(&path) {
        std::os::unix::fs::symlink(path.join(&name), linked.join(&name)).unwrap();
    }
    assert_eq!(load_scene(&linked).unwrap(), scene);
    std::fs::remove_file(path.join("mask.bin")).unwrap();
    assert!(load_error(&linked).contains("mask.bin"));

    for name in ["pipe.ply", "pipe.splat", "pipe.spz", "pipe.sog", "pipe"] {
        let pipe = folder.path().join(name);
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(load_error(&pipe).contains("found a pipe"), "{name}");
    }
}
