#![no_main]
//! Archives as they are, and other bytes as the files of an archive, each behind its length in two
//! bytes: a random change of an archived file would never get past its checksum.

use std::io::{Cursor, Write};

use trapeze_formats::sog::parse_sog_zip;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const NAMES: [&str; 8] = [
    "meta.json",
    "means_l.webp",
    "means_u.webp",
    "scales.webp",
    "quats.webp",
    "sh0.webp",
    "shN_centroids.webp",
    "shN_labels.webp",
];

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let is_archive = bytes.starts_with(b"PK");
    let parsed = if is_archive { parse_sog_zip(bytes) } else { parse_sog_zip(&archive(bytes)) };
    if let Ok(scene) = parsed {
        scene.validate().unwrap();
    }
});

fn archive(mut bytes: &[u8]) -> Vec<u8> {
    let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for name in NAMES {
        let Some((length, rest)) = bytes.split_first_chunk() else { break };
        let length = usize::from(u16::from_le_bytes(*length)).min(rest.len());
        let (content, rest) = rest.split_at(length);
        writer.start_file(name, options).unwrap();
        writer.write_all(content).unwrap();
        bytes = rest;
    }
    writer.finish().unwrap().into_inner()
}
