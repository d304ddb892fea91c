#![no_main]
//! Starts from bytes that the parser takes for a compressed file, which random headers seldom are.

use trapeze_formats::ply::parse_ply;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let compressed = bytes.windows(15).any(|name| name == b"packed_position");
    let parsed = if compressed { parse_ply(bytes) } else { parse_ply(&with_header(bytes)) };
    if let Ok(scene) = parsed {
        scene.validate().unwrap();
    }
});

/// The bytes as the body of a file with counts that fit them.
fn with_header(body: &[u8]) -> Vec<u8> {
    let splats = body.len().saturating_sub(48).min(256 * 16) / 16;
    let mut file = b"ply\nformat binary_little_endian 1.0\n".to_vec();
    file.extend(format!("element chunk {}\n", splats.div_ceil(256)).bytes());
    for name in ["x", "y", "z", "scale_x", "scale_y", "scale_z"] {
        file.extend(format!("property float min_{name}\nproperty float max_{name}\n").bytes());
    }
    file.extend(format!("element vertex {splats}\n").bytes());
    for name in ["position", "rotation", "scale", "color"] {
        file.extend(format!("property uint packed_{name}\n").bytes());
    }
    file.extend(b"end_header\n");
    file.extend(body);
    file
}
