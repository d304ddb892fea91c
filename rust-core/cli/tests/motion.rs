//! `trapeze motion`.

mod support;

use support::{json, load, refusal, succeed, thinned_scene};

#[test]
fn measured_motion_is_written_with_its_recommendation() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    for part in ["mask.bin", "mask.json"] {
        std::fs::remove_file(path.join(part)).unwrap();
    }
    assert!(load(&path).motion.is_none());
    let report = json(&arguments!["motion", &path, "--write", "--json", "--size", "32x24"]);
    let scene = load(&path);
    let motion = scene.motion.as_ref().unwrap();
    assert_eq!(motion.values.len(), scene.len());
    assert_eq!(report["splats"], scene.len());
    let recommended = motion.recommended_percentile.unwrap();
    assert_eq!(report["recommended_percentile"], f64::from(recommended));
    let mask = std::fs::metadata(path.join("mask.bin")).unwrap();
    assert_eq!(mask.len(), 4 * scene.len() as u64);

    let shares = report["shares"].as_array().unwrap();
    let mut previous = scene.len() as u64;
    for share in shares {
        let dynamic = share["dynamic_splats"].as_u64().unwrap();
        assert!(dynamic <= previous, "{share}");
        previous = dynamic;
        let percentile = share["static_percentile"].as_f64().unwrap() as f32;
        let threshold = motion.threshold_at_percentile(percentile);
        assert_eq!(dynamic as usize, motion.dynamic_indices(threshold).len());
        // A speed is never shown without its error.
        assert!(share["speed_up"].as_f64().unwrap() > 0.0);
        assert!(share["worst_max"].as_f64().unwrap() >= 0.0);
        let psnr = share["worst_psnr"].as_f64();
        if percentile <= recommended {
            assert!(psnr.is_none_or(|psnr| psnr >= report["min_psnr"].as_f64().unwrap()));
        }
    }
}

#[test]
fn the_original_measure_finds_the_values_of_the_original_app() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    let theirs = load(&path).motion.unwrap().values;
    let options = ["--original-measure", "--write", "--size", "8x8"];
    let mut arguments = arguments!["motion", &path].to_vec();
    arguments.extend(options.map(Into::into));
    let text = succeed(&arguments);
    assert!(text.contains("recommended: "), "{text}");
    let ours = load(&path).motion.unwrap().values;
    for (ours, theirs) in ours.iter().zip(&theirs) {
        // Two f32 networks, each within 2e-5 of the exact displacement, at two times.
        assert!((ours - theirs).abs() < 8e-5, "{ours} {theirs}");
    }
}

#[test]
fn what_cannot_move_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    let message = refusal(&arguments!["motion", path.join("point_cloud.ply")]);
    assert_eq!(message, "SCENE: expected a scene with a deformation network, found none");
}
