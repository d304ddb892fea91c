//! The project's own D-NeRF-style captures: the full one of TRAPEZE_DATA and the committed subset.

use std::path::Path;

use glam::DVec3;
use trapeze_formats::dataset::{DatasetFormat, DatasetOptions, load_dataset, load_image};

use crate::written::test_data;

/// x, y, z and instance id of each point: the f32 body of an N × 4 `.npy` file.
fn instance_points(path: &Path) -> Vec<[f32; 4]> {
    let bytes = std::fs::read(path).unwrap();
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let floats = bytes[header..].chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()));
    floats.collect::<Vec<_>>().chunks_exact(4).map(|p| p.try_into().unwrap()).collect()
}

#[test]
fn the_full_capture_has_its_times_alpha_and_splits() {
    let Some(data) = test_data() else { return };
    let dataset = load_dataset(&data.join("sample-dataset"), &DatasetOptions::default()).unwrap();
    assert_eq!(dataset.format, DatasetFormat::Transforms);
    assert_eq!((dataset.training_views().count(), dataset.test_views().count()), (200, 20));
    assert!(dataset.points.is_none());
    let times: Vec<f32> =
        dataset.training_views().map(|v| dataset.views[v].time.unwrap()).collect();
    assert!(times.is_sorted() && times[0] == 0.0 && times[199] == 1.0);
    let image = load_image(&dataset.views[0]).unwrap();
    assert!(image.has_alpha() && (image.width, image.height) == (400, 400));
}

#[test]
fn the_points_at_time_zero_project_onto_their_instances() {
    let Some(data) = test_data() else { return };
    let folder = data.join("sample-dataset");
    let points = instance_points(&folder.join("points_t0_xyz_id.npy"));
    let dataset = load_dataset(&folder, &DatasetOptions::default()).unwrap();
    let (mut agreeing, mut visible) = (0, 0);
    // At most 1.5 % of the motion has happened in the first four frames.
    for index in 0..4 {
        let mask = image::open(folder.join(format!("masks/m_{index:03}.png"))).unwrap().into_rgb8();
        let camera = dataset.local_camera(index);
        for &[x, y, z, id] in &points {
            let p =
                camera.world_to_camera.transform_point3(DVec3::new(x.into(), y.into(), z.into()));
            let u = camera.fx * p.x / p.z + camera.cx;
            let v = camera.fy * p.y / p.z + camera.cy;
            assert!(p.z > 0.0, "the cameras look at the objects");
            if (0.0..400.0).contains(&u) && (0.0..400.0).contains(&v) {
                visible += 1;
                let red = mask.get_pixel(u as u32, v as u32)[0];
                agreeing += u32::from((f32::from(red) / 32.0).round() == id);
            }
        }
    }
    let share = f64::from(agreeing) / f64::from(visible);
    eprintln!("{share:.3} of {visible} points are on their instance");
    // Points on the far side of an object may be hidden by another one.
    assert!(share > 0.9, "{share}");
}

#[test]
fn the_committed_subset_is_complete_and_small() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/sample-dataset");
    let dataset = load_dataset(&folder, &DatasetOptions::default()).unwrap();
    assert_eq!(dataset.warnings, [""; 0]);
    let bytes: u64 = dataset.views.iter().map(|v| v.image_path.metadata().unwrap().len()).sum();
    assert!(bytes <= 3_000_000, "{bytes}");
    assert_eq!((dataset.training_views().count(), dataset.test_views().count()), (40, 4));
    for view in &dataset.views {
        let image = load_image(view).unwrap();
        assert!(image.has_alpha() && view.time.is_some(), "{}", view.name);
    }
}
