//! The LLFF captures fern and room: COLMAP models and `poses_bounds.npy` of the same photographs.

use std::path::Path;

use glam::{DVec3, dvec2};
use trapeze_formats::dataset::{
    Dataset, DatasetFormat, DatasetOptions, Lens, load_dataset, load_image,
};

use crate::written::{names, test_data};

fn load(folder: &Path, format: DatasetFormat) -> Dataset {
    let options = DatasetOptions { format: Some(format), ..DatasetOptions::default() };
    load_dataset(folder, &options).unwrap()
}

#[test]
fn llff_poses_agree_with_the_colmap_model() {
    let Some(data) = test_data() else { return };
    for (name, views) in [("fern", 20), ("room", 41)] {
        let colmap = load(&data.join(name), DatasetFormat::Colmap);
        let llff = load(&data.join(name), DatasetFormat::Llff);
        assert_eq!((colmap.views.len(), llff.views.len()), (views, views));
        assert_eq!(colmap.points, llff.points);
        for (a, b) in colmap.views.iter().zip(&llff.views) {
            assert_eq!(a.image_path, b.image_path);
            // Both hold the same doubles, once as a quaternion and once as a matrix.
            let difference = (a.camera.world_to_camera - b.camera.world_to_camera).abs();
            let largest = difference.to_cols_array().into_iter().fold(0.0, f64::max);
            assert!(largest < 1e-12, "{}: {largest:e}", a.name);
            assert_eq!([a.camera.width, a.camera.height], [b.camera.width, b.camera.height]);
            let focal = (a.camera.fx - b.camera.fx).abs() / a.camera.fx;
            assert!(focal < 1e-9, "{}: {focal:e}", a.name);
            let [near, far] = b.depth_range.unwrap();
            assert!(0.0 < near && near < far);
        }
    }
}

#[test]
fn fern_is_matched_by_order_with_a_warning_and_holds_out_0_8_16() {
    let Some(data) = test_data() else { return };
    let fern = load_dataset(&data.join("fern"), &DatasetOptions::default()).unwrap();
    assert_eq!(fern.format, DatasetFormat::Colmap);
    assert_eq!(fern.test_views().collect::<Vec<_>>(), [0, 8, 16]);
    assert_eq!(fern.warnings.len(), 1, "{:?}", fern.warnings);
    assert!(fern.warnings[0].contains("image000.png as IMG_4026.JPG"), "{:?}", fern.warnings);
    assert_eq!(fern.points.as_ref().unwrap().len(), 10_091);
    assert_eq!(fern.origin, DVec3::ZERO);
    let (first, last) = (&fern.views[0], &fern.views[19]);
    assert!(first.name == "IMG_4026.JPG" && first.image_path.ends_with("image000.png"));
    assert!(last.image_path.ends_with("image019.png"));
    // 4032 × 3024 in the model, 504 × 378 on disk.
    assert_eq!((first.camera.width, first.camera.height), (504, 378));
    assert!((first.camera.fx - 3260.526328 / 8.0).abs() < 1e-6);
    assert_eq!((first.camera.cx, first.camera.cy), (252.0, 189.0));

    let room = load_dataset(&data.join("room"), &DatasetOptions::default()).unwrap();
    // COLMAP was told not to extract colours there.
    assert_eq!(room.warnings, ["the points have no colours (all black): mid grey is taken"]);
    assert!(room.points.as_ref().unwrap().colors.iter().all(|color| *color == [128; 3]));
    assert_eq!(room.test_views().collect::<Vec<_>>(), [0, 8, 16, 24, 32, 40]);
    assert_eq!(names(&room)[0], "DJI_20200226_143850_006.JPG");
    let camera = &room.views[0].camera;
    assert_eq!((camera.width, camera.height, camera.cx), (800, 600, 400.0));
}

/// Pixels at which the points of a dataset are seen in a view, with their indices.
fn projections(dataset: &Dataset, view: usize) -> Vec<(usize, [u32; 2])> {
    let camera = dataset.local_camera(view);
    let points = dataset.points.as_ref().unwrap();
    let project = |position: &[f32; 3]| {
        let p = camera.world_to_camera.transform_point3(DVec3::from(position.map(f64::from)));
        let (u, v) = (camera.fx * p.x / p.z + camera.cx, camera.fy * p.y / p.z + camera.cy);
        let is_inside = p.z > 0.0
            && (0.0..f64::from(camera.width)).contains(&u)
            && (0.0..f64::from(camera.height)).contains(&v);
        is_inside.then_some([u as u32, v as u32])
    };
    let seen = points.positions.iter().enumerate();
    seen.filter_map(|(index, position)| Some((index, project(position)?))).collect()
}

#[test]
fn the_sparse_points_project_into_the_photographs() {
    let Some(data) = test_data() else { return };
    for name in ["fern", "room"] {
        let dataset = load_dataset(&data.join(name), &DatasetOptions::default()).unwrap();
        let inside: usize = (0..dataset.views.len()).map(|v| projections(&dataset, v).len()).sum();
        let pairs = dataset.points.as_ref().unwrap().len() * dataset.views.len();
        let share = inside as f64 / pairs as f64;
        eprintln!("{name}: {share:.3} of the points are inside");
        // Forward-facing captures see nearly all of their points from every view.
        assert!(share > 0.95, "{name}: {share}");
    }
}

#[test]
fn the_sparse_points_have_the_colours_of_the_pixels_that_they_project_to() {
    let Some(data) = test_data() else { return };
    let fern = load_dataset(&data.join("fern"), &DatasetOptions::default()).unwrap();
    let points = fern.points.as_ref().unwrap();
    // The pixel and, as a control, its mirror image at the centre.
    let (mut error, mut control) = (0.0, 0.0);
    for (index, view) in fern.views.iter().enumerate() {
        let image = load_image(view).unwrap();
        let distance = |point: usize, [x, y]: [u32; 2]| -> f64 {
            let seen = image.rgba((y * image.width + x) as usize);
            let channel = |c: usize| (seen[c] * 255.0 - f32::from(points.colors[point][c])).abs();
            (0..3).map(|c| f64::from(channel(c))).sum()
        };
        for (point, [x, y]) in projections(&fern, index) {
            error += distance(point, [x, y]);
            control += distance(point, [image.width - 1 - x, image.height - 1 - y]);
        }
    }
    eprintln!("fern: colours differ by {:.2} of what unrelated pixels do", error / control);
    // Points lie on edges and the images are an eighth of those they were triangulated from, so
    // that a good part of the difference stays.
    assert!(error < 0.75 * control, "{error} {control}");
}

#[test]
fn removing_the_distortion_moves_the_photograph_as_the_lens_model_says() {
    let Some(data) = test_data() else { return };
    let removing = load_dataset(&data.join("fern"), &DatasetOptions::default()).unwrap();
    let ignoring = DatasetOptions { ignore_distortion: true, ..DatasetOptions::default() };
    let raw = load_dataset(&data.join("fern"), &ignoring).unwrap();
    let view = &removing.views[0];
    let straight = load_image(view).unwrap();
    let photograph = load_image(&raw.views[0]).unwrap();
    let lens = Lens::new(view.distortion);
    let camera = &view.camera;
    // Nearest-pixel look-ups through the inverse agree with bilinear ones through the model up to
    // half a pixel of image gradient; a mirrored or missing correction would be off by several
    // pixels at the border (k₁r²·r·fx ≈ 2.6 px) and show as ten times the error.
    let (mut error, mut count) = (0.0, 0);
    for y in 0..photograph.height {
        for x in 0..photograph.width {
            let distorted = dvec2(
                (f64::from(x) + 0.5 - camera.cx) / camera.fx,
                (f64::from(y) + 0.5 - camera.cy) / camera.fy,
            );
            let ideal = lens.undistort(distorted).unwrap();
            let u = (camera.fx * ideal.x + camera.cx).floor();
            let v = (camera.fy * ideal.y + camera.cy).floor();
            let is_inside = (0.0..f64::from(straight.width)).contains(&u)
                && (0.0..f64::from(straight.height)).contains(&v);
            if is_inside {
                let a = straight.rgba(v as usize * straight.width as usize + u as usize);
                let b = photograph.rgba((y * photograph.width + x) as usize);
                error += f64::from((a[1] - b[1]).abs());
                count += 1;
            }
        }
    }
    let error = error / f64::from(count);
    let share_seen = straight.weights.as_ref().map_or(1.0, |weights| {
        weights.iter().filter(|&&w| w == 255).count() as f64 / weights.len() as f64
    });
    eprintln!("fern: mean difference {error:.4}, {share_seen:.3} of the pixels have a source");
    assert!(error < 0.04 && share_seen > 0.97, "{error} {share_seen}");
}
