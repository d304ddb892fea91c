#![no_main]

use trapeze_formats::parse_mask_bin;
use trapeze_scene::Clusters;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let clusters = Clusters::from_ids(&[4, 4, 9, 9, 9, 4], &[[0.0; 3]; 6]).unwrap();
    if let Ok(values) = parse_mask_bin(bytes, 6, Some(&clusters)) {
        assert!(values.len() == 6 && !values.iter().any(|&value| value < 0.0));
    }
});
