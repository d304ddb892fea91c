//! COLMAP reconstructions in both encodings, written as COLMAP's documentation describes them.

use std::path::Path;

use glam::{DMat4, DQuat, DVec3};
use trapeze_formats::dataset::{
    Dataset, DatasetFormat, DatasetOptions, Distortion, load_dataset, load_image,
};

use crate::written::{names, refusal, write_dynamic, write_image, write_text};

/// Number, name and parameters of each model that can be read; images are 40 × 30.
const MODELS: [(u32, &str, &[f64]); 6] = [
    (0, "SIMPLE_PINHOLE", &[50.0, 20.5, 15.25]),
    (1, "PINHOLE", &[50.0, 51.0, 20.5, 15.25]),
    (2, "SIMPLE_RADIAL", &[50.0, 20.5, 15.25, 0.2]),
    (3, "RADIAL", &[50.0, 20.5, 15.25, 0.2, -0.1]),
    (4, "OPENCV", &[50.0, 51.0, 20.5, 15.25, 0.2, -0.1, 0.001, 0.002]),
    (5, "OPENCV_FISHEYE", &[50.0, 51.0, 20.5, 15.25, 0.2, -0.1, 0.003, 0.004]),
];

const POINTS: [([f64; 3], [u8; 3]); 2] =
    [([1.0, 2.0, 3.0], [10, 20, 30]), ([-0.5, 0.25, 1e3], [255, 0, 7])];

/// Image `i` uses camera `i + 1`; listed in the file in reverse name order.
fn pose(index: usize) -> (DQuat, DVec3) {
    let turn = index as f64;
    let rotation = DQuat::from_euler(glam::EulerRot::XYZ, 0.1 * turn, 0.2, -0.3 * turn);
    (rotation, DVec3::new(turn, -2.0, 0.5 * turn))
}

fn image_name(index: usize) -> String {
    format!("left camera/{index:02}.png")
}

fn write_binary(folder: &Path) {
    let mut cameras = (MODELS.len() as u64).to_le_bytes().to_vec();
    let mut images = (MODELS.len() as u64).to_le_bytes().to_vec();
    for (index, (id, _, parameters)) in MODELS.iter().enumerate().rev() {
        cameras.extend((index as u32 + 1).to_le_bytes());
        cameras.extend(id.to_le_bytes());
        cameras.extend(40u64.to_le_bytes());
        cameras.extend(30u64.to_le_bytes());
        cameras.extend(parameters.iter().flat_map(|p| p.to_le_bytes()));

        let (q, t) = pose(index);
        images.extend((index as u32 + 7).to_le_bytes());
        images.extend([q.w, q.x, q.y, q.z, t.x, t.y, t.z].iter().flat_map(|v| v.to_le_bytes()));
        images.extend((index as u32 + 1).to_le_bytes());
        images.extend(image_name(index).bytes().chain([0]));
        images.extend(2u64.to_le_bytes());
        images.extend([0xab; 48]);
    }
    let mut points = (POINTS.len() as u64).to_le_bytes().to_vec();
    for (position, color) in POINTS {
        points.extend(99u64.to_le_bytes());
        points.extend(position.iter().flat_map(|v| v.to_le_bytes()));
        points.extend(color);
        points.extend(0.5f64.to_le_bytes());
        points.extend(3u64.to_le_bytes());
        points.extend([0xcd; 24]);
    }
    std::fs::create_dir_all(folder).unwrap();
    for (name, bytes) in [("cameras", cameras), ("images", images), ("points3D", points)] {
        std::fs::write(folder.join(format!("{name}.bin")), bytes).unwrap();
    }
}

fn write_text_model(folder: &Path) {
    let join = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let mut cameras = "# Camera list\n".to_owned();
    let mut images = "# Image list\n\n".to_owned();
    for (index, (_, name, parameters)) in MODELS.iter().enumerate().rev() {
        cameras += &format!("{} {name} 40 30 {}\n", index + 1, join(parameters));
        let (q, t) = pose(index);
        let pose = join(&[q.w, q.x, q.y, q.z, t.x, t.y, t.z]);
        images += &format!("{} {pose} {} {}\n", index + 7, index + 1, image_name(index));
        // Every other image has no 2-D points: its second line is empty.
        images += if index % 2 == 0 { "\n" } else { "1.5 2.5 -1 3.5 4.5 99\n" };
    }
    let mut points = "# 3D point list\r\n".to_owned();
    for (position, [r, g, b]) in POINTS {
        points += &format!("99 {} {r} {g} {b} 0.5 7 0 8 1\r\n", join(&position));
    }
    write_text(&folder.join("cameras.txt"), &cameras);
    write_text(&folder.join("images.txt"), &images);
    write_text(&folder.join("points3D.txt"), &points);
}

fn write_images(root: &Path) {
    for index in 0..MODELS.len() {
        write_image(&root.join("images").join(image_name(index)), 40, 30, index as u8);
    }
}

fn assert_is_the_written_model(dataset: &Dataset) {
    assert_eq!(dataset.format, DatasetFormat::Colmap);
    assert_eq!(dataset.warnings, [""; 0]);
    let expected: Vec<_> = (0..MODELS.len()).map(image_name).collect();
    assert_eq!(names(dataset), expected);
    for (index, view) in dataset.views.iter().enumerate() {
        let (_, name, parameters) = MODELS[index];
        let camera = &view.camera;
        let fy = if parameters[1] == 51.0 { 51.0 } else { 50.0 };
        assert_eq!([camera.fx, camera.fy, camera.cx, camera.cy], [50.0, fy, 20.5, 15.25], "{name}");
        assert_eq!((camera.width, camera.height), (40, 30));
        let (rotation, translation) = pose(index);
        let expected = DMat4::from_rotation_translation(rotation, translation);
        assert!(camera.world_to_camera.abs_diff_eq(expected, 1e-12), "{name}");
        let perspective = |radial, tangential| Distortion::Perspective { radial, tangential };
        let distortion = match name {
            "SIMPLE_RADIAL" => perspective([0.2, 0.0, 0.0], [0.0; 2]),
            "RADIAL" => perspective([0.2, -0.1, 0.0], [0.0; 2]),
            "OPENCV" => perspective([0.2, -0.1, 0.0], [0.001, 0.002]),
            "OPENCV_FISHEYE" => Distortion::Fisheye { radial: [0.2, -0.1, 0.003, 0.004] },
            _ => Distortion::None,
        };
        assert_eq!(view.distortion, distortion, "{name}");
    }
    let points = dataset.points.as_ref().unwrap();
    assert_eq!(points.positions, POINTS.map(|(position, _)| position.map(|v| v as f32)));
    assert_eq!(points.colors, POINTS.map(|(_, color)| color));
}

#[test]
fn every_camera_model_is_read_from_both_encodings_and_all_folders() {
    for writer in [write_binary, write_text_model] {
        for model in ["sparse/0", "sparse", "colmap/sparse/0", ""] {
            let root = tempfile::tempdir().unwrap();
            writer(&root.path().join(model));
            write_images(root.path());
            assert_is_the_written_model(
                &load_dataset(root.path(), &DatasetOptions::default()).unwrap(),
            );
        }
    }
}

#[test]
fn every_kth_view_in_name_order_is_held_out() {
    let root = tempfile::tempdir().unwrap();
    write_binary(&root.path().join("sparse/0"));
    write_images(root.path());
    let held_out = |holdout| {
        let options = DatasetOptions { holdout, ..DatasetOptions::default() };
        let dataset = load_dataset(root.path(), &options).unwrap();
        (dataset.test_views().collect::<Vec<_>>(), dataset.training_views().count())
    };
    assert_eq!(held_out(Some(4)), (vec![0, 4], 4));
    assert_eq!(held_out(Some(8)), (vec![0], 5));
    assert_eq!(held_out(None), (vec![], 6));
    assert_eq!(held_out(Some(0)), (vec![], 6));
}

#[test]
fn ignoring_distortion_leaves_the_photographs_as_they_are() {
    let root = tempfile::tempdir().unwrap();
    write_binary(&root.path().join("sparse/0"));
    write_images(root.path());
    let options = DatasetOptions { ignore_distortion: true, ..DatasetOptions::default() };
    let ignoring = load_dataset(root.path(), &options).unwrap();
    let removing = load_dataset(root.path(), &DatasetOptions::default()).unwrap();
    for (index, (raw, straight)) in ignoring.views.iter().zip(&removing.views).enumerate() {
        assert_eq!(raw.distortion, Distortion::None);
        assert_eq!(raw.camera, straight.camera);
        let same = load_image(raw).unwrap() == load_image(straight).unwrap();
        assert_eq!(same, index < 2, "only pinholes have nothing to remove: {}", raw.name);
    }
}

#[test]
fn reduced_folders_rescale_the_camera_to_the_images_true_size_along_each_axis() {
    let root = tempfile::tempdir().unwrap();
    write_binary(&root.path().join("sparse/0"));
    for index in 0..MODELS.len() {
        // Half of 40 × 30, with a row lost to rounding.
        write_image(&root.path().join("images_2").join(image_name(index)), 20, 14, 0);
    }
    let dataset = load_dataset(root.path(), &DatasetOptions::default()).unwrap();
    let camera = &dataset.views[1].camera;
    assert_eq!((camera.width, camera.height), (20, 14));
    assert_eq!((camera.fx, camera.cx), (25.0, 10.25));
    assert!((camera.fy - 51.0 * 14.0 / 30.0).abs() < 1e-12);
    assert!((camera.cy - 15.25 * 14.0 / 30.0).abs() < 1e-12);

    let options = DatasetOptions { downscale: Some(4), ..DatasetOptions::default() };
    let dataset = load_dataset(root.path(), &options).unwrap();
    let camera = &dataset.views[1].camera;
    assert_eq!((camera.width, camera.height, camera.fx), (10, 7, 12.5));
    for view in &dataset.views {
        let image = load_image(view).unwrap();
        assert_eq!((image.width, image.height), (10, 7));
    }
}

#[test]
fn masks_are_matched_and_weigh_the_pixels() {
    let root = tempfile::tempdir().unwrap();
    write_binary(&root.path().join("sparse/0"));
    write_images(root.path());
    let left_half = image::GrayImage::from_fn(40, 30, |x, _| image::Luma([u8::from(x < 20) * 255]));
    for index in 0..MODELS.len() {
        // COLMAP's way: the extension is appended to the whole name.
        let name = format!("masks/{}.png", image_name(index));
        write_dynamic(&root.path().join(name), &left_half.clone().into());
    }
    let options = DatasetOptions { mask_folder: Some("masks".into()), ..DatasetOptions::default() };
    let dataset = load_dataset(root.path(), &options).unwrap();
    let image = load_image(&dataset.views[0]).unwrap();
    assert_eq!((image.weight(0), image.weight(19), image.weight(20)), (1.0, 1.0, 0.0));

    std::fs::remove_file(root.path().join("masks/left camera/03.png.png")).unwrap();
    let message = refusal(root.path(), &options);
    assert!(message.contains("mask of left camera/03.png: expected a file"), "{message}");
}

#[test]
fn missing_and_unreadable_images_are_named() {
    let root = tempfile::tempdir().unwrap();
    write_binary(&root.path().join("sparse/0"));
    write_images(root.path());
    let image = root.path().join("images/left camera/02.png");
    std::fs::remove_file(&image).unwrap();
    let message = refusal(root.path(), &DatasetOptions::default());
    assert!(
        message.contains("image left camera/02.png: expected a file of that name"),
        "{message}"
    );
    std::fs::write(&image, b"not an image").unwrap();
    let message = refusal(root.path(), &DatasetOptions::default());
    assert!(message.contains("02.png: image: expected a readable PNG"), "{message}");
}

#[test]
fn other_camera_models_and_unknown_cameras_are_refused_by_name() {
    let root = tempfile::tempdir().unwrap();
    write_text_model(&root.path().join("sparse"));
    write_images(root.path());
    let path = root.path().join("sparse/cameras.txt");
    let good = std::fs::read_to_string(&path).unwrap();
    for (from, to, expected) in [
        (" PINHOLE", " FULL_OPENCV", "camera model: expected SIMPLE_PINHOLE, PINHOLE"),
        (" PINHOLE", " FULL_OPENCV", "found FULL_OPENCV"),
        ("2 PINHOLE", "9 PINHOLE", "camera of image left camera/01.png: expected an id"),
        ("40 30 50 51 20.5 15.25\n", "40 30 50 51 20.5\n", "camera parameters: expected 4 numbers"),
        ("40 30 50 51 20.5 15.25\n", "40 30 0 51 20.5 15.25\n", "camera fx: expected a positive"),
        (
            "40 30 50 51 20.5 15.25\n",
            "40 -30 50 51 20.5 15.25\n",
            "camera height: expected a number",
        ),
        ("40 30 50 51 20.5 15.25\n", "0 30 50 51 20.5 15.25\n", "camera size: expected"),
    ] {
        assert!(good.contains(from));
        std::fs::write(&path, good.replacen(from, to, 1)).unwrap();
        let message = refusal(root.path(), &DatasetOptions::default());
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn geographic_coordinates_are_recentred_without_moving_the_cameras() {
    let root = tempfile::tempdir().unwrap();
    write_text(&root.path().join("sparse/cameras.txt"), "1 PINHOLE 40 30 50 50 20 15\n");
    // Looking along +z from (500 000.25, 4 600 000.5, 10).
    let image = "1 1 0 0 0 -500000.25 -4600000.5 -10 1 a.png\n\n";
    write_text(&root.path().join("sparse/images.txt"), image);
    let points = "1 500000.75 4600000.125 12 1 2 3 0\n2 500001.75 4600001.125 12 1 2 3 0\n";
    write_text(&root.path().join("sparse/points3D.txt"), points);
    write_image(&root.path().join("images/a.png"), 40, 30, 0);
    let dataset = load_dataset(root.path(), &DatasetOptions::default()).unwrap();
    let point = DVec3::from(dataset.points.as_ref().unwrap().positions[0].map(f64::from));
    assert_eq!(point + dataset.origin, DVec3::new(500_000.75, 4_600_000.125, 12.0));
    assert!(point.length() < 20.0, "{point}");
    let expected = DVec3::new(0.5, -0.375, 2.0);
    let seen = dataset.local_camera(0).world_to_camera.transform_point3(point);
    assert!((seen - expected).length() < 1e-9, "{seen}");
    assert_eq!(dataset.views[0].camera.centre(), DVec3::new(500_000.25, 4_600_000.5, 10.0));
}
