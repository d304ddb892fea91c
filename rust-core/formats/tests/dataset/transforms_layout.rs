//! `transforms*.json` files as Blender, Nerfstudio, Instant-NGP and NeRFCapture write them.

use std::path::Path;

use glam::{DMat4, DVec3, DVec4};
use trapeze_formats::dataset::{
    DatasetFormat, DatasetOptions, Distortion, Split, load_dataset, load_image,
};

use crate::written::{names, refusal, write_dynamic, write_image, write_text};

/// At (0, 0, 4), looking along −Z with +Y up: OpenGL's default orientation.
const POSE: &str = "[[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]";

fn default() -> DatasetOptions {
    DatasetOptions::default()
}

fn write_split(root: &Path, name: &str, frames: &[(&str, f64)]) {
    let frames: Vec<_> = frames
        .iter()
        .map(|(path, time)| {
            format!(r#"{{"file_path":"{path}","time":{time},"transform_matrix":{POSE}}}"#)
        })
        .collect();
    let text = format!(r#"{{"camera_angle_x":1.0,"frames":[{}]}}"#, frames.join(","));
    write_text(&root.join(name), &text);
}

#[test]
fn a_blender_set_keeps_its_split_times_and_alpha() {
    let root = tempfile::tempdir().unwrap();
    write_split(
        root.path(),
        "transforms_train.json",
        &[("./train/r_10", 0.0), ("./train/r_2", 0.5)],
    );
    write_split(root.path(), "transforms_val.json", &[("./val/r_0", 0.25)]);
    write_split(root.path(), "transforms_test.json", &[("./test/r_0", 1.0)]);
    let half = image::RgbaImage::from_pixel(8, 6, image::Rgba([200, 100, 50, 128]));
    for name in ["train/r_10.png", "train/r_2.png", "test/r_0.png"] {
        write_dynamic(&root.path().join(name), &half.clone().into());
    }
    let dataset = load_dataset(root.path(), &default()).unwrap();
    assert_eq!(dataset.format, DatasetFormat::Transforms);
    // The files' own order; validation views are not read when there are test views.
    assert_eq!(names(&dataset), ["train/r_10", "train/r_2", "test/r_0"]);
    assert_eq!(dataset.test_views().collect::<Vec<_>>(), [2]);
    assert_eq!(
        dataset.views.iter().map(|v| v.time).collect::<Vec<_>>(),
        [Some(0.0), Some(0.5), Some(1.0)]
    );
    let view = &dataset.views[0];
    let focal = 8.0 / (2.0 * 0.5f64.tan());
    assert!((view.camera.fx - focal).abs() < 1e-12 && (view.camera.fy - focal).abs() < 1e-12);
    assert_eq!((view.camera.cx, view.camera.cy), (4.0, 3.0));
    let image = load_image(view).unwrap();
    assert!(image.has_alpha());
    assert_eq!(image.rgba(0), [200.0 / 255.0, 100.0 / 255.0, 50.0 / 255.0, 128.0 / 255.0]);
}

#[test]
fn opengl_poses_become_opencv_cameras() {
    let root = tempfile::tempdir().unwrap();
    write_split(root.path(), "transforms_train.json", &[("train/a", 0.0)]);
    write_image(&root.path().join("train/a.png"), 8, 8, 0);
    let dataset = load_dataset(root.path(), &default()).unwrap();
    let camera = &dataset.views[0].camera;
    assert_eq!(camera.centre(), DVec3::new(0.0, 0.0, 4.0));
    // What is above and in front of the camera has negative y and positive z.
    let seen = camera.world_to_camera * DVec4::new(0.5, 1.0, 0.0, 1.0);
    assert_eq!(seen, DVec4::new(0.5, -1.0, 4.0, 1.0));
}

#[test]
fn without_test_views_the_validation_views_or_every_kth_are_held_out() {
    let root = tempfile::tempdir().unwrap();
    write_split(root.path(), "transforms_train.json", &[("a", 0.0), ("b", 0.0)]);
    for name in ["a.png", "b.png", "c.jpg"] {
        write_image(&root.path().join(name), 8, 8, 0);
    }
    let held_out =
        || load_dataset(root.path(), &default()).unwrap().test_views().collect::<Vec<_>>();
    assert_eq!(held_out(), [0]);
    write_split(root.path(), "transforms_val.json", &[("c", 0.0)]);
    assert_eq!(held_out(), [2]);
}

/// A Nerfstudio file: intrinsics for all frames, one frame with its own, a mask, named splits.
fn write_nerfstudio(root: &Path, extra: &str) {
    let text = format!(
        r#"{{"w": 80, "h": 60.0, "fl_x": 70.0, "fl_y": 71.0, "cx": 41.0, "cy": 29.0,
            "k1": 0.01, "k2": -0.02, "p1": 0.001, "p2": 0.002, "camera_model": "OPENCV"{extra},
            "applied_transform": [[1,0,0,0],[0,1,0,0],[0,0,1,0]],
            "frames": [
              {{"file_path": "images/b.png", "transform_matrix": {POSE}, "colmap_im_id": 3}},
              {{"file_path": "./images/a.png", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4]],
                "fl_x": 75.0, "k1": 0.0, "k2": 0.0, "p1": 0, "p2": 0, "mask_path": "masks/a.png"}},
              {{"file_path": "images/c.png", "transform_matrix": {POSE}}}]}}"#
    );
    write_text(&root.join("transforms.json"), &text);
    for (index, name) in ["a", "b", "c"].iter().enumerate() {
        write_image(&root.join(format!("images/{name}.png")), 80, 60, index as u8);
        write_image(&root.join(format!("images_2/{name}.png")), 40, 30, index as u8);
    }
    let mask = image::GrayImage::from_pixel(40, 30, image::Luma([0]));
    write_dynamic(&root.join("masks/a.png"), &mask.into());
}

#[test]
fn a_nerfstudio_set_has_intrinsics_for_all_and_for_one() {
    let root = tempfile::tempdir().unwrap();
    write_nerfstudio(root.path(), "");
    let dataset = load_dataset(&root.path().join("transforms.json"), &default()).unwrap();
    assert_eq!(names(&dataset), ["images/a.png", "images/b.png", "images/c.png"]);
    let [a, b, _] = dataset.views.as_slice() else { unreachable!() };
    assert_eq!([a.camera.fx, a.camera.fy, a.camera.cx, a.camera.cy], [75.0, 71.0, 41.0, 29.0]);
    assert_eq!(a.distortion, Distortion::None);
    let expected =
        Distortion::Perspective { radial: [0.01, -0.02, 0.0], tangential: [0.001, 0.002] };
    assert_eq!(b.distortion, expected);
    assert_eq!(a.camera.world_to_camera, b.camera.world_to_camera, "3 rows are as good as 4");
    assert_eq!(load_image(a).unwrap().weight(0), 0.0);
    assert_eq!((a.split, b.split), (Split::Test, Split::Train));

    let options = DatasetOptions { downscale: Some(2), ..default() };
    let small = load_dataset(root.path(), &options).unwrap();
    assert!(small.views[1].image_path.ends_with("images_2/b.png"));
    assert_eq!([small.views[1].camera.fx, small.views[1].camera.cy], [35.0, 14.5]);
}

#[test]
fn nerfstudio_points_are_read_where_they_are_named() {
    let root = tempfile::tempdir().unwrap();
    write_nerfstudio(root.path(), r#", "ply_file_path": "sparse_pc.ply""#);
    let message = refusal(root.path(), &default());
    assert!(message.contains("sparse_pc.ply: "), "{message}");
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
               property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
               end_header\n1 2 3 4 5 6\n";
    write_text(&root.path().join("sparse_pc.ply"), ply);
    let points = load_dataset(root.path(), &default()).unwrap().points.unwrap();
    assert_eq!((points.positions, points.colors), (vec![[1.0, 2.0, 3.0]], vec![[4, 5, 6]]));
}

#[test]
fn nerfstudio_file_name_lists_are_the_split() {
    let root = tempfile::tempdir().unwrap();
    let lists = r#", "train_filenames": ["./images/a.png"], "val_filenames": ["images/c.png"]"#;
    write_nerfstudio(root.path(), lists);
    let dataset = load_dataset(root.path(), &default()).unwrap();
    assert_eq!(names(&dataset), ["images/a.png", "images/c.png"]);
    assert_eq!(dataset.test_views().collect::<Vec<_>>(), [1]);

    write_nerfstudio(root.path(), r#", "test_filenames": ["images/nothing.png"]"#);
    let message = refusal(root.path(), &default());
    assert!(message.contains("test_filenames: expected names of frames"), "{message}");
}

#[test]
fn a_nerfcapture_set_states_everything_per_frame_and_no_extensions() {
    let root = tempfile::tempdir().unwrap();
    let frame = |index: u32| {
        format!(
            r#"{{"file_path": "images/{index}", "depth_path": "images/{index}.depth.png",
                "fl_x": 70.0, "fl_y": 70.5, "cx": 40.0, "cy": 30.0, "w": 80, "h": 60,
                "timestamp": 12.5, "transform_matrix": {POSE}}}"#
        )
    };
    let text = format!(r#"{{"depth_integer_scale": 1.0, "frames": [{}, {}]}}"#, frame(0), frame(1));
    write_text(&root.path().join("transforms.json"), &text);
    for index in 0..2 {
        write_image(&root.path().join(format!("images/{index}.png")), 80, 60, index);
        write_image(&root.path().join(format!("images/{index}.depth.png")), 80, 60, 0);
    }
    let dataset = load_dataset(root.path(), &default()).unwrap();
    assert!(dataset.views[1].image_path.ends_with("images/1.png"));
    assert_eq!((dataset.views[1].camera.fy, dataset.views[1].time), (70.5, None));
    assert_eq!(
        dataset.views[0].camera.world_to_camera,
        DMat4::from_cols(DVec4::X, -DVec4::Y, -DVec4::Z, DVec4::new(0.0, 0.0, 4.0, 1.0))
    );
}

#[test]
fn unusable_fields_are_refused_by_name() {
    let root = tempfile::tempdir().unwrap();
    write_image(&root.path().join("a.png"), 8, 8, 0);
    let frame = |fields: &str| {
        format!(r#"{{"frames": [{{"file_path": "a.png", "transform_matrix": {POSE}{fields}}}]}}"#)
    };
    for (text, expected) in [
        (frame(""), "frames[0].fl_x: expected fl_x or camera_angle_x"),
        (frame(r#", "fl_x": "wide""#), "frames[0].fl_x"),
        (frame(r#", "fl_x": -3"#), "fx: expected a positive focal length"),
        (frame(r#", "camera_angle_x": 0"#), "fx: expected a positive focal length"),
        (frame(r#", "fl_x": 5, "w": 8.5"#), "frames[0].w: expected a whole number"),
        (frame(r#", "fl_x": 5, "time": 1e300"#), "frames[0].time: expected a finite"),
        (frame(r#", "fl_x": 5, "camera_model": "EQUIRECTANGULAR""#), "found EQUIRECTANGULAR"),
        (frame(r#", "fl_x": 5, "k4": 0.1"#), "frames[0].k4: expected 0"),
        (frame(r#", "fl_x": 5"#).replace("a.png", "b.png"), "image b.png: expected a file"),
        (frame(r#", "fl_x": 5"#).replace("[0,0,0,1]", "[0,0,0,2]"), "frames[0].transform_matrix"),
        (frame(r#", "fl_x": 5"#).replace("[1,0,0,0]", "[-1,0,0,0]"), "right-handed"),
        (frame(r#", "fl_x": 5"#).replace("[1,0,0,0]", "[1,0,0]"), "frames[0].transform_matrix[0]"),
        (r#"{"frames": []}"#.into(), "images: expected at least one"),
        ("{}".into(), "missing field `frames`"),
        ("[]".into(), "transforms.json: "),
    ] {
        write_text(&root.path().join("transforms.json"), &text);
        let message = refusal(root.path(), &default());
        assert!(message.contains(expected), "{text} gave {message}");
    }
}
