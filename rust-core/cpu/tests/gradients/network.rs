//! The fast gradient by the weights of a deformation network against the f64 specification.

use trapeze_cpu::reference::{self, NetworkGradient};
use trapeze_cpu::{DifferentiableRenderer, ImageGradient, RendererOptions};
use trapeze_scene::{FrameSettings, Motion, Scene, ShDegree, Splats};

use crate::scenes::{camera, image_weights, scene};
use crate::support::{STANDARD, Shape, random_network};

/// Splats before the camera that a random network moves by a few percent of the scene.
fn moving_scene(seed: u64, count: usize, shape: &Shape) -> Scene {
    let mut network = random_network(shape, seed);
    let heads = 3 + usize::from(shape.six_dof);
    let layers = network.layers().count();
    for head in network.layers_mut().skip(layers - heads) {
        head.weight.iter_mut().chain(&mut head.bias).for_each(|w| *w *= 0.05);
    }
    Scene { deformation: Some(network), ..scene(seed, count, ShDegree::One) }
}

fn fast_gradient(
    scene: &Scene,
    settings: &FrameSettings,
    color: &[[f32; 4]],
) -> (Vec<f32>, Splats) {
    let mut renderer = DifferentiableRenderer::new(RendererOptions::default());
    renderer.forward(scene, &camera((96, 70)), settings).unwrap();
    let gradient = ImageGradient { color, expected_depth: None };
    let (mut by_splats, mut by_network) = (Splats::default(), Vec::new());
    renderer.backward_with_network(scene, &gradient, &mut by_splats, &mut by_network).unwrap();
    (by_network, by_splats)
}

fn color_weights(scene: &Scene, settings: &FrameSettings) -> Vec<[f32; 4]> {
    let frame = reference::render(scene, &camera((96, 70)), settings);
    image_weights(5, &frame, 1e-3).0
}

/// ‖g − g*‖∞ / max‖g*‖ of every weight and bias, layer by layer.
fn deviations(fast: &[f32], exact: &NetworkGradient) -> Vec<f64> {
    let mut rest = fast;
    let tensors = exact.layers.iter().flat_map(|layer| [&layer.weight, &layer.bias]);
    let deviations = tensors.map(|exact| {
        let (these, after) = rest.split_at(exact.len());
        rest = after;
        let largest = exact.iter().fold(0.0f64, |m, g| m.max(g.abs()));
        assert!(largest > 1e-6, "nothing to compare");
        let differences = these.iter().zip(exact).map(|(&f, e)| (f64::from(f) - e).abs());
        differences.fold(0.0, f64::max) / largest
    });
    let deviations = deviations.collect();
    assert!(rest.is_empty());
    deviations
}

fn worst_deviation(scene: &Scene, settings: &FrameSettings) -> f64 {
    let color = color_weights(scene, settings);
    let gradient = ImageGradient { color: &color, expected_depth: None };
    let exact = reference::gradients(scene, &camera((96, 70)), settings, &gradient);
    let exact = reference::network_gradient(scene, settings, &exact.outputs).unwrap();
    let (fast, _) = fast_gradient(scene, settings, &color);
    deviations(&fast, &exact).into_iter().fold(0.0, f64::max)
}

#[test]
fn every_tensor_of_every_variant_follows_the_specification() {
    let settings = FrameSettings { time: 0.37, ..FrameSettings::default() };
    for (name, shape) in [
        ("standard", STANDARD),
        ("blender", Shape { inputs: 93, blender: true, ..STANDARD }),
        ("6-dof", Shape { six_dof: true, ..STANDARD }),
        ("wide", Shape { width: 300, depth: 4, ..STANDARD }),
    ] {
        let worst = worst_deviation(&moving_scene(31, 330, &shape), &settings);
        println!("{name}: {worst:.1e}");
        // Rounding alone is 2·10⁻⁶; a feature so close to 0 that f32 decides its ReLU differently
        // takes or leaves one splat's part of a sum over 330.
        assert!(worst <= 1e-3, "{name}: {worst:e}");
    }
}

#[test]
fn splats_that_a_masked_frame_holds_are_differentiated_at_time_zero() {
    let values = (0..120).map(|i| (i % 3) as f32).collect();
    let motion = Some(Motion { values, ..Motion::default() });
    let scene = Scene { motion, ..moving_scene(7, 120, &STANDARD) };
    let settings =
        FrameSettings { time: 0.8, static_threshold: Some(1.0), ..FrameSettings::default() };
    let worst = worst_deviation(&scene, &settings);
    assert!(worst <= 1e-3, "{worst:e}");
}

#[test]
fn the_gradient_does_not_depend_on_threads() {
    // More than sixteen batches: several in a lane.
    let scene = moving_scene(9, 2_500, &Shape { width: 48, depth: 4, ..STANDARD });
    let settings = FrameSettings { time: 0.6, ..FrameSettings::default() };
    let color = vec![[0.3, -0.2, 0.5, 0.1]; 96 * 70];
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fast_gradient(&scene, &settings, &color))
    };
    let expected = run(1);
    assert!(expected.0.iter().any(|&g| g != 0.0));
    for threads in [2, 3, 7] {
        assert_eq!(run(threads), expected, "{threads} threads");
    }
}

#[test]
fn a_time_that_is_not_a_number_is_zero_and_huge_positions_poison_nothing() {
    let mut scene = moving_scene(4, 60, &STANDARD);
    scene.splats.positions[3] = [1e30, -1e30, 1e30];
    scene.splats.positions[4] = [f32::MAX; 3];
    scene.splats.positions[5] = [f32::NAN, 0.0, f32::INFINITY];
    let color = vec![[0.3, -0.2, 0.5, 0.1]; 96 * 70];
    let at = |time| {
        let settings = FrameSettings { time, ..FrameSettings::default() };
        fast_gradient(&scene, &settings, &color)
    };
    let (by_network, by_splats) = at(0.0);
    assert!(by_network.iter().all(|g| g.is_finite()));
    assert!(by_network.iter().any(|&g| g != 0.0));
    for time in [f32::NAN, f32::INFINITY] {
        assert_eq!(at(time), (by_network.clone(), by_splats.clone()));
    }
}

#[test]
fn without_splats_in_view_or_a_network_there_is_no_gradient() {
    let mut away = moving_scene(4, 20, &STANDARD);
    away.splats.positions.iter_mut().for_each(|p| p[2] = -50.0);
    let empty = Scene { splats: Splats::default(), ..away.clone() };
    let color = vec![[1.0; 4]; 96 * 70];
    for scene in [&away, &empty] {
        let (by_network, _) = fast_gradient(scene, &FrameSettings::default(), &color);
        assert_eq!(by_network, vec![0.0; 506_378]);
    }
    let at_rest = Scene { deformation: None, ..moving_scene(4, 20, &STANDARD) };
    let (by_network, by_splats) = fast_gradient(&at_rest, &FrameSettings::default(), &color);
    assert!(by_network.is_empty());
    assert!(by_splats.positions.iter().any(|g| *g != [0.0; 3]));
}
