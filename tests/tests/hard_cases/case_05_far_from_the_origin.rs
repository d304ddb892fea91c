//! World coordinates near one million, as captures in geographic coordinates have them.

use glam::{DMat4, DVec3};
use trapeze_cpu::RendererOptions;
use trapeze_scene::{Camera, FrameSettings, Scene, ShDegree};
use trapeze_tests::{
    HeadBiases, assert_agrees, assert_close_color, cloud, cloud_camera, everything,
    largest_difference, render, sliding_network,
};

/// About where UTM coordinates of central Europe are.
const FAR: DVec3 = DVec3::new(691_607.25, 5_334_760.5, 520.0);

fn shifted(camera: &Camera, by: DVec3) -> Camera {
    Camera {
        world_to_camera: camera.world_to_camera * DMat4::from_translation(-by),
        ..camera.clone()
    }
}

#[test]
fn a_scene_with_an_origin_matches_the_same_scene_at_zero() {
    let near = cloud(2000, ShDegree::Two, 1);
    let camera = cloud_camera(120, 90);
    let expected = assert_agrees(&near, &camera, &everything());
    let far = Scene { origin: FAR, ..near };
    let frame = assert_agrees(&far, &shifted(&camera, FAR), &everything());
    // The camera centre is known to 5e6 · 2⁻⁵³ = 6e-10 world units, far below what f32 rounds
    // the same scene's own coordinates to; a few pixels may see another rounding of a threshold.
    let differing = frame
        .color
        .iter()
        .zip(&expected.color)
        .filter(|(a, b)| (0..4).any(|c| (a[c] - b[c]).abs() > 1e-4))
        .count();
    assert!(differing <= 1, "{differing} pixels, {}", largest_difference(&frame, &expected));
}

#[test]
fn positions_stored_far_out_in_single_precision_match_the_same_grid_at_zero() {
    // f32 at 5e6 knows half a unit, so the scene is two hundred times larger than a cloud: the
    // grid is what the file holds, and nothing may be lost beyond it.
    let mut far = cloud(2000, ShDegree::One, 2);
    let scale = 200.0f32;
    for (position, log_scale) in far.splats.positions.iter_mut().zip(&mut far.splats.log_scales) {
        *position = std::array::from_fn(|c| (f64::from(position[c] * scale) + FAR[c]) as f32);
        *log_scale = log_scale.map(|s| s + scale.ln());
    }
    let mut near = far.clone();
    for position in &mut near.splats.positions {
        // Both are multiples of the grid within 1.1e6 steps of it: the difference is exact.
        *position = std::array::from_fn(|c| (f64::from(position[c]) - FAR[c]) as f32);
    }
    let mut camera = cloud_camera(120, 90);
    camera.world_to_camera.w_axis *= DVec3::splat(f64::from(scale)).extend(1.0);
    let expected = assert_agrees(&near, &camera, &everything());
    let frame = assert_agrees(&far, &shifted(&camera, FAR), &everything());
    assert_close_color(&frame, &expected, 1e-4);
}

#[test]
fn the_network_of_a_far_scene_sees_world_coordinates() {
    // sin(2x) of the *world* x drives the motion: with x rounded to f32 before the network, which
    // knows 1/16 at 7e5, the splats would be displaced by up to 0.03.
    let far = Scene {
        origin: FAR,
        deformation: Some(sliding_network(&HeadBiases::default())),
        ..cloud(1000, ShDegree::Zero, 3)
    };
    let camera = shifted(&cloud_camera(120, 90), FAR);
    for time in [0.0, 0.7] {
        let settings = FrameSettings { time, ..everything() };
        let frame = assert_agrees(&far, &camera, &settings);
        let at_zero = Scene { origin: DVec3::ZERO, ..far.clone() };
        let near = cloud_camera(120, 90);
        let other = render(&at_zero, &near, &settings, RendererOptions::default());
        assert!(largest_difference(&frame, &other) > 0.01, "the network must see the origin");
    }
}
