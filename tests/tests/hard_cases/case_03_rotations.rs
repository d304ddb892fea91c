//! Quaternions without direction or of extreme length, deltas that cancel, scales that turn
//! negative.

use trapeze_cpu::RendererOptions;
use trapeze_cpu::reference::deform::MIN_DEFORMED_SCALE;
use trapeze_scene::{Frame, FrameSettings, Scene};
use trapeze_tests::{
    HeadBiases, Splat, assert_agrees, assert_close_color, assert_same_color, camera_at_origin,
    constant_network, everything, render, scene_of,
};

const IDENTITY: [f32; 4] = [1.0, 0.0, 0.0, 0.0];

/// An ellipsoid whose three axes differ, so that every rotation shows.
fn ellipsoid(rotation: [f32; 4]) -> Splat {
    Splat {
        log_scale: [0.5f32.ln(), 0.2f32.ln(), 0.05f32.ln()],
        rotation,
        logit: 2.0,
        ..Splat::default()
    }
}

fn image(scene: &Scene) -> Frame {
    assert_agrees(scene, &camera_at_origin(64, 48), &everything())
}

fn moved(splats: &[Splat], biases: &HeadBiases) -> Scene {
    Scene { deformation: Some(constant_network(biases)), ..scene_of(splats) }
}

#[test]
fn quaternions_without_direction_are_drawn_unrotated() {
    let expected = image(&scene_of(&[ellipsoid(IDENTITY)]));
    for rotation in [
        [0.0; 4],
        [-0.0; 4],
        [f32::NAN; 4],
        [1.0, f32::NAN, 0.0, 0.0],
        [0.0, 0.0, f32::INFINITY, 0.0],
        [f32::NEG_INFINITY, 1.0, 0.0, 0.0],
    ] {
        let frame = image(&scene_of(&[ellipsoid(rotation)]));
        assert_same_color(&frame, &expected, &rotation);
    }
}

#[test]
fn the_length_of_a_quaternion_does_not_change_the_image() {
    let unit = [0.8, 0.2, -0.4, 0.4];
    let expected = image(&scene_of(&[ellipsoid(unit)]));
    for length in [1e-38, 1e-20, 1e-3, 7.0, 1e20, 1e38] {
        let frame = image(&scene_of(&[ellipsoid(unit.map(|c| c * length))]));
        // The scaled components are rounded once more: 2⁻²⁴ of a rotation.
        assert_close_color(&frame, &expected, 1e-5);
    }
}

#[test]
fn denormal_quaternions_have_the_direction_that_is_left_in_them() {
    let smallest = f32::from_bits(1);
    let frame = image(&scene_of(&[ellipsoid([0.0, 0.0, smallest, 0.0])]));
    let expected = image(&scene_of(&[ellipsoid([0.0, 0.0, 1.0, 0.0])]));
    assert_same_color(&frame, &expected, "denormal");
}

#[test]
fn a_delta_that_cancels_the_rotation_leaves_the_splat_unrotated() {
    let biases = HeadBiases { rotation: [-1.0, 0.0, 0.0, 0.0], ..HeadBiases::default() };
    let expected = image(&scene_of(&[ellipsoid(IDENTITY)]));
    for rotation in [IDENTITY, [3.0, 0.0, 0.0, 0.0], [1e-20, 0.0, 0.0, 0.0]] {
        let cancelled = image(&moved(&[ellipsoid(rotation)], &biases));
        assert_same_color(&cancelled, &expected, &rotation);
    }
    // 1e-7 short of cancelling is rounding noise, not a direction.
    let noise = HeadBiases { rotation: [-1.0, 1e-7, 0.0, 0.0], ..HeadBiases::default() };
    assert_same_color(&image(&moved(&[ellipsoid(IDENTITY)], &noise)), &expected, "noise");
    // A hundredth is one: half a turn about x.
    let direction = HeadBiases { rotation: [-1.0, 1e-2, 0.0, 0.0], ..HeadBiases::default() };
    let turned = image(&moved(&[ellipsoid(IDENTITY)], &direction));
    let half_turn = image(&scene_of(&[ellipsoid([0.0, 1.0, 0.0, 0.0])]));
    // (−1 + 1) is exact, and so is the direction that is left.
    assert_close_color(&turned, &half_turn, 1e-5);
}

#[test]
fn deltas_that_are_not_numbers_turn_nothing_and_hide_what_has_no_place() {
    let rotation = HeadBiases { rotation: [f32::NAN; 4], ..HeadBiases::default() };
    let expected = image(&scene_of(&[ellipsoid(IDENTITY)]));
    assert_same_color(&image(&moved(&[ellipsoid([0.5; 4])], &rotation)), &expected, "NaN");
    for biases in [
        HeadBiases { position: [f32::NAN, 0.0, 0.0], ..HeadBiases::default() },
        HeadBiases { position: [0.0, f32::INFINITY, 0.0], ..HeadBiases::default() },
        HeadBiases { scale: [0.0, f32::NAN, 0.0], ..HeadBiases::default() },
    ] {
        let frame = image(&moved(&[ellipsoid(IDENTITY)], &biases));
        assert!(frame.color.iter().flatten().all(|&c| c == 0.0), "{biases:?}");
    }
}

#[test]
fn a_scale_that_its_delta_makes_negative_is_floored() {
    let biases = HeadBiases { scale: [-5.0, 0.0, -0.2], ..HeadBiases::default() };
    let frame = image(&moved(&[ellipsoid(IDENTITY)], &biases));
    let floored = Splat {
        log_scale: [
            (MIN_DEFORMED_SCALE as f32).ln(),
            0.2f32.ln(),
            (MIN_DEFORMED_SCALE as f32).ln(),
        ],
        ..ellipsoid(IDENTITY)
    };
    let expected = image(&scene_of(&[floored]));
    // exp(ln s) is s to ε · |ln s|.
    assert_close_color(&frame, &expected, 1e-5);
    assert!(frame.color.iter().any(|c| c[3] > 0.1));
}

#[test]
fn an_infinite_scale_delta_gives_the_largest_scale() {
    let biases = HeadBiases { scale: [f32::INFINITY; 3], ..HeadBiases::default() };
    let frame = image(&moved(&[ellipsoid(IDENTITY)], &biases));
    let opacity = 1.0 / (1.0 + (-2.0f32).exp());
    assert!(frame.color.iter().all(|c| (c[3] - opacity).abs() < 1e-3));
}

#[test]
fn a_network_with_zero_deltas_changes_nothing() {
    let splats = [ellipsoid([0.7, 0.1, 0.6, -0.3])];
    let camera = camera_at_origin(64, 48);
    let settings = FrameSettings { time: 0.6, ..FrameSettings::default() };
    let options = RendererOptions::default();
    let with = render(&moved(&splats, &HeadBiases::default()), &camera, &settings, options);
    let without = render(&scene_of(&splats), &camera, &settings, options);
    // The sum is normalised a second time: one rounding of the quaternion.
    assert_close_color(&with, &without, 1e-5);
}
