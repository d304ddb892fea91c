#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // Any multiple of 32 bytes is a file; whatever it holds must be a scene that fits together.
    if let Ok(scene) = trapeze_formats::splat_file::parse_splat_file(bytes) {
        scene.validate().unwrap();
    }
});
