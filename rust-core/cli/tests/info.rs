//! `trapeze info`.

mod support;

use support::{json, run, sample_scene, succeed, thinned_scene};

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
fn the_gpu_is_named_and_its_kernels_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = arguments!["info", thinned_scene(folder.path()), "--gpu", "--json"];
    let output = run(&[], &arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    if error.contains("GPU adapter") {
        eprintln!("SKIPPED: info --gpu needs a Vulkan or Metal device (mesa-vulkan-drivers)");
        return;
    }
    assert!(output.status.success(), "{error}");
    let info: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(info["usable"], true);
    let checks = info["checks"].as_array().unwrap();
    let names: Vec<_> = checks.iter().map(|c| c["checked"].as_str().unwrap()).collect();
    let expected =
        ["still", "moving", "masked", "half_harmonics", "byte_harmonics", "half_network"];
    assert_eq!(names, expected);
    for check in checks {
        assert_eq!(check["passed"], true, "{check}");
        assert!(check["milliseconds"].as_f64().unwrap() > 0.0, "{check}");
    }
    // 867 splats: poses of 48 bytes twice, the image of 1920 × 1080 pixels of 16 bytes, and more.
    assert!(info["scene"]["memory_bytes"].as_u64().unwrap() > 867 * 96 + 1920 * 1080 * 16);
    assert!(info["scene"]["variants"].as_array().unwrap().len() == 4);
}

#[test]
fn without_json_the_figures_are_lines_for_people() {
    let folder = tempfile::tempdir().unwrap();
    let text = succeed(&arguments!["info", thinned_scene(folder.path())]);
    assert!(text.starts_with("splats        867\n"), "{text}");
    assert!(text.contains("monkey head") && text.contains("deformation"), "{text}");
}
