//! `trapeze info`.

mod support;

use support::{json, sample_scene, succeed, thinned_scene};

#[test]
fn the_parts_of_a_scene_are_named_and_counted() {
    let info = json(&arguments!["info", sample_scene(), "--json"]);
    assert_eq!(info["splats"], 34_670);
    assert_eq!(info["sh_degree"], 3);
    for corner in ["min", "max"] {
        let corner = info["bounds"][corner].as_array().unwrap();
        assert!(corner.len() == 3 && corner.iter().all(serde_json::Value::is_f64));
    }
    let clusters = info["clusters"].as_array().unwrap();
    let ids: Vec<_> = clusters.iter().map(|c| c["id"].as_u64().unwrap()).collect();
    assert_eq!(ids, [1, 2, 3, 4, 5]);
    assert_eq!(clusters[1]["name"], "monkey head");
    assert_eq!(clusters.iter().map(|c| c["splats"].as_u64().unwrap()).sum::<u64>(), 34_670);
    assert_eq!(info["deformation"]["standard"], true);
    assert_eq!(info["deformation"]["parameters"], 506_378);
    assert_eq!(info["motion"]["recommended_percentile"], 45.0);
    assert!(info["memory_bytes"].as_u64().unwrap() > 0);
}

#[test]
fn what_a_scene_lacks_is_absent() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let info = json(&arguments!["info", scene.join("point_cloud.ply"), "--json"]);
    for key in ["clusters", "deformation", "motion", "feature_dimensions", "origin"] {
        assert!(info.get(key).is_none(), "{key}");
    }
}

#[test]
fn without_json_the_figures_are_lines_for_people() {
    let folder = tempfile::tempdir().unwrap();
    let text = succeed(&arguments!["info", thinned_scene(folder.path())]);
    assert!(text.starts_with("splats        867\n"), "{text}");
    assert!(text.contains("monkey head") && text.contains("deformation"), "{text}");
}
