#![no_main]
//! Files as they are, and what is not compressed as the content of a gzip stream: a random change
//! behind the checksum would never get past it.

use std::io::Write;

use flate2::{Compression, write::GzEncoder};
use trapeze_formats::spz::parse_spz;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let is_file = bytes.starts_with(&[0x1f, 0x8b]) || bytes.get(4) == Some(&4);
    let parsed = if is_file { parse_spz(bytes) } else { parse_spz(&gzip(bytes)) };
    if let Ok(scene) = parsed {
        scene.validate().unwrap();
    }
});

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::none());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}
