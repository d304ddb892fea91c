//! Copies of one scene, a ten-thousandth and ten thousand times as large.

use glam::DVec3;
use trapeze_scene::{Camera, Scene, ShDegree};
use trapeze_tests::{assert_agrees, cloud, cloud_camera, everything};

/// The scene and its camera, everything `factor` times as large.
fn scaled(scene: &Scene, camera: &Camera, factor: f32) -> (Scene, Camera) {
    let mut scene = scene.clone();
    for position in &mut scene.splats.positions {
        *position = position.map(|c| c * factor);
    }
    for log_scale in &mut scene.splats.log_scales {
        *log_scale = log_scale.map(|s| s + factor.ln());
    }
    let mut camera = camera.clone();
    camera.world_to_camera.w_axis *= DVec3::splat(f64::from(factor)).extend(1.0);
    (scene, camera)
}

#[test]
fn the_size_of_the_world_does_not_change_the_image() {
    // The near plane is at 0.01 in every world, so the middle copy is a hundred units across: the
    // small one is then 0.01 across and 0.04 away, the large one a million across.
    let (base, camera) = scaled(&cloud(3000, ShDegree::Two, 10), &cloud_camera(120, 90), 100.0);
    let expected = assert_agrees(&base, &camera, &everything());
    for factor in [1e-4, 1e-2, 1e2, 1e4] {
        let (scene, camera) = scaled(&base, &camera, factor);
        let frame = assert_agrees(&scene, &camera, &everything());
        let differing = frame
            .color
            .iter()
            .zip(&expected.color)
            // Positions and log-scales are rounded once more: ε of the scene's size is 1e-5 px,
            // ε · |log-scale| a millionth of a deviation.
            .filter(|(a, b)| (0..4).any(|c| (a[c] - b[c]).abs() > 2e-4))
            .count();
        // A pixel whose order or threshold turned on that rounding.
        assert!(differing <= 2, "{factor}: {differing} pixels");
    }
}
