//! Small deformation networks whose outputs are known without evaluating them.

use trapeze_scene::DeformationNetwork;
use trapeze_scene::deformation::{Encoding, Linear, PositionHead, RotationRule};

/// Width of the hidden layers.
const WIDTH: usize = 4;
const DEPTH: usize = 3;
const SKIP_AFTER: usize = 1;

/// What the heads add to every splat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeadBiases {
    /// d_xyz, world units.
    pub position: [f32; 3],
    /// d_rotation (w, x, y, z).
    pub rotation: [f32; 4],
    /// d_scale, world units.
    pub scale: [f32; 3],
}

fn zeros(outputs: usize, inputs: usize, bias: &[f32]) -> Linear {
    Linear { inputs, outputs, weight: vec![0.0; outputs * inputs], bias: bias.to_vec() }
}

/// A network that gives every splat the same deltas at every time: all weights are zero, so what
/// comes out of the heads is their biases.
#[must_use]
pub fn constant_network(biases: &HeadBiases) -> DeformationNetwork {
    let position_encoding = Encoding { dimensions: 3, octaves: 10 };
    let time_encoding = Encoding { dimensions: 1, octaves: 10 };
    let inputs = position_encoding.width() + time_encoding.width();
    let hidden = (0..DEPTH)
        .map(|i| match i {
            0 => zeros(WIDTH, inputs, &[0.0; WIDTH]),
            i if i == SKIP_AFTER + 1 => zeros(WIDTH, inputs + WIDTH, &[0.0; WIDTH]),
            _ => zeros(WIDTH, WIDTH, &[0.0; WIDTH]),
        })
        .collect();
    DeformationNetwork {
        position_encoding,
        time_encoding,
        time_network: None,
        hidden,
        skip_after: SKIP_AFTER,
        position_head: PositionHead::Translation(zeros(3, WIDTH, &biases.position)),
        rotation_head: zeros(4, WIDTH, &biases.rotation),
        scale_head: zeros(3, WIDTH, &biases.scale),
        rotation_rule: RotationRule::Renormalised,
    }
}

/// A network under which splats slide: d_xyz = (0.4·max(0, t) + bias) along x, more the higher
/// their own max(0, sin(2x)) is along y; d_scale grows by 0.02·max(0, t); `biases` are added at
/// every time, t = 0 included.
#[must_use]
pub fn sliding_network(biases: &HeadBiases) -> DeformationNetwork {
    let mut network = constant_network(biases);
    // Layer 0: h₀ = max(0, t), h₁ = max(0, sin 2x); h₀ and h₁ pass through the other layers.
    let time = network.position_width();
    let sin_2x = 3 + 6;
    network.hidden[0].weight[time] = 1.0;
    let inputs = network.hidden[0].inputs;
    network.hidden[0].weight[inputs + sin_2x] = 1.0;
    for layer in &mut network.hidden[1..] {
        let skipped = layer.inputs - WIDTH;
        for h in 0..2 {
            layer.weight[h * layer.inputs + skipped + h] = 1.0;
        }
    }
    let PositionHead::Translation(head) = &mut network.position_head else { return network };
    head.weight[0] = 0.4;
    head.weight[WIDTH + 1] = 0.3;
    for row in network.scale_head.weight.chunks_exact_mut(WIDTH) {
        row[0] = 0.02;
    }
    network
}
