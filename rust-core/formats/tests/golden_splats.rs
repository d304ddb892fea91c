//! Real files, against what other tools decoded from them.

use std::path::PathBuf;

use trapeze_formats::ply::read_ply;
use trapeze_formats::splat_file::{read_splat_file, write_splat_file};
use trapeze_scene::{SH_C0, Scene, ShDegree, sigmoid};

/// A file of the test data; `None`, said aloud, where the data is not.
fn data(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("TRAPEZE_DATA").map(|folder| PathBuf::from(folder).join(name));
    let path = path.filter(|path| path.exists());
    if path.is_none() {
        eprintln!("SKIPPED: {name} needs TRAPEZE_DATA");
    }
    path
}

#[test]
fn the_sample_scene_loads_whole() {
    let Some(path) = data("sample-scene/point_cloud.ply") else { return };
    let scene = read_ply(&path).unwrap();
    scene.validate().unwrap();
    assert_eq!((scene.len(), scene.splats.sh_degree), (34_670, ShDegree::Three));
    let bounds = scene.bounds().unwrap();
    assert!(bounds.radius() > 0.1 && bounds.radius() < 100.0, "{bounds:?}");
}

/// guitar.ply is guitar.compressed.ply decoded by PlayCanvas's splat-transform.
#[test]
fn a_compressed_file_is_decoded_as_its_own_tool_does() {
    let Some(compressed) = data("splats/guitar.compressed.ply") else { return };
    let Some(plain) = data("splats/guitar.ply") else { return };
    let (ours, theirs) = (read_ply(&compressed).unwrap(), read_ply(&plain).unwrap());
    assert_eq!((ours.len(), theirs.len()), (90_854, 90_854));
    let (a, b) = (&ours.splats, &theirs.splats);
    // Both compute in double precision and round once: one unit in the last place of values that
    // are smaller than 16 (half of 2⁻²⁰), or an exactly equal value where it is infinite.
    let ulp = f64::exp2(-20.0);
    let close = |x: f32, y: f32| (f64::from(x) - f64::from(y)).abs() <= ulp;
    for i in 0..ours.len() {
        for axis in 0..3 {
            assert!(close(a.positions[i][axis], b.positions[i][axis]), "position {i}");
            assert!(close(a.log_scales[i][axis], b.log_scales[i][axis]), "log-scale {i}");
            assert!(close(a.sh_dc[i][axis], b.sh_dc[i][axis]), "colour {i}");
        }
        assert!((0..4).all(|k| close(a.rotations[i][k], b.rotations[i][k])), "rotation {i}");
        // Ours keeps the logit finite where the byte is 0 or 255; as an opacity it still rounds
        // to that byte.
        let (x, y) = (a.opacity_logits[i], b.opacity_logits[i]);
        let opacities = (sigmoid(f64::from(x)), sigmoid(f64::from(y)));
        assert!(x.is_finite());
        if y.is_finite() {
            assert!(close(x, y), "opacity {i}: {x} {y}");
        } else {
            assert!((opacities.0 - opacities.1).abs() < 0.5 / 255.0, "opacity {i}: {x} {y}");
        }
    }
}

#[test]
fn compressed_captures_load() {
    let Some(path) = data("splats/biker.compressed.ply") else { return };
    let scene = read_ply(&path).unwrap();
    scene.validate().unwrap();
    assert_eq!((scene.len(), scene.splats.sh_degree), (152_746, ShDegree::Zero));
    let finite = scene.splats.positions.iter().flatten().all(|c| c.is_finite());
    assert!(finite && scene.bounds().unwrap().radius() < 100.0);
}

#[test]
fn stone_has_its_harmonics() {
    let Some(path) = data("splats/stone.ply") else { return };
    let scene = read_ply(&path).unwrap();
    scene.validate().unwrap();
    assert_eq!((scene.len(), scene.splats.sh_degree), (185_761, ShDegree::Three));
    assert_eq!(scene.splats.used_sh_degree(), ShDegree::Three);
}

#[test]
fn a_splat_file_is_a_scene_of_sensible_splats_and_survives_rewriting() {
    let Some(path) = data("splats/room-interior.splat") else { return };
    let scene = read_splat_file(&path).unwrap();
    scene.validate().unwrap();
    assert_eq!(scene.len(), 124_495);
    let lengths = scene.splats.rotations.iter().map(|q| q.iter().map(|c| c * c).sum::<f32>());
    // Unit quaternions in bytes: each component is off by at most 1/128, truncation included.
    assert!(lengths.into_iter().all(|l| (l.sqrt() - 1.0).abs() < 4.0 / 128.0));
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("copy.splat");
    write_splat_file(&copy, &scene).unwrap();
    let again = read_splat_file(&copy).unwrap();
    assert_eq!(again.splats.positions, scene.splats.positions);
    assert_eq!(again.splats.opacity_logits, scene.splats.opacity_logits);
    assert_eq!(again.splats.sh_dc, scene.splats.sh_dc);
    assert_rotations_are_close(&scene, &again);
}

/// The writer normalises before it rounds, so the bytes need not be the same ones.
fn assert_rotations_are_close(a: &Scene, b: &Scene) {
    for (p, q) in a.splats.rotations.iter().zip(&b.splats.rotations) {
        let dot: f32 = p.iter().zip(q).map(|(x, y)| x * y).sum();
        let lengths: f32 = [p, q].iter().map(|v| v.iter().map(|c| c * c).sum::<f32>()).product();
        // Four components that are each off by at most 1/128: an angle below 2/128 radians.
        assert!(dot / lengths.sqrt() > 1.0 - 2.0 * (2.0 / 128.0f32).powi(2), "{p:?} {q:?}");
    }
}

#[test]
fn a_colour_of_grey_is_no_harmonic() {
    let grey = trapeze_formats::splat_file::parse_splat_file(&[128; 32]).unwrap();
    let expected = (128.0 / 255.0 - 0.5) / SH_C0;
    assert!((f64::from(grey.splats.sh_dc[0][0]) - expected).abs() < 1e-7);
    assert_eq!(grey.splats.rotations[0], [0.0; 4]);
}
