//! Captures in geographic coordinates.

use glam::{DMat4, DVec3};
use trapeze_scene::FrameSettings;
use trapeze_scene::ShDegree;
use trapeze_tests::{cloud, cloud_camera, gradients};

#[test]
fn an_origin_of_a_million_changes_no_gradient_beyond_rounding() {
    let scene = cloud(200, ShDegree::One, 5);
    let camera = cloud_camera(80, 60);
    let origin = DVec3::new(1.0e6, -2.0e6, 3.0e5);
    let mut moved = scene.clone();
    moved.origin = origin;
    let mut moved_camera = camera.clone();
    moved_camera.world_to_camera = camera.world_to_camera * DMat4::from_translation(-origin);
    let settings = FrameSettings::default();
    let all_here = gradients(&scene, &camera, &settings);
    let all_there = gradients(&moved, &moved_camera, &settings);
    for (here, there) in all_here.iter().zip(&all_there) {
        // The camera's centre in f64 at 10⁶ is known to 10⁻¹⁰ of a unit.
        let largest = here.positions.as_flattened().iter().fold(0.0f32, |m, g| m.max(g.abs()));
        for (a, b) in here.positions.as_flattened().iter().zip(there.positions.as_flattened()) {
            assert!((a - b).abs() <= 1e-4 * largest, "{a} {b}");
        }
    }
}
