#![no_main]
//! One file of a dataset is the input, the others are good. The parsers are reached through the
//! folder, as by a user; on a temporary file system that costs some ten microseconds a run.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use trapeze_formats::dataset::{DatasetFormat, DatasetOptions, load_dataset, load_image};

/// What the input stands for, by its first byte. COLMAP's binary files win over its text files.
const FILES: [(&str, DatasetFormat); 11] = [
    ("cameras.bin", DatasetFormat::Colmap),
    ("images.bin", DatasetFormat::Colmap),
    ("points3D.bin", DatasetFormat::Colmap),
    ("cameras.txt", DatasetFormat::Colmap),
    ("images.txt", DatasetFormat::Colmap),
    ("points3D.txt", DatasetFormat::Colmap),
    ("images/a.png", DatasetFormat::Colmap),
    ("poses_bounds.npy", DatasetFormat::Llff),
    ("transforms.json", DatasetFormat::Transforms),
    ("keyframes/cameras/a.json", DatasetFormat::Polycam),
    ("metadata.json", DatasetFormat::Record3d),
];

/// One white pixel.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0:~\x9bU\
                     \0\0\0\nIDATx\x9cc\xf8\x0f\0\x01\x01\x01\0\xb18\xf6\x14\
                     \0\0\0\0IEND\xaeB`\x82";

/// One folder for each file, with everything that a dataset of any layout needs beside it.
static FOLDERS: LazyLock<Vec<PathBuf>> = LazyLock::new(|| {
    let base = std::env::temp_dir().join(format!("trapeze-fuzz-{}", std::process::id()));
    let folders: Vec<_> = (0..FILES.len()).map(|index| base.join(index.to_string())).collect();
    for folder in &folders {
        write(&folder.join("images/a.png"), PNG);
        write(&folder.join("keyframes/images/a.png"), PNG);
        write(&folder.join("rgb/0.png"), PNG);
        write(&folder.join("cameras.txt"), b"1 SIMPLE_RADIAL 1 1 1 0.5 0.5 0.01\n");
        write(&folder.join("images.txt"), b"1 1 0 0 0 0 0 0 1 a.png\n\n");
        write(&folder.join("points3D.txt"), b"1 0 0 1 9 9 9 0\n");
    }
    folders
});

fn write(path: &Path, content: &[u8]) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, content).unwrap();
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, content)) = bytes.split_first() else { return };
    let index = usize::from(choice) % FILES.len();
    let (file, format) = FILES[index];
    let folder = &FOLDERS[index];
    write(&folder.join(file), content);
    let options = DatasetOptions { format: Some(format), ..DatasetOptions::default() };
    if let Ok(dataset) = load_dataset(folder, &options) {
        for view in &dataset.views {
            view.camera.validate().unwrap();
            let _ = load_image(view);
        }
    }
});
