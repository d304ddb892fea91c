//! Captured SPZ and SOG files against the same splats in PLY files of other programs.

use std::path::{Path, PathBuf};
use std::time::Instant;

use trapeze_formats::ply::read_ply;
use trapeze_formats::sog::{parse_sog_zip, read_sog, read_sog_folder};
use trapeze_formats::spz::read_spz;
use trapeze_scene::{Scene, ShDegree, sigmoid};

fn splats_folder() -> Option<PathBuf> {
    let folder = std::env::var_os("TRAPEZE_DATA").map(|f| Path::new(&f).join("splats"));
    let folder = folder.filter(|f| f.is_dir());
    if folder.is_none() {
        eprintln!("SKIPPED: comparison with captured files needs TRAPEZE_DATA");
    }
    folder
}

/// Checks two lists of numbers against a bound that may depend on the expected value.
fn assert_close(what: &str, found: &[f32], expected: &[f32], bound: impl Fn(f32) -> f32) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (i, (&f, &e)) in found.iter().zip(expected).enumerate() {
        assert!((f - e).abs() <= bound(e), "{what} {i}: {f} is not within {} of {e}", bound(e));
    }
}

fn world(scene: &Scene) -> Vec<f32> {
    assert_eq!(scene.origin, glam::DVec3::ZERO, "the captures are near the coordinate zero");
    scene.splats.positions.as_flattened().to_vec()
}

/// cos of half the largest angle between the rotations of two scenes.
fn worst_rotation_agreement(a: &Scene, b: &Scene) -> f64 {
    let unit = |q: &[f32; 4]| glam::DVec4::from(q.map(f64::from)).normalize();
    let pairs = a.splats.rotations.iter().zip(&b.splats.rotations);
    pairs.map(|(a, b)| unit(a).dot(unit(b)).abs()).fold(1.0, f64::min)
}

#[test]
fn an_spz_v4_capture_is_its_compressed_ply_within_half_a_step() {
    let Some(folder) = splats_folder() else { return };
    let start = Instant::now();
    let spz = read_spz(&folder.join("biker.spz")).unwrap();
    println!("biker.spz: {} splats in {:.1?}", spz.len(), start.elapsed());
    let ply = read_ply(&folder.join("biker.compressed.ply")).unwrap();
    // The SPZ file was made from the compressed PLY: what differs is half a step of SPZ's
    // quantisation and the rounding of the PLY's values to single precision (below 1e-6).
    assert_close("position", &world(&spz), &world(&ply), |_| f32::exp2(-13.0) + 1e-6);
    let (s, p) = (&spz.splats, &ply.splats);
    let clamped: Vec<f32> =
        p.log_scales.as_flattened().iter().map(|x| x.clamp(-10.0, 5.9375)).collect();
    assert_close("log-scale", s.log_scales.as_flattened(), &clamped, |_| 0.5 / 16.0 + 1e-6);
    let color_step = 1.0 / (0.15 * 255.0);
    let (sc, pc) = (s.sh_dc.as_flattened(), p.sh_dc.as_flattened());
    assert_close("colour", sc, pc, |_| color_step / 2.0 + 1e-5);
    // Both files keep the opacity in a byte, and it is the same byte.
    let byte = |logits: &[f32]| -> Vec<f32> {
        logits.iter().map(|&l| (sigmoid(l.into()) * 255.0).round() as f32).collect()
    };
    assert_close("opacity", &byte(&s.opacity_logits), &byte(&p.opacity_logits), |_| 0.0);
    // Half a step of √½/511 in three components, and three such errors in the largest.
    let step = f64::sqrt(0.5) / 511.0 / 2.0;
    assert!(worst_rotation_agreement(&spz, &ply) > 1.0 - 6.0 * step * step - 1e-9);
    assert_eq!(s.sh_degree, ShDegree::Zero);
}

#[test]
fn a_sog_v1_capture_is_the_ply_that_another_program_decoded_from_it() {
    let Some(folder) = splats_folder() else { return };
    let start = Instant::now();
    let sog = read_sog_folder(&folder.join("stone-sog-v1")).unwrap();
    println!("stone-sog-v1: {} splats in {:.1?}", sog.len(), start.elapsed());
    let ply = read_ply(&folder.join("stone.ply")).unwrap();
    // Both decode in double precision and round once: one unit in the last place between them.
    let ulp = |x: f32| x.abs() * f32::EPSILON + f32::MIN_POSITIVE;
    assert_close("position", &world(&sog), &world(&ply), ulp);
    let (s, p) = (&sog.splats, &ply.splats);
    assert_close("log-scale", s.log_scales.as_flattened(), p.log_scales.as_flattened(), ulp);
    assert_close("colour", s.sh_dc.as_flattened(), p.sh_dc.as_flattened(), ulp);
    assert_close("opacity logit", &s.opacity_logits, &p.opacity_logits, ulp);
    assert_eq!(s.sh_degree, ShDegree::Three);
    assert_close("SH", &s.sh_rest, &p.sh_rest, ulp);
    assert_close("rotation", s.rotations.as_flattened(), p.rotations.as_flattened(), ulp);
}

#[test]
fn captures_of_every_kind_are_read_as_described() {
    let Some(folder) = splats_folder() else { return };
    let cases = [
        ("logo-sog-v1", 307_128, ShDegree::Zero),
        ("playbot-8k-sog", 8_406, ShDegree::Two),
        ("monkey-frame.sog", 31_658, ShDegree::Zero),
    ];
    for (name, splats, degree) in cases {
        let start = Instant::now();
        let scene = read_sog(&folder.join(name)).unwrap();
        println!("{name}: {} splats in {:.1?}", scene.len(), start.elapsed());
        assert_eq!((scene.len(), scene.splats.sh_degree), (splats, degree), "{name}");
        scene.validate().unwrap();
        for q in scene.splats.rotations.iter().step_by(97) {
            let length = q.iter().map(|x| x * x).sum::<f32>().sqrt();
            assert!((length - 1.0).abs() < 1e-5, "{name}: {q:?}");
        }
    }
    let described = read_sog(&folder.join("playbot-8k-sog/meta.json")).unwrap();
    assert_eq!(described, read_sog_folder(&folder.join("playbot-8k-sog")).unwrap());
    let zipped = std::fs::read(folder.join("monkey-frame.sog")).unwrap();
    assert_eq!(
        parse_sog_zip(&zipped).unwrap(),
        read_sog(&folder.join("monkey-frame.sog")).unwrap()
    );
}
