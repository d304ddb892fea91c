//! Small captures on disk.

use std::path::Path;

use image::{Rgb, RgbImage};
use trapeze_formats::dataset::{Dataset, DatasetOptions, load_dataset};

pub(super) const WIDTH: u32 = 16;
pub(super) const HEIGHT: u32 = 12;

/// The photograph of every view: a gradient with stripes, finer than a few splats can show.
fn photograph(tint: u8) -> RgbImage {
    RgbImage::from_fn(WIDTH, HEIGHT, |x, y| {
        let stripe = if x % 3 == 0 { 60 } else { 0 };
        Rgb([(x * 10) as u8 + stripe, (y * 15) as u8, tint])
    })
}

/// Writes a capture of `views` photographs into `root` and reads it; every eighth is held out.
pub(super) fn capture(root: &Path, views: u32) -> Dataset {
    std::fs::create_dir_all(root.join("images")).unwrap();
    let frames: Vec<String> = (0..views)
        .map(|i| {
            photograph(100 + i as u8).save(root.join(format!("images/{i:02}.png"))).unwrap();
            let x = f64::from(i) * 0.1;
            format!(
                r#"{{"file_path": "images/{i:02}.png",
                    "transform_matrix": [[1,0,0,{x}],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}}"#
            )
        })
        .collect();
    let text = format!(r#"{{"fl_x": 20.0, "frames": [{}]}}"#, frames.join(","));
    std::fs::write(root.join("transforms.json"), text).unwrap();
    load_dataset(root, &DatasetOptions::default()).unwrap()
}
