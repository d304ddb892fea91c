//! Dataset files that the tests write, and the errors that they expect.

use std::path::Path;

use image::{DynamicImage, Rgb, RgbImage};
use trapeze_formats::dataset::{Dataset, DatasetOptions, load_dataset};

/// A small image whose colour says which one it is.
pub(crate) fn write_image(path: &Path, width: u32, height: u32, tint: u8) {
    let pixel = |x: u32, y: u32| Rgb([tint, (x * 255 / width) as u8, (y * 255 / height) as u8]);
    write_dynamic(path, &RgbImage::from_fn(width, height, pixel).into());
}

pub(crate) fn write_dynamic(path: &Path, image: &DynamicImage) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    image.save(path).unwrap();
}

pub(crate) fn write_text(path: &Path, text: &str) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

/// The one-line message with which a dataset is refused.
pub(crate) fn refusal(path: &Path, options: &DatasetOptions) -> String {
    let message = load_dataset(path, options).unwrap_err().to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

pub(crate) fn names(dataset: &Dataset) -> Vec<&str> {
    dataset.views.iter().map(|view| view.name.as_str()).collect()
}

/// The folder of captures that cannot be committed.
pub(crate) fn test_data() -> Option<std::path::PathBuf> {
    let folder = std::env::var_os("TRAPEZE_DATA").map(std::path::PathBuf::from);
    let folder = folder.filter(|folder| folder.is_dir());
    if folder.is_none() {
        eprintln!("SKIPPED: this test needs TRAPEZE_DATA, the folder of test captures");
    }
    folder
}
