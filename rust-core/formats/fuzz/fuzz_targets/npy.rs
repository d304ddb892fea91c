#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(array) = trapeze_formats::parse_npy(bytes) {
        assert_eq!(array.shape.iter().product::<usize>(), array.values.len());
    }
});
