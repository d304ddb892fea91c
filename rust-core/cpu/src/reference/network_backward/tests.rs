//! The gradient by the weights against differences of the forward pass.

use trapeze_scene::Splats;
use trapeze_scene::deformation::{Encoding, RotationRule};

use super::*;
use crate::reference::deform::{evaluate_network, screw_displacement};

/// Numbers without a pattern, uniform in ±1.
fn scattered(i: usize) -> f32 {
    ((i as u32).wrapping_mul(2_654_435_761).wrapping_add(12_345) >> 8) as f32 / 8_388_608.0 - 1.0
}

fn layer(seed: usize, inputs: usize, outputs: usize) -> Linear {
    let bound = (3.0 / inputs as f32).sqrt();
    let draw = |i: usize| bound * scattered(7_919 * seed + i);
    Linear {
        inputs,
        outputs,
        weight: (0..inputs * outputs).map(draw).collect(),
        bias: (0..outputs).map(|o| 0.3 * draw(inputs * outputs + o)).collect(),
    }
}

const WIDTH: usize = 20;

fn network(with_time_network: bool, with_screw: bool) -> DeformationNetwork {
    let position_encoding = Encoding { dimensions: 3, octaves: 3 };
    let time_encoding = Encoding { dimensions: 1, octaves: 4 };
    let time_width = if with_time_network { 5 } else { time_encoding.width() };
    let inputs = position_encoding.width() + time_width;
    DeformationNetwork {
        position_encoding,
        time_encoding,
        time_network: with_time_network.then(|| TimeNetwork {
            hidden: layer(20, time_encoding.width(), 11),
            output: layer(21, 11, time_width),
        }),
        hidden: vec![
            layer(1, inputs, WIDTH),
            layer(2, WIDTH, WIDTH),
            layer(3, WIDTH, WIDTH),
            layer(4, inputs + WIDTH, WIDTH),
        ],
        skip_after: 2,
        position_head: if with_screw {
            PositionHead::Screw { w: layer(5, WIDTH, 3), v: layer(6, WIDTH, 3) }
        } else {
            PositionHead::Translation(layer(5, WIDTH, 3))
        },
        rotation_head: layer(7, WIDTH, 4),
        scale_head: layer(8, WIDTH, 3),
        rotation_rule: RotationRule::default(),
    }
}

const WORLD: [f64; 3] = [0.4, -0.7, 1.1];
const TIME: f64 = 0.37;

fn weights_of_outputs() -> NetworkOutput {
    NetworkOutput {
        displacement: [0.7, -1.1, 0.4],
        d_rotation: [0.2, 0.9, -0.6, 1.3],
        d_scale: [-0.5, 0.8, 1.7],
    }
}

fn weighted_outputs(network: &DeformationNetwork) -> f64 {
    let (output, by) = (evaluate_network(network, WORLD, TIME), weights_of_outputs());
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    dot(&output.displacement, &by.displacement)
        + dot(&output.d_rotation, &by.d_rotation)
        + dot(&output.d_scale, &by.d_scale)
}

/// The weight or the bias of a layer.
type Numbers = fn(&mut Linear) -> &mut Vec<f32>;

/// Which features the ReLUs let through.
fn pattern(network: &DeformationNetwork) -> Vec<bool> {
    let of_time = network.time_network.as_ref().map(|net| {
        let mut hidden = linear(&net.hidden, &encoded_time(network.time_encoding, TIME));
        rectify(&mut hidden);
        hidden
    });
    let trace = Trace::of(network, WORLD, TIME);
    trace.outputs.into_iter().chain(of_time).flatten().map(|y| y > 0.0).collect()
}

#[test]
fn the_gradient_of_every_weight_of_every_variant_is_the_difference_quotient() {
    for (with_time_network, with_screw) in
        [(false, false), (true, false), (false, true), (true, true)]
    {
        let network = network(with_time_network, with_screw);
        let mut gradient = NetworkGradient::zeros(&network);
        network_backward(&network, WORLD, TIME, &weights_of_outputs(), &mut gradient);
        let free = pattern(&network);
        for (l, analytic) in gradient.layers.iter().enumerate() {
            let parts: [(&[f64], Numbers); 2] =
                [(&analytic.weight, |l| &mut l.weight), (&analytic.bias, |l| &mut l.bias)];
            for (analytic, of) in parts {
                let largest = analytic.iter().fold(0.0f64, |m, g| m.max(g.abs()));
                assert!(largest > 1e-3, "layer {l}: nothing to compare");
                let mut crossed = 0;
                for (k, &exact) in analytic.iter().enumerate() {
                    // A loss that is linear in the outputs is piecewise linear in each weight,
                    // except behind a screw: h³/6 of the third derivative, 10⁻¹² here. Weights
                    // are f32, so what was really added is measured.
                    let h = 1e-4;
                    let at = |by: f32| {
                        let mut moved = network.clone();
                        let number = &mut of(moved.layers_mut().nth(l).unwrap())[k];
                        *number += by;
                        let at = f64::from(*number);
                        (at, weighted_outputs(&moved), pattern(&moved) == free)
                    };
                    let (low, high) = (at(-h), at(h));
                    if !(low.2 && high.2) {
                        crossed += 1;
                        continue;
                    }
                    let difference = (high.1 - low.1) / (high.0 - low.0);
                    let error = (difference - exact).abs() / largest;
                    assert!(error <= 1e-6, "layer {l}, {k}: {difference} {exact}");
                }
                assert!(crossed * 20 <= analytic.len(), "layer {l}: {crossed} ReLUs crossed");
            }
        }
    }
}

#[test]
fn the_gradient_of_a_screw_has_its_limit_where_the_rotation_ends() {
    let (v, g) = ([0.3, -0.2, 0.9], [0.5, 1.0, -0.8]);
    let (limit_w, limit_v) = screw_backward([0.0; 3], v, WORLD, g);
    for theta in [1e-3, 1e-9, 1e-100] {
        let near = screw_backward([theta, 0.0, 0.0], v, WORLD, g);
        for c in 0..3 {
            // Upstream's 1e-5 turns the axis by as much.
            assert!((near.0[c] - limit_w[c]).abs() < 4.0 * theta + 1e-4, "{near:?} {limit_w:?}");
            assert!((near.1[c] - limit_v[c]).abs() < 4.0 * theta + 1e-4, "{near:?} {limit_v:?}");
        }
    }
    let value = |w: [f64; 3]| DVec3::from(screw_displacement(w, v, WORLD)).dot(DVec3::from(g));
    let w = [0.4, -0.3, 0.6];
    let (by_w, _) = screw_backward(w, v, WORLD, g);
    for c in 0..3 {
        let moved = |by: f64| value(std::array::from_fn(|k| w[k] + if k == c { by } else { 0.0 }));
        let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
        assert!((difference - by_w[c]).abs() < 1e-8, "{difference} {}", by_w[c]);
    }
}

#[test]
fn the_gradient_of_a_scene_is_the_sum_over_its_splats() {
    let positions: Vec<[f32; 3]> =
        (0..150).map(|i| [scattered(3 * i), scattered(3 * i + 1), scattered(3 * i + 2)]).collect();
    let splats = Splats { positions: positions.clone(), ..Splats::default() };
    let scene = Scene { deformation: Some(network(false, false)), ..Scene::from_splats(splats) };
    let network = scene.deformation.as_ref().unwrap();
    let mut by_outputs = vec![NetworkOutput::default(); positions.len()];
    let mut expected = NetworkGradient::zeros(network);
    for i in (0..positions.len()).step_by(2) {
        by_outputs[i].displacement[i % 3] = 1.0;
        let world = positions[i].map(f64::from);
        network_backward(network, world, TIME, &by_outputs[i], &mut expected);
    }
    let settings = FrameSettings { time: TIME as f32, ..FrameSettings::default() };
    let sum = network_gradient(&scene, &settings, &by_outputs).unwrap();
    for (sum, expected) in sum.layers.iter().zip(&expected.layers) {
        let pairs = sum.weight.iter().zip(&expected.weight);
        for (sum, expected) in pairs.chain(sum.bias.iter().zip(&expected.bias)) {
            // The time was rounded to f32: 2⁻²⁵, times 2³ in the highest octave.
            assert!((sum - expected).abs() < 1e-4, "{sum} {expected}");
        }
    }
    let static_scene = Scene { deformation: None, ..scene };
    assert!(network_gradient(&static_scene, &settings, &by_outputs).is_none());
}
