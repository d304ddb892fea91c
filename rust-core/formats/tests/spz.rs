//! SPZ files: what is read, what is refused and what a round trip keeps.

mod packed;
#[allow(dead_code, reason = "shared by all test binaries")]
mod scenes;

use std::path::Path;

use fastrand::Rng;
use glam::DVec3;
use packed::{gzip, spz_header, spz_payload, spz_v4};
use trapeze_formats::spz::{SpzOptions, SpzVersion, parse_spz, read_spz, write_spz};
use trapeze_scene::{Scene, ShDegree, Splats, sigmoid};

const VERSIONS: [SpzVersion; 2] = [SpzVersion::V3, SpzVersion::V4];

/// Random splats within the ranges of the format.
fn random_scene(count: usize, degree: ShDegree) -> Scene {
    let mut scene = scenes::random_scene(count, degree, 1);
    // The highest coefficient is 127/128.
    scene.splats.sh_rest.iter_mut().for_each(|c| *c *= 0.99);
    scene
}

fn written(scene: &Scene, options: SpzOptions) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.spz");
    write_spz(&path, scene, &options).unwrap();
    std::fs::read(path).unwrap()
}

fn assert_within(found: &[f32], expected: &[f32], bound: f32, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (i, (f, e)) in found.iter().zip(expected).enumerate() {
        assert!((f - e).abs() <= bound, "{what} {i}: {f} is not within {bound} of {e}");
    }
}

/// cos of half the angle between two rotations.
fn rotation_agreement(a: [f32; 4], b: [f32; 4]) -> f64 {
    let [a, b] = [a, b].map(|q| glam::DVec4::from(q.map(f64::from)).normalize());
    a.dot(b).abs()
}

#[test]
fn a_round_trip_stays_within_half_a_quantisation_step() {
    for degree in ShDegree::ALL {
        let scene = random_scene(500, degree);
        for version in VERSIONS {
            let found =
                parse_spz(&written(&scene, SpzOptions { version, sh_bits: [8; 2] })).unwrap();
            assert_eq!(found.origin, DVec3::ZERO);
            let (f, e) = (&found.splats, &scene.splats);
            assert_eq!(f.sh_degree, degree);
            // Half of 2⁻²⁰: coordinates up to 5 fit 20 fractional bits, and are exact in f32.
            let flat = |v: &[[f32; 3]]| v.as_flattened().to_vec();
            assert_within(&flat(&f.positions), &flat(&e.positions), f32::exp2(-21.0), "position");
            // Half of 1/16, 1/(0.15·255) and 1/128, and a rounding of the values themselves.
            assert_within(&flat(&f.log_scales), &flat(&e.log_scales), 0.5 / 16.0 + 1e-6, "scale");
            assert_within(&flat(&f.sh_dc), &flat(&e.sh_dc), 0.5 / 38.25 + 1e-6, "colour");
            assert_within(&f.sh_rest, &e.sh_rest, 0.5 / 128.0 + 1e-6, "SH");
            let opacity =
                |l: &[f32]| l.iter().map(|&x| sigmoid(x.into()) as f32).collect::<Vec<_>>();
            let (fo, eo) = (opacity(&f.opacity_logits), opacity(&e.opacity_logits));
            assert_within(&fo, &eo, 0.5 / 255.0 + 1e-6, "opacity");
            // Half a step of √½/511 in three components: the chord is at most √(3·3·3 + 3)·e for
            // the worst largest component (error 3e), and cos = 1 − chord²/2.
            let step = f64::sqrt(0.5) / 511.0 / 2.0;
            let least = 1.0 - 12.0 * step * step / 2.0 - 1e-9;
            for (f, e) in f.rotations.iter().zip(&e.rotations) {
                assert!(rotation_agreement(*f, *e) >= least, "{e:?} became {f:?}");
            }
        }
    }
}

#[test]
fn a_second_round_trip_changes_nothing() {
    for degree in ShDegree::ALL {
        for version in VERSIONS {
            let options = SpzOptions { version, ..SpzOptions::default() };
            let once = parse_spz(&written(&random_scene(300, degree), options)).unwrap();
            let twice = parse_spz(&written(&once, options)).unwrap();
            // Rotations are normalised again, which may move a component by an ulp or a step.
            let rotations = once.splats.rotations.iter().zip(&twice.splats.rotations);
            for (a, b) in rotations {
                assert!(rotation_agreement(*a, *b) > 1.0 - 1e-5);
            }
            let without = |s: &Scene| Splats { rotations: Vec::new(), ..s.splats.clone() };
            assert_eq!(without(&once), without(&twice));
        }
    }
}

#[test]
fn fewer_sh_bits_round_to_the_nearest_kept_value_and_keep_zero() {
    let mut scene = random_scene(200, ShDegree::Three);
    scene.splats.sh_rest[..45].fill(0.0);
    let options = SpzOptions { version: SpzVersion::V3, sh_bits: [5, 4] };
    let found = parse_spz(&written(&scene, options)).unwrap();
    assert!(found.splats.sh_rest[..45].iter().all(|&c| c == 0.0));
    for (i, (f, e)) in found.splats.sh_rest.iter().zip(&scene.splats.sh_rest).enumerate() {
        // A step is 8/128 in band 1 and 16/128 above. The highest kept value is a step below the
        // range's end, so coefficients near +1 are cut to 255/128 − 1.
        let step = if i % 45 < 9 { 8.0 / 128.0 } else { 16.0 / 128.0 };
        assert!((f - e).abs() <= step / 2.0 + 1e-6, "coefficient {i}: {e} became {f}");
    }
}

#[test]
fn the_antialiased_flag_survives_both_ways() {
    for version in VERSIONS {
        let scene = Scene { antialiased: true, ..random_scene(3, ShDegree::Zero) };
        let options = SpzOptions { version, ..SpzOptions::default() };
        assert!(parse_spz(&written(&scene, options)).unwrap().antialiased);
    }
    for (version, flags) in [(2, 0), (2, 1), (3, 1)] {
        let scene = parse_spz(&gzip(&spz_payload(version, 3, 1, flags))).unwrap();
        assert_eq!(scene.antialiased, flags == 1);
    }
}

#[test]
fn values_are_decoded_and_axes_turned_in_every_version() {
    for version in [2, 3, 4] {
        let mut payload = spz_header(version, 1, 1, 0);
        // 1.5, −0.25 and 2⁻¹² in fixed point with 12 fractional bits.
        for fixed in [6144_i32, -1024, 1] {
            payload.extend(&fixed.to_le_bytes()[..3]);
        }
        payload.push(51);
        payload.extend([255, 0, 128]);
        payload.extend([160, 0, 255]);
        match version {
            2 => payload.extend([255, 127, 128]),
            // Largest is x (index 0), y = 0, z = −√½, w = √½: then x = 0.
            _ => payload.extend((((512 + 511) << 10) | 511_u32).to_le_bytes()),
        }
        payload.extend([0, 128, 255, 192, 192, 192, 64, 64, 64]);
        let file = if version == 4 { spz_v4(&payload, 1, 1) } else { gzip(&payload) };
        let s = parse_spz(&file).unwrap().splats;
        assert_eq!(s.positions, [[1.5, 0.25, -f32::exp2(-12.0)]]);
        assert_within(&[sigmoid(s.opacity_logits[0].into()) as f32], &[0.2], 1e-6, "opacity");
        let color = |byte: f32| (byte / 255.0 - 0.5) / 0.15;
        assert_within(&s.sh_dc[0], &[255.0, 0.0, 128.0].map(color), 1e-6, "colour");
        assert_eq!(s.log_scales, [[0.0, -10.0, 5.9375]]);
        let [w, x, y, z] = s.rotations[0];
        if version == 2 {
            assert_within(&[w, x, y, z], &[0.0, 1.0, 1.0 / 255.0, -1.0 / 255.0], 1e-6, "rotation");
        } else {
            let h = f32::sqrt(0.5);
            assert_within(&[w, x, y, z], &[h, 0.0, 0.0, h], 1e-3, "rotation");
        }
        // Coefficients of band 1 go with y, z and x: the first two change sign.
        let (a, b, c) = ([1.0, 0.0, -127.0 / 128.0], [-0.5; 3], [-0.5; 3]);
        assert_eq!(s.sh_rest, [a, b, c].concat());
    }
}

#[test]
fn degree_four_is_cut_to_three() {
    for version in [3, 4] {
        let payload = spz_payload(version, 4, 4, 0);
        let file = if version == 4 { spz_v4(&payload, 4, 4) } else { gzip(&payload) };
        let splats = parse_spz(&file).unwrap().splats;
        assert_eq!(splats.sh_degree, ShDegree::Three);
        // Blue of the last coefficient of band 3 (odd in x only: its sign stays) of splat 1.
        let sh = 16 + 4 * 20;
        let byte = payload[sh + 72 + 44];
        assert_eq!(splats.sh_rest_of(1)[44], (f32::from(byte) - 128.0) / 128.0);
    }
}

#[test]
fn a_scene_without_splats_is_written_and_read() {
    for version in VERSIONS {
        let options = SpzOptions { version, ..SpzOptions::default() };
        let scene = parse_spz(&written(&Scene::default(), options)).unwrap();
        assert!(scene.is_empty());
    }
}

#[test]
fn splats_that_are_not_drawn_are_written_invisible_and_the_rest_is_clamped() {
    let mut scene = random_scene(6, ShDegree::One);
    let s = &mut scene.splats;
    s.opacity_logits.fill(3.0);
    s.positions[0][1] = f32::NAN;
    s.log_scales[1][0] = f32::INFINITY;
    s.rotations[2][3] = f32::NAN;
    s.log_scales[3] = [f32::NEG_INFINITY, 40.0, -40.0];
    s.sh_dc[3] = [f32::NAN, 100.0, -100.0];
    s.sh_rest[27] = f32::NAN;
    s.sh_rest[28] = 9.0;
    s.rotations[4] = [0.0; 4];
    let found = parse_spz(&written(&scene, SpzOptions::default())).unwrap().splats;
    for i in 0..6 {
        let visible = sigmoid(found.opacity_logits[i].into()) > 1.0 / 255.0;
        assert_eq!(visible, i > 1, "splat {i}");
    }
    assert_eq!(found.log_scales[3], [-10.0, 5.9375, -10.0]);
    assert_within(&found.sh_dc[3][1..], &[127.5 / 38.25, -127.5 / 38.25], 1e-5, "colour");
    // The first coefficient of band 1 goes with y: file value −1, the end of the range.
    assert_eq!(found.sh_rest[27..29], [0.0, 1.0]);
    // A rotation that is none is drawn as none.
    assert_eq!([found.rotations[2], found.rotations[4]], [[1.0, 0.0, 0.0, 0.0]; 2]);
}

#[test]
fn coordinates_take_the_finest_fixed_point_they_fit() {
    let mut scene = random_scene(2, ShDegree::Zero);
    for (largest, step) in [(1e-3, 20), (7.9, 20), (8.1, 19), (1000.0, 13), (8e6, 0)] {
        scene.splats.positions[1] = [largest, -largest, 1.0];
        let found = parse_spz(&written(&scene, SpzOptions::default())).unwrap();
        let world = DVec3::from(found.splats.positions[1].map(f64::from)) + found.origin;
        let bound = f64::exp2(-f64::from(step + 1)) + f64::from(largest) * 1e-7;
        assert!((world.x - f64::from(largest)).abs() <= bound, "{largest} became {world}");
    }
    scene.splats.positions[1][2] = 8.4e6;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("far.spz");
    let error = write_spz(&path, &scene, &SpzOptions::default()).unwrap_err().to_string();
    assert!(error.contains("far.spz: positions: expected coordinates below 8388608"), "{error}");
    assert!(!path.exists());
}

#[test]
fn a_scene_with_an_origin_is_written_in_world_coordinates_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.spz");
    let near = Scene { origin: DVec3::new(5000.0, 0.0, 0.0), ..random_scene(9, ShDegree::Zero) };
    write_spz(&path, &near, &SpzOptions::default()).unwrap();
    let found = read_spz(&path).unwrap();
    for (f, e) in found.splats.positions.iter().zip(&near.splats.positions) {
        let difference = f64::from(f[0]) + found.origin.x - f64::from(e[0]) - near.origin.x;
        // Half of 2⁻¹⁰, the finest step with 5007 · 2ᵇ < 2²³.
        assert!(difference.abs() <= f64::exp2(-11.0), "{difference}");
    }
    let far = Scene { origin: DVec3::new(5e5, 4.6e6, 0.0), ..near };
    let error = write_spz(&path, &far, &SpzOptions::default()).unwrap_err().to_string();
    assert!(error.contains("positions: expected coordinates below 8192"), "{error}");
}

#[test]
fn a_truncated_file_is_refused_at_every_byte_of_its_header_and_anywhere_in_its_body() {
    let mut rng = Rng::with_seed(1);
    for version in [2, 3, 4] {
        let payload = spz_payload(version, 200, 2, 1);
        let file = if version == 4 { spz_v4(&payload, 200, 2) } else { gzip(&payload) };
        parse_spz(&file).unwrap();
        let header = 32 + 6 * 16;
        let body = (0..100).map(|_| rng.usize(header..file.len()));
        for length in (0..header).chain(body).collect::<Vec<_>>() {
            let error = parse_spz(&file[..length]).unwrap_err().to_string();
            assert!(!error.contains('\n') && error.contains(": expected "), "{length}: {error}");
        }
        if version < 4 {
            let body = (0..100).map(|_| rng.usize(16..payload.len()));
            for length in (0..16).chain(body).collect::<Vec<_>>() {
                let error = parse_spz(&gzip(&payload[..length])).unwrap_err().to_string();
                assert!(error.contains("(file truncated?)"), "{length}: {error}");
            }
        }
    }
}

#[test]
fn every_field_of_a_header_is_refused_by_name() {
    let cases: [(usize, u8, &str); 6] = [
        (0, b'X', "magic: expected \"NGSP\" (SPZ), found 0x50534758"),
        (4, 1, "version: expected 2 or 3, found 1"),
        (4, 9, "version: expected 2 or 3, found 9"),
        (12, 5, "shDegree: expected 0 to 4, found 5"),
        (13, 31, "fractionalBits: expected 0 to 30, found 31"),
        (14, 0x80, "flags: expected antialiased (0x1) and extensions (0x2) only, found 0x80"),
    ];
    for (offset, byte, expected) in cases {
        let mut payload = spz_payload(3, 5, 1, 0);
        payload[offset] = byte;
        assert_eq!(parse_spz(&gzip(&payload)).unwrap_err().to_string(), expected);
        if offset > 4 {
            payload[4] = 4;
            let error = parse_spz(&spz_v4(&payload, 5, 1)).unwrap_err().to_string();
            assert_eq!(error, expected);
        }
    }
    let error = parse_spz(b"ply\nformat").unwrap_err().to_string();
    assert_eq!(
        error,
        "magic: expected 1f 8b (gzip) or \"NGSP\" (SPZ version 4), found [70, 6c, 79, 0a]"
    );
    assert!(parse_spz(&[]).is_err());
}

#[test]
fn the_table_of_contents_must_match_the_header() {
    let file = spz_v4(&spz_payload(4, 50, 1, 0), 50, 1);
    parse_spz(&file).unwrap();
    let error = |offset: usize, byte: u8| {
        let mut changed = file.clone();
        changed[offset] = byte;
        parse_spz(&changed).unwrap_err().to_string()
    };
    assert_eq!(error(15, 5), "numStreams: expected 6, found 5");
    assert_eq!(error(16, 31), "tocByteOffset: expected at least 32, found 31");
    assert_eq!(error(40, 0), "positions: uncompressed size: expected 450, found 256");
    assert!(error(39, 0xff).starts_with("positions: expected 18"), "{}", error(39, 0xff));
    let longer = [&file[..], b"more"].concat();
    let error = parse_spz(&longer).unwrap_err().to_string();
    assert_eq!(error, "end of the last stream: expected end of file, found 4 more bytes");
}

#[test]
fn more_or_other_bytes_than_the_header_promises_are_refused() {
    let mut payload = spz_payload(3, 20, 1, 0);
    let file = gzip(&payload);
    let error = parse_spz(&[&file[..], b"x"].concat()).unwrap_err().to_string();
    assert!(error.starts_with("end of the gzip stream: "), "{error}");
    payload.push(0);
    let error = parse_spz(&gzip(&payload)).unwrap_err().to_string();
    assert!(error.starts_with("end of the splats: "), "{error}");
    let mut damaged = file.clone();
    let checksum = damaged.len() - 8;
    damaged[checksum] ^= 1;
    let error = parse_spz(&damaged).unwrap_err().to_string();
    assert!(error.contains("an intact gzip stream"), "{error}");
}

#[test]
fn bombs_are_refused_before_they_are_unpacked() {
    // Forty megabytes of zeros in forty kilobytes: the streams are there, the file is no capture.
    let splats = 2_000_000;
    let mut bomb = spz_header(3, splats, 0, 0);
    let file = gzip(&{
        bomb.resize(16 + splats as usize * 20, 0);
        bomb
    });
    let error = parse_spz(&file).unwrap_err().to_string();
    assert!(error.starts_with("numPoints: expected at most "), "{error}");
    for splats in [u32::MAX, 1 << 31] {
        let error = parse_spz(&gzip(&spz_header(2, splats, 3, 0))).unwrap_err().to_string();
        assert!(error.starts_with("numPoints: expected at most "), "{error}");
    }
    // A stream that unpacks to more than the table of contents says.
    let mut payload = spz_payload(4, 10, 0, 0);
    payload.resize(payload.len() + (50 << 20), 0);
    let mut file = spz_v4(&payload, 10, 0);
    let uncompressed = 32 + 4 * 16 + 8;
    file[uncompressed..uncompressed + 8].copy_from_slice(&40_u64.to_le_bytes());
    let error = parse_spz(&file).unwrap_err().to_string();
    assert_eq!(error, "rotations: expected end of data, found more bytes");
}

#[test]
fn extensions_are_read_behind_the_splats_and_before_the_table() {
    let axes = |system: u32| [0xadbe_0003_u32, 4, system].map(u32::to_le_bytes).concat();
    for (system, sign) in [(4, -1.0), (6, 1.0)] {
        let mut payload = spz_payload(3, 1, 0, 2);
        payload[16..25].copy_from_slice(&[0, 16, 0, 0, 16, 0, 0, 16, 0]);
        payload.extend(axes(system));
        let scene = parse_spz(&gzip(&payload)).unwrap();
        assert_eq!(scene.splats.positions, [[1.0, sign, sign]]);
    }
    let mut payload = spz_payload(3, 1, 0, 2);
    payload.extend(axes(11));
    let error = parse_spz(&gzip(&payload)).unwrap_err().to_string();
    assert_eq!(error, "extension coordinate_system: expected 0 to 8, found 11");

    let mut file = spz_v4(&spz_payload(4, 1, 0, 2), 1, 0);
    file[16..20].copy_from_slice(&(32_u32 + 12).to_le_bytes());
    file.splice(32..32, axes(11));
    let error = parse_spz(&file).unwrap_err().to_string();
    assert_eq!(error, "extension coordinate_system: expected 0 to 8, found 11");
}

#[test]
fn a_folder_instead_of_a_file_is_refused_by_path() {
    let folder = tempfile::tempdir().unwrap();
    let error = read_spz(folder.path()).unwrap_err().to_string();
    assert!(error.starts_with(&folder.path().display().to_string()), "{error}");
    assert!(read_spz(Path::new("/nowhere/at/all.spz")).is_err());
}
