//! `trapeze convert`: filters, formats, baking.

mod support;

use std::path::{Path, PathBuf};

use support::{differing, json, load, raw, succeed, thinned_scene};
use trapeze_scene::{Scene, ShDegree, sigmoid};

/// Converts with these options into a folder beside the scene, and loads the result: loading
/// refuses parts that do not fit the splats.
fn converted(scene: &Path, options: &[&str]) -> (PathBuf, Scene) {
    let out = scene.with_file_name("converted");
    let mut arguments = arguments!["convert", scene, &out].to_vec();
    arguments.extend(options.iter().map(Into::into));
    succeed(&arguments);
    let result = load(&out);
    (out, result)
}

/// A camera before the scene, in a file of this folder.
fn camera(folder: &Path) -> String {
    let path = folder.join("camera.json");
    std::fs::write(
        &path,
        r#"{"width":64,"height":48,"fx":90,"fy":90,"cx":32,"cy":24,"world_to_camera":
            [[0,1,0,0],[0.247404,0,-0.968912,0.436],[-0.968912,0,-0.247404,4.311],[0,0,0,1]]}"#,
    )
    .unwrap();
    path.to_str().unwrap().to_owned()
}

fn root_mean_square(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

/// Checks that `result` is made of the splats of `scene` that `keep` accepts by index, every part
/// with its splat.
fn expect_kept(scene: &Scene, result: &Scene, keep: impl Fn(usize) -> bool) {
    let kept: Vec<u32> = (0..scene.len() as u32).filter(|&i| keep(i as usize)).collect();
    assert!(!kept.is_empty() && kept.len() < scene.len(), "a filter that does something");
    let expected = scene.gather(&kept);
    assert_eq!(result.splats, expected.splats);
    assert_eq!(result.clusters, expected.clusters);
    assert_eq!(result.deformation, scene.deformation);
    assert_eq!(result.motion.as_ref().unwrap().values, expected.motion.unwrap().values);
}

#[test]
fn kept_and_dropped_clusters_take_their_parts_along() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    let scene = load(&path);
    let clusters = scene.clusters.clone().unwrap();
    let id = |i: usize| clusters.table[clusters.labels[i] as usize].id;
    let (out, result) = converted(&path, &["--keep-clusters", "2,4"]);
    expect_kept(&scene, &result, |i| [2, 4].contains(&id(i)));
    let info = json(&arguments!["info", out, "--json"]);
    assert_eq!(info["clusters"][0]["name"], "monkey head");
    assert_eq!(info["clusters"].as_array().unwrap().len(), 2);
    let (_, result) = converted(&path, &["--drop-clusters", "1"]);
    expect_kept(&scene, &result, |i| id(i) != 1);
}

#[test]
fn a_box_and_an_opacity_bound_what_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    let scene = load(&path);
    let inside = |i: usize| {
        let [x, y, z] = scene.splats.positions[i];
        (-1.0..=1.0).contains(&x) && (-1.0..=0.5).contains(&y) && (-0.25..=1.5).contains(&z)
    };
    let (_, result) = converted(&path, &["--crop", "-1,-1,-0.25,1,0.5,1.5"]);
    expect_kept(&scene, &result, inside);
    let opacity = |i: usize| sigmoid(f64::from(scene.splats.opacity_logits[i]));
    let (_, result) = converted(&path, &["--min-opacity", "0.5"]);
    expect_kept(&scene, &result, |i| opacity(i) >= 0.5);
    let both = ["--crop", "-1,-1,-0.25,1,0.5,1.5", "--min-opacity", "0.5"];
    let (_, result) = converted(&path, &both);
    expect_kept(&scene, &result, |i| inside(i) && opacity(i) >= 0.5);
}

#[test]
fn a_floater_leaves_and_the_rest_stays_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    let mut scene = load(&path);
    scene.splats.positions[7] = [50.0, 50.0, 50.0];
    trapeze_formats::save_scene(&path, &scene).unwrap();
    let (_, result) = converted(&path, &["--remove-floaters"]);
    let far = |p: &[f32; 3]| p[0] > 10.0;
    assert!(!result.splats.positions.iter().any(far));
    // The objects themselves are dense: few of their splats may count as floaters.
    assert!(result.len() < scene.len() && result.len() > scene.len() * 9 / 10);
    assert_eq!(result.clusters.unwrap().table.len(), 5);
    assert_eq!(result.deformation, scene.deformation);
}

#[test]
fn a_lower_sh_degree_cuts_the_bands_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    let scene = load(&path);
    let (_, result) = converted(&path, &["--sh-degree", "1"]);
    assert_eq!(result.splats, scene.splats.clone().with_sh_degree(ShDegree::One));
    assert_eq!(result.clusters, scene.clusters);
    assert_eq!(result.motion, scene.motion);
}

#[test]
fn splats_survive_every_format_that_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    let scene = load(&path);
    let plain = folder.path().join("plain.ply");
    succeed(&arguments!["convert", &path, &plain]);
    assert_eq!(load(&plain).splats, scene.splats, "PLY holds every bit");
    // Without the network; .splat has no view-dependent colour.
    // One camera for all: an orbit frames the positions and opacities as they are rounded.
    let camera = camera(folder.path());
    let (_, exact) = raw(&plain, &["--sh-degree", "0", "--camera", &camera]);
    let bounds = scene.bounds().unwrap();
    // Colour and opacity in eight bits: half a step of each, all to one side. SPZ has log-scales in
    // steps of 1/16: a width off by up to 3 % moves an alpha by 0.7 · 3 % where it moves most.
    // .splat has quaternions in steps of 1/128: up to half a degree, which is 5 % of the width
    // beside the end of a needle ten times as long as wide.
    let eight_bits = 1.0 / 255.0;
    for (name, tolerance) in [
        ("a.compressed.ply", eight_bits),
        ("a.spz", 2.0 * eight_bits),
        ("a.splat", 4.0 * eight_bits),
    ] {
        let packed = folder.path().join(name);
        let again = folder.path().join("again.ply");
        succeed(&arguments!["convert", &plain, &packed]);
        succeed(&arguments!["convert", &packed, &again]);
        let result = load(&again);
        assert_eq!(result.len(), scene.len(), "{name}");
        // The coarsest: 1/1024 of a 256-splat chunk, no larger than the scene; SPZ has 1/4096.
        let step = (bounds.max - bounds.min).max_element() / 1024.0;
        let found = result.bounds().unwrap();
        assert!((found.min - bounds.min).abs().max_element() <= step, "{name}");
        assert!((found.max - bounds.max).abs().max_element() <= step, "{name}");
        let (_, image) = raw(&again, &["--sh-degree", "0", "--camera", &camera]);
        let rms = root_mean_square(&image, &exact);
        assert!(rms < tolerance, "{name}: {rms}");
    }
    let size = std::fs::metadata(folder.path().join("a.splat")).unwrap().len();
    assert_eq!(size, 32 * scene.len() as u64);
}

#[test]
fn a_baked_moment_looks_like_the_moment_and_moves_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    let (out, baked) = converted(&path, &["--time", "0.5"]);
    assert!(baked.deformation.is_none() && baked.motion.is_none());
    assert_eq!(baked.clusters, load(&path).clusters);
    for part in ["weights.bin", "mask.bin", "mask.json"] {
        assert!(!out.join(part).exists(), "{part}");
    }
    // One camera for both: an orbit frames the canonical positions of the one and the moved ones
    // of the other.
    let camera = camera(folder.path());
    let (_, moment) = raw(&path, &["--camera", &camera, "--time", "0.5"]);
    let (_, still) = raw(&out, &["--camera", &camera]);
    // The scales went through a logarithm and back: a few units in the last place, which only
    // shows where an α is at the 1/255 that decides whether a splat is blended.
    let share = differing(&still, &moment, |_| 1e-4);
    assert!(share < 0.01, "{share} of the values differ");
    assert_eq!(still, raw(&out, &["--camera", &camera, "--time", "0.9"]).1);
}
