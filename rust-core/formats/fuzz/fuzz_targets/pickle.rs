#![no_main]
//! The pickle of a checkpoint, packed after it was changed: the checksum of a zip member would
//! otherwise keep nearly every change from the machine.

use std::io::{Cursor, Write};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

libfuzzer_sys::fuzz_target!(|pickle: &[u8]| {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let ids = [3_u8, 0, 0, 0, 0, 0, 0, 0].repeat(4);
    let colors = 0.5_f32.to_le_bytes().repeat(12);
    let members = [("a/data.pkl", pickle), ("a/data/0", &ids), ("a/data/1", &colors)];
    for (name, content) in members {
        let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
        writer.start_file(name, stored).unwrap();
        writer.write_all(content).unwrap();
    }
    let archive = writer.finish().unwrap().into_inner();
    let _ = trapeze_formats::parse_deform_pth(&archive);
    let _ = trapeze_formats::parse_clusters_pt(&archive);
});
