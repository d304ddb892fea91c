//! `trapeze cluster`: splats that come without clusters get them.

mod support;

use support::{json, load, refusal, sample_scene, thinned_scene};
use trapeze_formats::save_scene;
use trapeze_query::cluster::adjusted_rand_index;
use trapeze_scene::{Features, Scene};

#[test]
fn place_motion_and_colour_find_the_objects_of_the_sample_scene() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("clusters.bin");
    let report = json(&arguments!["cluster", sample_scene(), "--out", &out, "--json"]);
    assert_eq!(report["by"], "geometry");
    let agreement = report["agreement"].as_f64().unwrap();
    assert!(agreement >= 0.9, "adjusted Rand index {agreement}: {report}");
    assert!(folder.path().join("cluster-names.json").exists());
}

/// A scene whose splats carry a noisy direction of their object in 32 numbers, a tenth of them noise.
/// Returns it with the truth: the object's id, 0 for noise.
fn with_features(mut scene: Scene) -> (Scene, Vec<u32>) {
    const DIMENSIONS: usize = 32;
    let mut state = 0x5eed_u64;
    let mut signed = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    let clusters = scene.clusters.take().unwrap();
    let axes: Vec<Vec<f32>> =
        clusters.table.iter().map(|_| (0..DIMENSIONS).map(|_| signed()).collect()).collect();
    let (mut values, mut truth) = (Vec::new(), Vec::new());
    for (i, &label) in clusters.labels.iter().enumerate() {
        let noise = i % 10 == 7;
        for axis in &axes[label as usize] {
            let own = signed();
            values.push(if noise { own } else { 2.0 * axis + own });
        }
        truth.push(if noise { 0 } else { label + 1 });
    }
    scene.features = Some(Features { dimensions: DIMENSIONS, values });
    (scene, truth)
}

#[test]
fn noisy_features_of_a_ply_find_the_objects_and_keep_noise_apart() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, truth) = with_features(load(&sample_scene()));
    let path = folder.path().join("scene");
    save_scene(&path, &scene).unwrap();
    let report = json(&arguments!["cluster", &path, "--json"]);
    assert_eq!(report["by"], "features");
    let found = load(&path).clusters.unwrap();
    let index = adjusted_rand_index(&truth, &found.labels);
    assert!(index >= 0.95, "adjusted Rand index {index}: {report}");
    assert_eq!(found.table[0].name.as_deref(), Some("unassigned"));
}

#[test]
fn clusters_that_are_there_are_not_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let message = refusal(&arguments!["cluster", &scene]);
    assert!(message.contains("--force"), "{message}");
    json(&arguments!["cluster", &scene, "--force", "--json"]);

    let message = refusal(&arguments!["cluster", &scene, "--force", "--by", "features"]);
    assert!(message.contains("gaussian_feats_*"), "{message}");
    let message = refusal(&arguments!["cluster", scene.join("point_cloud.ply")]);
    assert!(message.starts_with("--out: expected a file"), "{message}");
}
