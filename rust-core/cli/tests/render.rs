//! `trapeze render`: single images.

mod support;

use std::path::Path;

use support::{SIZE, differing, raw, succeed, thinned_scene};

const MODES: [&str; 7] =
    ["color", "depth", "depth-median", "alpha", "clusters", "cluster-id", "motion"];

/// Values that the CPU and the f64 reference may disagree on, per mode.
///
/// A single-precision network is within 2e-5 of the exact position: 1e-4 of a pixel here, and so
/// below 1/255 of a channel wherever the same splats are blended. What is more comes from an α at
/// 1/255, from two splats that change places in depth, or from another splat at the median or on
/// top: properties of single pixels, of which one in a hundred may be at such an edge.
const EDGE_PIXELS: f64 = 0.01;

fn tolerance(mode: &str) -> impl Fn(f64) -> f64 {
    let absolute = match mode {
        "color" | "alpha" | "clusters" => 1.0 / 255.0,
        // Ids and motion values are copied, not computed.
        "cluster-id" | "motion" => 0.0,
        // World units; the camera is several away.
        _ => 1e-3,
    };
    move |_| absolute
}

#[test]
fn every_mode_has_its_shape_and_the_backends_agree() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    for mode in MODES {
        let options = |backend| ["--mode", mode, "--time", "0.5", "--backend", backend];
        let (shape, cpu) = raw(&scene, &options("cpu"));
        let (reference_shape, reference) = raw(&scene, &options("reference"));
        let channels = if mode == "color" || mode == "clusters" { &[4][..] } else { &[] };
        let expected = [&[SIZE[1], SIZE[0]][..], channels].concat();
        assert_eq!(shape, expected, "{mode}");
        assert_eq!(reference_shape, expected, "{mode}");
        let share = differing(&cpu, &reference, tolerance(mode));
        assert!(share <= EDGE_PIXELS, "{mode}: {share} of the values differ");
        let something = cpu.iter().filter(|v| v.is_finite() && **v > 0.0).count();
        assert!(something > 100, "{mode}: an empty image");
    }
}

#[test]
fn every_mode_is_a_picture_of_the_asked_size() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    for mode in MODES {
        let picture = png(&scene, folder.path(), &["--mode", mode, "--size", "64x48"]);
        assert_eq!([picture.width() as usize, picture.height() as usize], SIZE, "{mode}");
        let pixels = picture.to_rgba8();
        let first = pixels.get_pixel(32, 24);
        assert!(pixels.pixels().any(|p| p != first), "{mode}: one colour");
    }
}

fn png(scene: &Path, folder: &Path, options: &[&str]) -> image::DynamicImage {
    let out = folder.join("out.png");
    let mut arguments = arguments!["render", scene, "--out", &out].to_vec();
    arguments.extend(options.iter().map(Into::into));
    succeed(&arguments);
    image::open(out).unwrap()
}

#[test]
fn the_background_is_a_colour_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let corner = |background: &str| {
        let options = ["--size", "64x48", "--background", background];
        let picture = png(&scene, folder.path(), &options);
        (picture.color().has_alpha(), picture.to_rgba8().get_pixel(0, 0).0)
    };
    assert_eq!(corner("white"), (false, [255; 4]));
    assert_eq!(corner("0,1,0"), (false, [0, 255, 0, 255]));
    assert_eq!(corner("none"), (true, [0; 4]));
}

#[test]
fn a_camera_file_says_what_is_seen_and_how_large() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let camera = folder.path().join("camera.json");
    // From four units above, looking down: x to the right, y down in the image, z ahead.
    let json = r#"{"width": 40, "height": 30, "fx": 30, "fy": 30, "cx": 20, "cy": 15,
        "world_to_camera": [[1,0,0,0],[0,-1,0,0],[0,0,-1,4],[0,0,0,1]]}"#;
    std::fs::write(&camera, json).unwrap();
    let camera = camera.to_str().unwrap();
    let picture = png(&scene, folder.path(), &["--camera", camera]);
    assert_eq!((picture.width(), picture.height()), (40, 30));
    let (shape, depth) = raw(&scene, &["--camera", camera, "--mode", "depth"]);
    assert_eq!(shape, [48, 64], "--size overrides the file");
    let hit: Vec<f64> = depth.into_iter().filter(|d| d.is_finite()).collect();
    // The objects stand on a plate at height 0 and stay below 2, under the camera at 4.
    assert!(!hit.is_empty() && hit.iter().all(|d| (2.0..5.0).contains(d)), "{hit:?}");
}

#[test]
fn clusters_are_isolated_and_hidden_by_id() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let ids = |options: &[&str]| {
        let (_, values) = raw(&scene, &[&["--mode", "cluster-id"][..], options].concat());
        let mut ids: Vec<i64> = values.iter().map(|&v| v as i64).collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    };
    assert_eq!(ids(&[]), [-1, 1, 2, 3, 4, 5]);
    assert_eq!(ids(&["--isolate", "2,5"]), [-1, 2, 5]);
    assert_eq!(ids(&["--hide", "2,5"]), [-1, 1, 3, 4]);
}

#[test]
fn splats_that_all_rest_show_the_first_moment() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let frame =
        |time: &str, options: &[&str]| raw(&scene, &[&["--time", time][..], options].concat()).1;
    let resting = frame("0.5", &["--static-percentile", "100"]);
    assert_eq!(resting, frame("0", &[]), "to the last bit: the same poses");
    let moving = frame("0.5", &[]);
    assert_ne!(resting, moving);
    let masked = frame("0.5", &["--static-percentile", "45"]);
    let error =
        |frame: &[f64]| frame.iter().zip(&moving).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    assert!(error(&masked) < error(&resting) / 10.0, "the mask leaves what moves");
}

#[test]
fn the_sh_degree_bounds_what_is_evaluated() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let (_, full) = raw(&scene, &[]);
    let (_, flat) = raw(&scene, &["--sh-degree", "0"]);
    assert_ne!(full, flat);
    let alpha = |values: &[f64]| values.iter().skip(3).step_by(4).copied().collect::<Vec<_>>();
    assert_eq!(alpha(&full), alpha(&flat), "colour has no part in coverage");
}
