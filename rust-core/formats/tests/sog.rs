//! SOG scenes: what is read and what is refused.

mod packed;

use std::fs;
use std::path::Path;

use fastrand::Rng;
use image_webp::{ColorType, WebPEncoder};
use packed::{SOG_SPLATS, SogFiles, sog_files, webp, zip};
use trapeze_formats::sog::{parse_sog_zip, read_sog, read_sog_folder};
use trapeze_scene::{ShDegree, sigmoid};

fn write_folder(files: &SogFiles, folder: &Path) {
    for (name, bytes) in &files.images {
        fs::write(folder.join(name), bytes).unwrap();
    }
    fs::write(folder.join("meta.json"), &files.meta).unwrap();
}

fn refusal(files: &SogFiles) -> String {
    let error = parse_sog_zip(&files.zip()).unwrap_err().to_string();
    assert!(!error.contains('\n'), "{error}");
    error
}

/// One splat whose pixels are given; the images have one pixel more, which is not a splat.
fn one_splat(
    version: u32,
    means: [[u8; 4]; 2],
    scales: [u8; 4],
    quat: [u8; 4],
    sh0: [u8; 4],
) -> SogFiles {
    let image = |pixel: [u8; 4]| webp(&[pixel, [0; 4]], 2);
    let mut files = sog_files(version, 1);
    let count = format!("{SOG_SPLATS}");
    files.meta = files.meta.replace(&format!("\"count\":{count}"), "\"count\":1");
    files.meta = files.meta.replace(&format!("[{count},3]"), "[1,3]");
    let [low, high] = means;
    for (name, pixel) in [
        ("means_l.webp", low),
        ("means_u.webp", high),
        ("scales.webp", scales),
        ("quats.webp", quat),
        ("sh0.webp", sh0),
    ] {
        files = files.with_image(name, &image(pixel));
    }
    files
}

#[test]
fn both_versions_decode_to_the_values_they_describe() {
    for version in [1, 2] {
        let means = [[0, 0xff, 0x34, 255], [0, 0xff, 0x12, 255]];
        let mut files =
            one_splat(version, means, [0, 255, 51, 255], [255, 0, 255, 254], [0, 255, 51, 51]);
        // Label 65 is the second entry of the second row.
        let mut palette = vec![[0; 4]; 192 * 2];
        palette[192 + 3..192 + 6].copy_from_slice(&[
            [255, 0, 51, 255],
            [0, 0, 255, 255],
            [51, 51, 51, 255],
        ]);
        files = files.with_image("shN_centroids.webp", &webp(&palette, 192));
        files =
            files.with_image("shN_labels.webp", &webp(&[[65, 0, 0, 255], [255, 255, 0, 255]], 2));
        let scene = parse_sog_zip(&files.zip()).unwrap();
        let s = &scene.splats;
        assert_eq!((s.len(), s.sh_degree), (1, ShDegree::One));
        let close = |found: &[f32], expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            for (f, e) in found.iter().zip(expected) {
                assert!(
                    (f64::from(*f) - e).abs() < 1e-6 * e.abs().max(1.0),
                    "{found:?}, {expected:?}"
                );
            }
        };
        let third: f64 = -3.0 + 6.0 * f64::from(0x1234) / 65535.0;
        close(&s.positions[0], &[-1.5_f64.exp_m1(), 2.5_f64.exp_m1(), -third.abs().exp_m1()]);
        let (scales, colors): ([f64; 3], [f64; 3]) = if version == 1 {
            ([-9.0, 0.0, -7.0 + 8.0 * 0.2], [-1.0, 2.0, -3.0 + 6.0 * 0.2])
        } else {
            ([-9.0, 1.0, -9.0 + 10.0 * 0.2], [-2.0, 2.0, -2.0 + 4.0 * 0.2])
        };
        close(&s.log_scales[0], &scales);
        close(&s.sh_dc[0], &colors);
        if version == 1 {
            close(&s.opacity_logits, &[-4.0 + 13.0 * 0.2]);
        } else {
            close(&[sigmoid(s.opacity_logits[0].into()) as f32], &[0.2]);
        }
        // Mode 254: y is largest and (w, x, z) = (√½, −√½, √½), which leaves y = 0.
        let h = f64::sqrt(0.5);
        let [w, x, y, z] = s.rotations[0];
        close(&[w, x, z], &[h, -h, h]);
        assert_eq!(y, 0.0);
        let (low, high) = (-0.5, 0.75);
        let fifth = low + (high - low) * 0.2;
        close(&s.sh_rest, &[high, low, fifth, low, low, high, fifth, fifth, fifth]);
    }
}

#[test]
fn a_folder_and_its_archive_are_the_same_scene() {
    for (version, degree) in [(1, 0), (1, 3), (2, 1), (2, 2), (2, 3)] {
        let files = sog_files(version, degree);
        let folder = tempfile::tempdir().unwrap();
        write_folder(&files, folder.path());
        let scene = read_sog_folder(folder.path()).unwrap();
        assert_eq!(scene.len(), SOG_SPLATS);
        assert_eq!(scene.splats.sh_degree as u32, degree);
        assert_eq!(scene, read_sog(&folder.path().join("meta.json")).unwrap());
        assert_eq!(scene, parse_sog_zip(&files.zip()).unwrap());
        let images = files.images.iter().map(|(name, bytes)| (*name, &bytes[..]));
        let deflated =
            zip(&images.chain([("meta.json", files.meta.as_bytes())]).collect::<Vec<_>>(), true);
        assert_eq!(scene, parse_sog_zip(&deflated).unwrap());
        let path = folder.path().join("scene.sog");
        fs::write(&path, files.zip()).unwrap();
        assert_eq!(scene, read_sog(&path).unwrap());
    }
}

#[test]
fn a_scene_far_from_zero_gets_an_origin() {
    // ln(1 + x) of 999 999 and 1 000 099: a hundred units in 65 535 steps.
    let (low, high) = (1e6_f64.ln(), 1_000_100_f64.ln());
    let files = sog_files(2, 0).with_meta("\"mins\":[-1.5", &format!("\"mins\":[{low}"));
    let files = files.with_meta("\"maxs\":[1,", &format!("\"maxs\":[{high},"));
    let scene = parse_sog_zip(&files.zip()).unwrap();
    assert!((999_999.0..=1_000_099.0).contains(&scene.origin.x), "{}", scene.origin);
    let mut last_bits = 0;
    for p in &scene.splats.positions {
        let steps = ((f64::from(p[0]) + scene.origin.x).ln_1p() - low) / (high - low) * 65535.0;
        // Within 100 units of the origin single precision resolves 2⁻¹⁷, a 200th of a step.
        assert!((steps - steps.round()).abs() < 0.01, "{steps}");
        last_bits |= steps.round() as u32 & 1;
    }
    assert_eq!(last_bits, 1, "the lowest bit of a position is there");
}

#[test]
fn the_antialias_flag_reaches_the_scene() {
    let files = sog_files(2, 0);
    assert!(!parse_sog_zip(&files.zip()).unwrap().antialiased);
    let flagged = files.with_meta("\"antialias\":false", "\"antialias\":true");
    assert!(parse_sog_zip(&flagged.zip()).unwrap().antialiased);
}

#[test]
fn descriptions_are_refused_by_field() {
    let v2 = sog_files(2, 1);
    let v1 = sog_files(1, 1);
    let cases = [
        (
            v2.with_meta("\"version\":2", "\"version\":3"),
            "version: expected 2, or none for version 1, found 3",
        ),
        (v2.with_meta("\"version\":2,", ""), "missing field"),
        (v2.with_meta("\"scales\"", "\"scale\""), "missing field `scales`"),
        (
            v2.with_meta("\"mins\":[-1.5", "\"mins\":[-100"),
            "means.mins and .maxs: expected logarithms between ±88, found -100",
        ),
        (
            v2.with_meta("\"codebook\":[", "\"codebook\":[0,"),
            "shN.codebook: expected 256 numbers, found 257 numbers",
        ),
        (
            v2.with_meta("\"codebook\":[-9,", "\"codebook\":[1e300,"),
            "scales.codebook: expected numbers that single precision holds, found 1",
        ),
        (v2.with_meta("\"bands\":1", "\"bands\":4"), "SH degree"),
        (
            v2.with_meta("\"bands\":1", "\"bands\":2"),
            "shN_centroids.webp: expected a width of 512, found 192",
        ),
        (
            v2.with_meta("\"count\":128", "\"count\":129"),
            "shN.count: expected at most the 128 of shN_centroids.webp, found 129",
        ),
        (v2.with_meta("\"count\":128", "\"count\":1"), "shN_labels.webp: label of splat "),
        (
            v2.with_meta("\"count\":250", "\"count\":257"),
            "means_l.webp: expected at least 257 pixels, one per splat, found 256",
        ),
        (
            v2.with_meta("\"count\":250", "\"count\":18446744073709551615"),
            "means_l.webp: expected at least 18446744073709551615 pixels",
        ),
        (
            v2.with_meta("\"quats.webp\"", "\"../quats.webp\""),
            "zip member ../quats.webp: expected a readable member",
        ),
        (
            v2.with_meta("\"quats.webp\"", "\"missing.webp\""),
            "zip member missing.webp: expected a readable member",
        ),
        (
            v1.with_meta("\"shape\":[250,3],", ""),
            "means.shape: expected [splats, 3], found nothing",
        ),
        (
            v1.with_meta("\"mins\":[-9,", "\"mins\":[1e39,"),
            "scales.mins and .maxs: expected numbers that single precision holds",
        ),
        (v1.with_meta("\"maxs\":0.75", "\"maxs\":-1e39"), "shN.mins and .maxs: expected numbers"),
    ];
    for (files, expected) in cases {
        let error = refusal(&files);
        assert!(error.contains(expected), "{error} instead of {expected}");
    }
}

#[test]
fn a_description_that_leads_out_of_its_folder_is_refused() {
    let outside = tempfile::tempdir().unwrap();
    let inside = outside.path().join("scene");
    fs::create_dir(&inside).unwrap();
    let files = sog_files(2, 0);
    write_folder(&files, outside.path());
    for name in ["../quats.webp", "/quats.webp", "..\\\\quats.webp", "scene/../quats.webp", ""] {
        let changed = files.with_meta("\"quats.webp\"", &format!("\"{name}\""));
        write_folder(&changed, &inside);
        let error = read_sog_folder(&inside).unwrap_err().to_string();
        assert!(error.contains("files: expected a plain file name, found "), "{error}");
    }
}

#[test]
fn images_that_are_not_what_they_should_be_are_refused_by_name() {
    let files = sog_files(2, 1);
    let mut pixels = vec![[0, 0, 0, 255]; 256];
    pixels[7][3] = 251;
    let error = refusal(&files.with_image("quats.webp", &webp(&pixels, 16)));
    assert_eq!(error, "quats.webp: alpha of pixel 7: expected 252 to 255, found 251");
    let error = refusal(&files.with_image("scales.webp", &webp(&pixels[..240], 16)));
    assert_eq!(error, "scales.webp: expected at least 250 pixels, one per splat, found 240");
    let error = refusal(&files.with_image("sh0.webp", b"RIFFnot a picture"));
    assert!(error.starts_with("sh0.webp: expected an intact WebP stream, found "), "{error}");
    let truncated = files.images[0].1.len() / 2;
    let error = refusal(&files.with_image("means_l.webp", &files.images[0].1[..truncated]));
    assert!(error.starts_with("means_l.webp: expected an intact WebP stream, found "), "{error}");
    // A key frame of lossy WebP: its ten-byte header of a 16 × 16 image.
    let lossy =
        [&b"RIFF\x16\0\0\0WEBPVP8 \x0a\0\0\0"[..], &[0x10, 0, 0, 0x9d, 1, 0x2a, 16, 0, 16, 0]]
            .concat();
    let error = refusal(&files.with_image("means_u.webp", &lossy));
    assert_eq!(error, "means_u.webp: expected a lossless WebP image, found lossy compression");
}

#[test]
fn an_image_without_alpha_is_opaque() {
    let mut opaque = Vec::new();
    let rgb: Vec<u8> = (0..256 * 3).map(|i| i as u8).collect();
    WebPEncoder::new(&mut opaque).encode(&rgb, 16, 16, ColorType::Rgb8).unwrap();
    let scene = parse_sog_zip(&sog_files(2, 0).with_image("sh0.webp", &opaque).zip()).unwrap();
    assert!(scene.splats.opacity_logits.iter().all(|&l| sigmoid(l.into()) > 0.999));
}

#[test]
fn image_bombs_are_refused_by_their_size_before_they_are_decoded() {
    // One colour needs no bits per pixel: a quarter of a gigapixel in some dozen bytes.
    let small = webp(&vec![[1, 2, 3, 255]; 256], 16);
    let vp8l_size = 21;
    let mut bomb = small.clone();
    let bits = 16_382_u32 | 16_382 << 14 | 1 << 28;
    bomb[vp8l_size..vp8l_size + 4].copy_from_slice(&bits.to_le_bytes());
    let files = sog_files(2, 0);
    for name in ["means_l.webp", "quats.webp", "sh0.webp"] {
        let error = refusal(&files.with_image(name, &bomb));
        assert!(error.starts_with("images: expected at most "), "{error}");
    }
    let claims = files.with_image("means_l.webp", &bomb).with_image("means_u.webp", &bomb);
    let claims = claims.with_image("scales.webp", &bomb).with_image("quats.webp", &bomb);
    let claims =
        claims.with_image("sh0.webp", &bomb).with_meta("\"count\":250", "\"count\":268402689");
    assert!(refusal(&claims).starts_with("images: expected at most "));
}

#[test]
fn zip_bombs_and_what_is_no_archive_are_refused() {
    let zeros = vec![0; 100 << 20];
    let bomb = zip(&[("meta.json", &zeros)], true);
    assert!(bomb.len() < 1 << 20);
    let error = parse_sog_zip(&bomb).unwrap_err().to_string();
    assert!(error.starts_with("zip member meta.json: expected at most "), "{error}");
    assert!(parse_sog_zip(b"").is_err());
    assert!(parse_sog_zip(b"PK\x05\x06").is_err());
}

#[test]
fn a_truncated_archive_or_image_is_refused_everywhere() {
    let files = sog_files(2, 2);
    let file = files.zip();
    let mut rng = Rng::with_seed(3);
    for length in (0..64).chain((0..100).map(|_| rng.usize(64..file.len()))).collect::<Vec<_>>() {
        let error = parse_sog_zip(&file[..length]).unwrap_err().to_string();
        assert!(error.contains(": expected ") && !error.contains('\n'), "{length}: {error}");
    }
    for (name, image) in &files.images {
        for length in
            (0..32).chain((0..14).map(|_| rng.usize(32..image.len() - 1))).collect::<Vec<_>>()
        {
            let error = refusal(&files.with_image(name, &image[..length]));
            assert!(error.starts_with(name), "{name} cut at {length}: {error}");
        }
    }
}

#[test]
fn folders_and_missing_files_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let error = read_sog(folder.path()).unwrap_err().to_string();
    assert!(error.contains("meta.json: expected a readable file, found "), "{error}");
    write_folder(&sog_files(1, 0), folder.path());
    fs::remove_file(folder.path().join("sh0.webp")).unwrap();
    let error = read_sog(folder.path()).unwrap_err().to_string();
    assert!(error.contains("sh0.webp: expected a readable file, found "), "{error}");
    fs::create_dir(folder.path().join("sh0.webp")).unwrap();
    let error = read_sog(folder.path()).unwrap_err().to_string();
    assert!(
        error.contains(
            "sh0.webp: expected a readable file, found expected a regular file, found a folder"
        ),
        "{error}"
    );
    assert!(read_sog(Path::new("/nowhere/scene.sog")).is_err());
}
