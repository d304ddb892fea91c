#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(scene) = trapeze_formats::ply::parse_ply(bytes) {
        scene.validate().unwrap();
    }
});
