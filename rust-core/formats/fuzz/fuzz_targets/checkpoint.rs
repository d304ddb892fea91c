#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = trapeze_formats::parse_deform_pth(bytes);
    let _ = trapeze_formats::parse_clusters_pt(bytes);
});
