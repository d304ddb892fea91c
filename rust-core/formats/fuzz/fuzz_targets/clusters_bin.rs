#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(clusters) = trapeze_formats::parse_clusters_bin(bytes) {
        assert!(clusters.labels.iter().all(|&label| (label as usize) < clusters.table.len()));
    }
});
