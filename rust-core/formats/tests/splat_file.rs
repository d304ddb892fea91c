//! `.splat` files: what is written comes back within the bytes' precision.

mod scenes;

use glam::DVec3;
use scenes::{numbered_features, random_scene};
use trapeze_formats::splat_file::{parse_splat_file, read_splat_file, write_splat_file};
use trapeze_scene::{SH_C0, Scene, ShDegree, sigmoid};

fn written(scene: &Scene) -> Vec<u8> {
    let file = tempfile::NamedTempFile::new().unwrap();
    write_splat_file(file.path(), scene).unwrap();
    std::fs::read(file.path()).unwrap()
}

#[test]
fn a_written_scene_comes_back_within_its_quantisation() {
    let mut scene = random_scene(3000, ShDegree::One, 1);
    scene.features = Some(numbered_features(3000, 4));
    let read = parse_splat_file(&written(&scene)).unwrap();
    let (a, b) = (&scene.splats, &read.splats);
    assert_eq!(a.positions, b.positions);
    assert!(read.features.is_none() && b.sh_degree == ShDegree::Zero, "they have no place in it");
    for i in 0..scene.len() {
        for axis in 0..3 {
            // exp and ln in single precision: a few units in the last place, of 8 at most.
            assert!((a.log_scales[i][axis] - b.log_scales[i][axis]).abs() < 4e-6);
            let color = |dc: f32| (f64::from(dc) * SH_C0 + 0.5).clamp(0.0, 1.0);
            let difference = color(a.sh_dc[i][axis]) - color(b.sh_dc[i][axis]);
            assert!(difference.abs() <= 0.5 / 255.0 + 1e-7, "colour {i}: {difference}");
        }
        let opacity = |logit: f32| sigmoid(f64::from(logit));
        let difference = opacity(a.opacity_logits[i]) - opacity(b.opacity_logits[i]);
        assert!(difference.abs() <= 0.5 / 255.0 + 1e-7, "opacity {i}: {difference}");
        let norm = a.rotations[i].iter().map(|c| c * c).sum::<f32>().sqrt();
        for k in 0..4 {
            // Half a step, or a whole one at +1, which has no byte.
            let difference = a.rotations[i][k] / norm - b.rotations[i][k];
            assert!(difference.abs() <= 1.0 / 128.0 + 1e-6, "rotation {i}: {difference}");
        }
    }
}

#[test]
fn a_file_that_ends_within_a_splat_is_refused() {
    let bytes = written(&random_scene(4, ShDegree::Zero, 2));
    for cut in 0..bytes.len() {
        match parse_splat_file(&bytes[..cut]) {
            Ok(scene) => assert_eq!(scene.len() * 32, cut),
            Err(error) => {
                let expected = format!(
                    "file size: expected a multiple of 32 bytes (one splat each), found {cut}"
                );
                assert_eq!(error.to_string(), expected);
            }
        }
    }
    let folder = tempfile::tempdir().unwrap();
    assert!(read_splat_file(folder.path()).unwrap_err().to_string().contains("found a folder"));
}

#[test]
fn values_that_are_not_finite_or_not_positive_have_bytes() {
    let mut scene = random_scene(3, ShDegree::Zero, 3);
    scene.splats.log_scales[0] = [f32::NEG_INFINITY, f32::INFINITY, 100.0];
    scene.splats.rotations = vec![[0.0; 4], [f32::NAN; 4], [-1e20, 0.0, 0.0, 0.0]];
    scene.splats.opacity_logits = vec![f32::NAN, f32::INFINITY, -1e4];
    let mut bytes = written(&scene);
    let read = parse_splat_file(&bytes).unwrap().splats;
    assert_eq!(read.log_scales[0][0], f32::NEG_INFINITY, "a scale of 0 stays a scale of 0");
    assert!(read.log_scales[0][1..].iter().all(|&s| s > 88.0 && s.is_finite()));
    let identity = [127.0 / 128.0, 0.0, 0.0, 0.0];
    assert_eq!(read.rotations, [identity, identity, [-1.0, 0.0, 0.0, 0.0]]);
    assert!(read.opacity_logits.iter().all(|l| l.is_finite()));
    bytes[12..16].copy_from_slice(&(-2.0f32).to_le_bytes());
    let mirrored = parse_splat_file(&bytes).unwrap().splats.log_scales[0][0];
    assert!((mirrored - 2f32.ln()).abs() < 1e-6, "the sign of a scale has no effect");
}

#[test]
fn far_coordinates_are_written_only_where_single_precision_holds_them() {
    let mut scene = random_scene(50, ShDegree::Zero, 4);
    for p in &mut scene.splats.positions {
        // Whole sixteenths, which single precision has up to a million.
        *p = p.map(|c| (c * 16.0).round() / 16.0);
    }
    scene.origin = DVec3::new(1e6, 0.0, 0.0);
    let read = parse_splat_file(&written(&scene)).unwrap();
    for (a, b) in scene.splats.positions.iter().zip(&read.splats.positions) {
        let world = |p: &[f32; 3], origin: DVec3| DVec3::from(p.map(f64::from)) + origin;
        assert_eq!(world(a, scene.origin), world(b, read.origin));
    }
    scene.splats.positions[49][0] = 0.3;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("far.splat");
    let error = write_splat_file(&path, &scene).unwrap_err().to_string();
    assert!(error.contains("far.splat: position: expected world coordinates"), "{error}");
    assert!(!path.exists());
}
