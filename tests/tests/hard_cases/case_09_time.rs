//! Times that no training has seen.

use trapeze_cpu::RendererOptions;
use trapeze_scene::{FrameSettings, Motion, Scene, ShDegree};
use trapeze_tests::{
    HeadBiases, assert_agrees, assert_same_color, cloud, cloud_camera, everything, render,
    sliding_network,
};

fn scene() -> Scene {
    let biases = HeadBiases { position: [0.0, 0.1, 0.0], ..HeadBiases::default() };
    Scene { deformation: Some(sliding_network(&biases)), ..cloud(1500, ShDegree::One, 11) }
}

#[test]
fn times_outside_0_to_1_are_evaluated_as_they_are() {
    let camera = cloud_camera(100, 75);
    let image = |time| assert_agrees(&scene(), &camera, &FrameSettings { time, ..everything() });
    let (one, two) = (image(1.0), image(2.0));
    assert!(one.color != two.color, "2 is not clamped to 1");
    for time in [-1.0, -1e3, 1e-40, 7.5, 1e4] {
        let _ = image(time);
    }
}

#[test]
fn a_time_that_is_not_a_finite_number_is_zero() {
    let camera = cloud_camera(100, 75);
    let mut scene = scene();
    scene.motion = Some(Motion {
        values: (0..scene.len()).map(|i| (i % 4) as f32).collect(),
        ..Motion::default()
    });
    for static_threshold in [None, Some(1.5)] {
        let image = |time| {
            let settings = FrameSettings { time, static_threshold, ..everything() };
            assert_agrees(&scene, &camera, &settings)
        };
        let zero = image(0.0);
        for time in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0] {
            assert_same_color(&image(time), &zero, &time);
        }
    }
}

#[test]
fn any_time_is_accepted_where_nothing_moves() {
    let scene = cloud(300, ShDegree::Zero, 12);
    let camera = cloud_camera(64, 48);
    let image = |time| {
        let settings = FrameSettings { time, ..FrameSettings::default() };
        render(&scene, &camera, &settings, RendererOptions::default())
    };
    let expected = image(0.0);
    for time in [f32::NAN, f32::INFINITY, -5.0, 0.5] {
        assert_same_color(&image(time), &expected, &time);
    }
}
