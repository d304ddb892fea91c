//! Broken SPZ and SOG files: a scene or a one-line error, nothing else. What a checksum would
//! catch is also broken behind it: payloads, descriptions and images are mutated first and
//! compressed afterwards.

mod packed;
mod support;

use packed::{gzip, sog_files, spz_payload, spz_v4, zip};
use support::mutate_and_parse;
use trapeze_formats::sog::parse_sog_zip;
use trapeze_formats::spz::parse_spz;

const RUNS: usize = 2000;

/// Payloads of small files: plain, antialiased, and with extension records at the end.
fn payloads(version: u32) -> Vec<Vec<u8>> {
    let mut extended = spz_payload(version, 4, 0, 2);
    extended
        .extend([0xadbe_0003_u32, 4, 6, 0xadbe_0002, 12, 0, 0, 0].map(u32::to_le_bytes).concat());
    let mut corpus = vec![
        spz_payload(version, 0, 0, 0),
        spz_payload(version, 7, 0, 1),
        spz_payload(version, 30, 3, 0),
        spz_payload(version, 3, 4, 0),
    ];
    if version < 4 {
        corpus.push(extended);
    }
    corpus
}

#[test]
fn mutated_gzip_spz_files_are_scenes_or_errors() {
    for (version, name) in [(2, "spz v2"), (3, "spz v3")] {
        let payloads = payloads(version);
        let files: Vec<_> = payloads.iter().map(|payload| gzip(payload)).collect();
        mutate_and_parse(name, &files, RUNS, parse_spz);
        let name = format!("{name} before gzip");
        mutate_and_parse(&name, &payloads, RUNS, |payload| parse_spz(&gzip(payload)));
    }
}

#[test]
fn mutated_zstd_spz_files_are_scenes_or_errors() {
    let mut with_extensions = spz_v4(&spz_payload(4, 9, 2, 2), 9, 2);
    with_extensions[16..20].copy_from_slice(&44_u32.to_le_bytes());
    with_extensions.splice(32..32, [0xadbe_0003_u32, 4, 6].map(u32::to_le_bytes).concat());
    let files = [
        spz_v4(&spz_payload(4, 7, 0, 1), 7, 0),
        spz_v4(&spz_payload(4, 30, 3, 0), 30, 3),
        spz_v4(&[&spz_payload(4, 2000, 1, 0)[..16], &[7; 2000 * 29]].concat(), 2000, 1),
        with_extensions,
    ];
    mutate_and_parse("spz v4", &files, 2 * RUNS, parse_spz);
    let payload = spz_payload(4, 30, 3, 0);
    mutate_and_parse("spz v4 before zstd", &[payload], RUNS, |p| parse_spz(&spz_v4(p, 30, 3)));
}

#[test]
fn mutated_sog_archives_are_scenes_or_errors() {
    let mut files: Vec<_> =
        [(1, 0), (1, 1), (2, 0), (2, 2)].map(|(v, degree)| sog_files(v, degree).zip()).to_vec();
    let scene = sog_files(2, 0);
    let images = scene.images.iter().map(|(name, bytes)| (*name, &bytes[..]));
    let entries: Vec<_> = images.chain([("meta.json", scene.meta.as_bytes())]).collect();
    files.push(zip(&entries, true));
    mutate_and_parse("sog", &files, RUNS, parse_sog_zip);
}

#[test]
fn mutated_sog_descriptions_are_scenes_or_errors() {
    for (version, degree) in [(1, 1), (2, 1)] {
        let files = sog_files(version, degree);
        let with_meta = |meta: &[u8]| {
            let images = files.images.iter().map(|(name, bytes)| (*name, &bytes[..]));
            parse_sog_zip(&zip(&images.chain([("meta.json", meta)]).collect::<Vec<_>>(), false))
        };
        let name = format!("meta.json of sog v{version}");
        mutate_and_parse(&name, &[files.meta.clone().into_bytes()], RUNS, with_meta);
    }
}

#[test]
fn mutated_sog_images_are_scenes_or_errors() {
    let files = sog_files(2, 1);
    for (name, image) in &files.images {
        let with_image = |bytes: &[u8]| parse_sog_zip(&files.with_image(name, bytes).zip());
        mutate_and_parse(name, std::slice::from_ref(image), RUNS / 4, with_image);
    }
}
