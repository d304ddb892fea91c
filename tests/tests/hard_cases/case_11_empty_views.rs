//! Views in which nothing is seen.

use glam::DVec3;
use trapeze_scene::{Camera, NO_SPLAT, Scene, ShDegree};
use trapeze_tests::{HeadBiases, assert_agrees, cloud, cloud_camera, everything, sliding_network};

#[test]
fn a_camera_that_looks_away_gives_an_empty_image() {
    let scene = Scene {
        deformation: Some(sliding_network(&HeadBiases::default())),
        ..cloud(500, ShDegree::Three, 14)
    };
    let eye = DVec3::new(0.0, 0.0, -4.0);
    let away = Camera::look_at(eye, eye * 2.0, DVec3::Y, 0.8, (50, 40));
    let frame = assert_agrees(&scene, &away, &everything());
    assert!(frame.color.iter().flatten().all(|&c| c == 0.0));
    assert!(frame.expected_depth.iter().chain(&frame.median_depth).all(|d| d.is_nan()));
    assert!(frame.top_contributor.iter().all(|&top| top == NO_SPLAT));
}

#[test]
fn a_picked_pixel_of_an_empty_view_holds_nothing() {
    let mut renderer = trapeze_cpu::Renderer::new(cloud(0, ShDegree::Zero, 0).into());
    let camera = cloud_camera(50, 40);
    assert_eq!(renderer.pick(&camera, &everything(), (10, 10)).unwrap(), None);
    assert_eq!(renderer.pick(&camera, &everything(), (50, 10)).unwrap(), None);
}
