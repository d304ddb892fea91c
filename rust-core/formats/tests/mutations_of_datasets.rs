//! Broken dataset files: a dataset or a one-line error, nothing else.
//!
//! The parsers are reached the way a user reaches them: the broken file is put into an otherwise
//! good dataset, and the dataset is loaded.

mod support;

use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageFormat, RgbImage, RgbaImage};
use support::mutate_and_parse;
use trapeze_formats::ReadError;
use trapeze_formats::dataset::{DatasetFormat, DatasetOptions, load_dataset, load_image};

const RUNS: usize = 2500;

const CAMERAS_TEXT: &str = "# cameras\n1 OPENCV 8 6 9 9 4 3 0.01 0.02 0.001 0.002\n\
                            2 SIMPLE_RADIAL 8 6 9 4 3 0.01\n";
const IMAGES_TEXT: &str =
    "1 1 0 0 0 1 2 3 1 a.png\n1.5 2.5 -1 3 4 7\n2 0.6 0.8 0 0 1 2 3 2 b.png\n\n";
const POINTS_TEXT: &str = "1 1.5 2.5 -3e2 10 20 30 0.5 1 0 2 1\n2 0 0 0 1 2 3 0.5\n";
const TRANSFORMS: &str = r#"{"camera_angle_x": 0.8, "camera_model": "OPENCV_FISHEYE", "k1": 0.01,
  "frames": [
    {"file_path": "images/a", "time": 0.5, "mask_path": "images/b.png",
     "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]},
    {"file_path": "./images/b.png", "w": 8, "h": 6, "fl_x": 9.5, "cy": 3,
     "transform_matrix": [[0,-1,0,0],[1,0,0,0],[0,0,1,4]]}],
  "train_filenames": ["images/b.png"], "test_filenames": ["images/a"]}"#;
const POLYCAM: &str = r#"{"fx": 9, "fy": 9, "cx": 4, "cy": 3, "width": 8, "height": 6,
  "t_00": 1, "t_01": 0, "t_02": 0, "t_03": 1, "t_10": 0, "t_11": 1, "t_12": 0, "t_13": 2,
  "t_20": 0, "t_21": 0, "t_22": 1, "t_23": 3}"#;
const RECORD3D: &str = r#"{"K": [9, 0, 0, 0, 9, 0, 4, 3, 1], "w": 8, "h": 6,
  "poses": [[0, 0, 0, 1, 1, 2, 3], [0, 0.6, 0, 0.8, 1, 2, 3]]}"#;

fn cameras_binary() -> Vec<u8> {
    let mut file = 2u64.to_le_bytes().to_vec();
    for (id, model, parameters) in [
        (1u32, 4u32, &[9.0f64, 9.0, 4.0, 3.0, 0.01, 0.02, 0.001, 0.002][..]),
        (2, 2, &[9.0, 4.0, 3.0, 0.01]),
    ] {
        file.extend([id, model].iter().flat_map(|v| v.to_le_bytes()));
        file.extend([8u64, 6].iter().flat_map(|v| v.to_le_bytes()));
        file.extend(parameters.iter().flat_map(|v| v.to_le_bytes()));
    }
    file
}

fn images_binary() -> Vec<u8> {
    let mut file = 2u64.to_le_bytes().to_vec();
    for (id, name) in [(1u32, b"a.png\0"), (2, b"b.png\0")] {
        file.extend(id.to_le_bytes());
        file.extend([0.6f64, 0.8, 0.0, 0.0, 1.0, 2.0, 3.0].iter().flat_map(|v| v.to_le_bytes()));
        file.extend(id.to_le_bytes());
        file.extend(name);
        file.extend(2u64.to_le_bytes());
        file.extend([1; 48]);
    }
    file
}

fn points_binary() -> Vec<u8> {
    let mut file = 2u64.to_le_bytes().to_vec();
    for id in 0..2u64 {
        file.extend(id.to_le_bytes());
        file.extend([1.5f64, -2.5, 300.0].iter().flat_map(|v| v.to_le_bytes()));
        file.extend([1, 2, 3]);
        file.extend(0.5f64.to_le_bytes());
        file.extend(id.to_le_bytes());
        file.extend(vec![1; 8 * id as usize]);
    }
    file
}

fn poses_bounds() -> Vec<u8> {
    let row = [0., 1., 0., 1., 6., 1., 0., 0., 2., 8., 0., 0., -1., 3., 9., 0.5, 20.0f64];
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 17), }";
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend(118u16.to_le_bytes());
    file.extend(format!("{header:<117}\n").bytes());
    file.extend(row.iter().chain(&row).flat_map(|v| v.to_le_bytes()));
    file
}

fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn png() -> Vec<u8> {
    let rgba = |x: u32, y: u32| image::Rgba([x as u8 * 30, y as u8 * 40, 7, 255 - x as u8]);
    encoded(RgbaImage::from_fn(8, 6, rgba), ImageFormat::Png)
}

fn jpeg() -> Vec<u8> {
    let rgb = |x: u32, y: u32| image::Rgb([(x * 30) as u8, (y * 40) as u8, 7]);
    encoded(RgbImage::from_fn(8, 6, rgb), ImageFormat::Jpeg)
}

/// A good dataset of every layout in one folder.
fn write_all(root: &Path) {
    for (path, bytes) in [
        ("images/a.png", &png()[..]),
        ("images/b.png", &png()),
        ("binary/images/a.png", &png()),
        ("binary/images/b.png", &jpeg()),
        ("binary/cameras.bin", &cameras_binary()),
        ("binary/images.bin", &images_binary()),
        ("binary/points3D.bin", &points_binary()),
        ("cameras.txt", CAMERAS_TEXT.as_bytes()),
        ("images.txt", IMAGES_TEXT.as_bytes()),
        ("points3D.txt", POINTS_TEXT.as_bytes()),
        ("poses_bounds.npy", &poses_bounds()),
        ("transforms.json", TRANSFORMS.as_bytes()),
        ("keyframes/cameras/a.json", POLYCAM.as_bytes()),
        ("keyframes/images/a.png", &png()),
        ("metadata.json", RECORD3D.as_bytes()),
        ("rgb/0.png", &png()),
        ("rgb/1.png", &png()),
    ] {
        std::fs::create_dir_all(root.join(path).parent().unwrap()).unwrap();
        std::fs::write(root.join(path), bytes).unwrap();
    }
}

fn load_all(root: &Path, format: DatasetFormat) -> Result<(), ReadError> {
    let options = DatasetOptions { format: Some(format), ..DatasetOptions::default() };
    let dataset = load_dataset(root, &options)?;
    for (index, view) in dataset.views.iter().enumerate() {
        view.camera.validate().unwrap();
        // The points were recentred for single precision, so the cameras must be finite there too.
        assert!(dataset.local_camera(index).world_to_camera.is_finite());
        let image = load_image(view)?;
        assert_eq!([image.width, image.height], [view.camera.width, view.camera.height]);
        assert_eq!(image.values.len(), image.pixel_count() * usize::from(image.channels));
        assert!(image.weights.is_none_or(|w| w.len() == (image.width * image.height) as usize));
    }
    Ok(())
}

/// Mutates one file of the dataset, and cuts it at every byte.
///
/// `needs_all` says that no part of the file is a file of its own, so that every cut is an error.
fn check(file: &str, corpus: Vec<u8>, format: DatasetFormat, needs_all: bool) {
    let folder = tempfile::tempdir().unwrap();
    write_all(folder.path());
    let root = if file.starts_with("binary/") {
        folder.path().join("binary")
    } else {
        folder.path().to_path_buf()
    };
    let path = folder.path().join(file);
    let parse = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        load_all(&root, format)
    };
    for length in 0..corpus.len() {
        match parse(&corpus[..length]) {
            Ok(()) => assert!(!needs_all, "{file} was accepted with {length} bytes"),
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
    mutate_and_parse(&file.replace('/', "-"), &[corpus], RUNS, parse);
}

#[test]
fn broken_colmap_models_are_datasets_or_errors() {
    let colmap = DatasetFormat::Colmap;
    check("binary/cameras.bin", cameras_binary(), colmap, true);
    check("binary/images.bin", images_binary(), colmap, true);
    check("binary/points3D.bin", points_binary(), colmap, true);
    // Text may lose its last digits and still be numbers.
    check("cameras.txt", CAMERAS_TEXT.into(), colmap, false);
    check("images.txt", IMAGES_TEXT.into(), colmap, false);
    check("points3D.txt", POINTS_TEXT.into(), colmap, false);
}

#[test]
fn broken_pose_files_are_datasets_or_errors() {
    check("poses_bounds.npy", poses_bounds(), DatasetFormat::Llff, true);
    check("transforms.json", TRANSFORMS.into(), DatasetFormat::Transforms, true);
    check("keyframes/cameras/a.json", POLYCAM.into(), DatasetFormat::Polycam, true);
    check("metadata.json", RECORD3D.into(), DatasetFormat::Record3d, true);
}

#[test]
fn broken_images_are_images_or_errors() {
    // The last bytes of a PNG are an empty end chunk, without which decoders are content.
    check("images/a.png", png(), DatasetFormat::Colmap, false);
    check("binary/images/b.png", jpeg(), DatasetFormat::Colmap, false);
}
