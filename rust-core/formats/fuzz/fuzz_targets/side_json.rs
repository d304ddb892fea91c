#![no_main]

use trapeze_formats::{parse_camera, parse_cluster_names, parse_mask_json, parse_views};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = parse_cluster_names(bytes);
    let _ = parse_mask_json(bytes);
    if let Ok(camera) = parse_camera(bytes) {
        camera.validate().unwrap();
    }
    if let Ok(views) = parse_views(bytes) {
        views.iter().for_each(|view| view.camera.validate().unwrap());
    }
});
