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
