//! Exports of phone apps, written as the apps' readers elsewhere expect them.

use std::path::Path;

use glam::{DVec3, DVec4};
use trapeze_formats::dataset::{Dataset, DatasetFormat, DatasetOptions, load_dataset};

use crate::written::{names, refusal, write_image, write_text};

/// A camera at (1, 2, 3) with OpenGL axes along the world's sees (1, 3, 1), one above its axis, at
/// y = −1 and z = 2.
fn assert_pose(dataset: &Dataset, view: usize) {
    let camera = &dataset.views[view].camera;
    assert!((camera.centre() - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
    let seen = camera.world_to_camera * DVec4::new(1.0, 3.0, 1.0, 1.0);
    assert!((seen - DVec4::new(0.0, -1.0, 2.0, 1.0)).length() < 1e-12, "{seen}");
}

fn write_polycam(root: &Path, cameras: &str, images: &str) {
    for name in ["11", "12"] {
        let text = r#"{"fx": 30.0, "fy": 31.0, "cx": 16.0, "cy": 12.0, "width": 32, "height": 24,
            "t_00": 1, "t_01": 0, "t_02": 0, "t_03": 1, "t_10": 0, "t_11": 1, "t_12": 0, "t_13": 2,
            "t_20": 0, "t_21": 0, "t_22": 1, "t_23": 3, "blur_score": 170.5}"#;
        write_text(&root.join(format!("keyframes/{cameras}/{name}.json")), text);
        write_image(&root.join(format!("keyframes/{images}/{name}.jpg")), 32, 24, 0);
    }
}

#[test]
fn polycam_exports_prefer_the_adjusted_cameras() {
    let root = tempfile::tempdir().unwrap();
    write_polycam(root.path(), "cameras", "images");
    let dataset = load_dataset(root.path(), &DatasetOptions::default()).unwrap();
    assert_eq!((dataset.format, names(&dataset)), (DatasetFormat::Polycam, vec!["11", "12"]));
    assert_pose(&dataset, 1);
    assert_eq!(dataset.views[0].camera.fy, 31.0);

    write_polycam(root.path(), "corrected_cameras", "corrected_images");
    let dataset = load_dataset(root.path(), &DatasetOptions::default()).unwrap();
    assert!(dataset.views[0].image_path.ends_with("corrected_images/11.jpg"));

    write_text(&root.path().join("keyframes/corrected_cameras/12.json"), r#"{"fx": 1}"#);
    let message = refusal(root.path(), &DatasetOptions::default());
    assert!(message.contains("12.json") && message.contains("missing field `fy`"), "{message}");
}

#[test]
fn record3d_exports_number_their_poses_by_image() {
    let root = tempfile::tempdir().unwrap();
    let poses: Vec<_> = (0..12).map(|_| "[0, 0, 0, 1, 1, 2, 3]").collect();
    let text = format!(
        r#"{{"K": [30, 0, 0, 0, 31, 0, 15, 13, 1], "w": 32, "h": 24, "fps": 60, "poses": [{}]}}"#,
        poses.join(",")
    );
    write_text(&root.path().join("metadata.json"), &text);
    for number in [0, 2, 10] {
        write_image(&root.path().join(format!("rgb/{number}.jpg")), 32, 24, 0);
    }
    let dataset = load_dataset(root.path(), &DatasetOptions::default()).unwrap();
    assert_eq!(dataset.format, DatasetFormat::Record3d);
    assert_eq!(names(&dataset), ["0.jpg", "2.jpg", "10.jpg"], "by number, not by letter");
    assert_pose(&dataset, 2);
    let camera = &dataset.views[0].camera;
    assert_eq!([camera.fx, camera.fy, camera.cx, camera.cy], [30.0, 31.0, 15.0, 13.0]);

    write_image(&root.path().join("rgb/12.jpg"), 32, 24, 0);
    let message = refusal(root.path(), &DatasetOptions::default());
    assert!(message.contains("image name: expected a number below 12"), "{message}");
}

#[test]
fn captures_of_the_app_are_read_as_it_meant_them() {
    // What the app's own test holds its writer to.
    let app = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../apple-app/TrapezeKit/Tests");
    let fixture = app.join("TrapezeKitTests/Fixtures/capture");
    let root = tempfile::tempdir().unwrap();
    for name in ["transforms.json", "points.ply"] {
        std::fs::copy(fixture.join(name), root.path().join(name)).unwrap();
    }
    let text = std::fs::read_to_string(fixture.join("transforms.json")).unwrap();
    let written: serde_json::Value = serde_json::from_str(&text).unwrap();
    let frames = written["frames"].as_array().unwrap();
    for frame in frames {
        let path = root.path().join(frame["file_path"].as_str().unwrap());
        write_image(&path, 1920, 1440, 0);
    }
    let dataset = load_dataset(root.path(), &DatasetOptions::default()).unwrap();
    assert_eq!(dataset.views.len(), frames.len());
    let points = dataset.points.as_ref().unwrap();
    assert_eq!(points.len(), 40);
    for (view, frame) in dataset.views.iter().zip(frames) {
        let camera = &view.camera;
        assert_eq!([camera.width, camera.height], [1920, 1440]);
        for (found, name) in
            [(camera.fx, "fl_x"), (camera.fy, "fl_y"), (camera.cx, "cx"), (camera.cy, "cy")]
        {
            assert_eq!(found, frame[name].as_f64().unwrap(), "{name}");
        }
        let row = |r: usize| frame["transform_matrix"][r][3].as_f64().unwrap();
        let centre = DVec3::new(row(0), row(1), row(2));
        // Seven decimals were written.
        assert!((camera.centre() - centre).length() < 1e-6);
        // The camera went around the points and looked at them: they are in front of it.
        for &[x, y, z] in &points.positions {
            let point = DVec3::new(x.into(), y.into(), z.into()) + dataset.origin;
            let seen = camera.world_to_camera * point.extend(1.0);
            assert!(seen.z > 0.0, "{seen}");
        }
    }
}
