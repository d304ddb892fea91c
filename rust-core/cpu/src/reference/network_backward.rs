//! The mirror of [`evaluate_network`](super::deform::evaluate_network): ∂L/∂outputs →
//! ∂L/∂(weights and biases).
//!
//! Each function here has the forward pass's function of the same name as its counterpart. The
//! position is an input and gets no gradient.

use glam::DVec3;
use rayon::prelude::*;
use trapeze_scene::deformation::{Linear, PositionHead, TimeNetwork};
use trapeze_scene::{DeformationNetwork, FrameSettings, Scene};

use super::deform::{
    NetworkOutput, UPSTREAM_SCREW_OFFSET, encoded_time, linear, network_input, rectify, three,
};
use super::pose::network_time;

/// Splats whose gradients one task adds up.
const CHUNK: usize = 64;

/// ∂L/∂(weights and biases), in the order of [`DeformationNetwork::layers`].
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkGradient {
    /// One entry per layer.
    pub layers: Vec<LayerGradient>,
}

/// ∂L/∂(one layer).
#[derive(Clone, Debug, PartialEq)]
pub struct LayerGradient {
    /// By W, row-major, outputs × inputs.
    pub weight: Vec<f64>,
    /// By b.
    pub bias: Vec<f64>,
}

impl NetworkGradient {
    /// Zeros in the shape of a network.
    #[must_use]
    pub fn zeros(network: &DeformationNetwork) -> Self {
        let zeros = |layer: &Linear| LayerGradient {
            weight: vec![0.0; layer.weight.len()],
            bias: vec![0.0; layer.bias.len()],
        };
        Self { layers: network.layers().map(zeros).collect() }
    }

    fn add(&mut self, other: &Self) {
        for (to, from) in self.layers.iter_mut().zip(&other.layers) {
            for (to, from) in [(&mut to.weight, &from.weight), (&mut to.bias, &from.bias)] {
                to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
            }
        }
    }
}

/// The gradient by the network of `scene`, from the gradient by its outputs, one entry per splat
/// ([`ReferenceGradients::outputs`](super::ReferenceGradients::outputs)). `None` in scenes without
/// a network.
///
/// # Panics
/// When there is not one entry per splat.
#[must_use]
pub fn network_gradient(
    scene: &Scene,
    settings: &FrameSettings,
    by_outputs: &[NetworkOutput],
) -> Option<NetworkGradient> {
    assert_eq!(by_outputs.len(), scene.len(), "gradients by the network's outputs");
    let network = scene.deformation.as_ref()?;
    let add_splat = |sum: &mut NetworkGradient, i: usize| {
        let world = DVec3::from(scene.splats.positions[i].map(f64::from)) + scene.origin;
        let time = network_time(scene, i, settings);
        network_backward(network, world.to_array(), time, &by_outputs[i], sum);
    };
    let moved: Vec<usize> =
        (0..scene.len()).filter(|&i| by_outputs[i] != NetworkOutput::default()).collect();
    let chunks = moved.par_chunks(CHUNK).map(|chunk| {
        let mut sum = NetworkGradient::zeros(network);
        chunk.iter().for_each(|&i| add_splat(&mut sum, i));
        sum
    });
    let sums: Vec<NetworkGradient> = chunks.collect();
    let mut total = NetworkGradient::zeros(network);
    sums.iter().for_each(|sum| total.add(sum));
    Some(total)
}

/// Adds what one splat at `world` contributes at time `t`, given ∂L/∂(its outputs).
///
/// # Panics
/// When `gradient` has another shape than the network.
pub fn network_backward(
    network: &DeformationNetwork,
    world: [f64; 3],
    t: f64,
    by_output: &NetworkOutput,
    gradient: &mut NetworkGradient,
) {
    let trace = Trace::of(network, world, t);
    let (time_layers, layers) = gradient.layers.split_at_mut(trace.time_layers);
    let (hidden_layers, heads) = layers.split_at_mut(network.hidden.len());

    let mut by_h = heads_backward(network, world, &trace.last, by_output, heads);
    let inputs = network.input_width();
    let mut by_input = vec![0.0; inputs];
    for (i, layer) in network.hidden.iter().enumerate().rev() {
        rectify_backward(&trace.outputs[i], &mut by_h);
        by_h = linear_backward(layer, &trace.inputs[i], &by_h, &mut hidden_layers[i]);
        if i == network.skip_after + 1 {
            // What the input, put in front, got there.
            let hidden = by_h.split_off(inputs);
            by_input = std::mem::replace(&mut by_h, hidden);
        }
    }
    by_input.iter_mut().zip(&by_h).for_each(|(sum, by)| *sum += by);
    if let Some(net) = &network.time_network {
        let encoded = encoded_time(network.time_encoding, t);
        let by_features = &by_input[network.position_width()..];
        time_network_backward(net, &encoded, by_features, time_layers);
    }
}

/// What the forward pass went through.
struct Trace {
    /// What entered each hidden layer.
    inputs: Vec<Vec<f64>>,
    /// What left it, after the ReLU.
    outputs: Vec<Vec<f64>>,
    /// What entered the heads.
    last: Vec<f64>,
    /// Layers of the time network.
    time_layers: usize,
}

impl Trace {
    fn of(network: &DeformationNetwork, world: [f64; 3], t: f64) -> Self {
        let input = network_input(network, world, t);
        let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
        let mut h = input.clone();
        for (i, layer) in network.hidden.iter().enumerate() {
            let mut output = linear(layer, &h);
            rectify(&mut output);
            inputs.push(h);
            h = if i == network.skip_after {
                [&input[..], &output].concat()
            } else {
                output.clone()
            };
            outputs.push(output);
        }
        let time_layers = network.time_network.iter().len() * 2;
        Self { inputs, outputs, last: h, time_layers }
    }
}

/// The heads, in the order of the layers: displacement or screw, rotation, scale. Returns ∂L/∂h.
fn heads_backward(
    network: &DeformationNetwork,
    world: [f64; 3],
    h: &[f64],
    by_output: &NetworkOutput,
    gradients: &mut [LayerGradient],
) -> Vec<f64> {
    let position: Vec<(&Linear, [f64; 3])> = match &network.position_head {
        PositionHead::Translation(warp) => vec![(warp, by_output.displacement)],
        PositionHead::Screw { w, v } => {
            let axis = (three(&linear(w, h)), three(&linear(v, h)));
            let (by_w, by_v) = screw_backward(axis.0, axis.1, world, by_output.displacement);
            vec![(w, by_w), (v, by_v)]
        }
    };
    let rotation = (&network.rotation_head, &by_output.d_rotation[..]);
    let scale = (&network.scale_head, &by_output.d_scale[..]);
    let heads = position.iter().map(|(layer, by)| (*layer, &by[..])).chain([rotation, scale]);
    let mut by_h = vec![0.0; h.len()];
    for ((layer, by_y), gradient) in heads.zip(gradients) {
        let through = linear_backward(layer, h, by_y, gradient);
        by_h.iter_mut().zip(&through).for_each(|(sum, by)| *sum += by);
    }
    by_h
}

/// Adds ∂L/∂W = ∂L/∂y xᵀ and ∂L/∂b = ∂L/∂y; returns ∂L/∂x = Wᵀ ∂L/∂y.
///
/// An output without gradient adds nothing, whatever x and W are.
fn linear_backward(
    layer: &Linear,
    x: &[f64],
    by_y: &[f64],
    gradient: &mut LayerGradient,
) -> Vec<f64> {
    let mut by_x = vec![0.0; layer.inputs];
    let rows = layer.weight.chunks(layer.inputs).zip(gradient.weight.chunks_mut(layer.inputs));
    for (((row, by_row), by_bias), &by) in rows.zip(&mut gradient.bias).zip(by_y) {
        if by == 0.0 {
            continue;
        }
        *by_bias += by;
        for c in 0..layer.inputs {
            by_row[c] += by * x[c];
            by_x[c] += by * f64::from(row[c]);
        }
    }
    by_x
}

/// A feature that the ReLU held at 0 has no effect.
fn rectify_backward(output: &[f64], by: &mut [f64]) {
    for (by, &y) in by.iter_mut().zip(output) {
        if y == 0.0 {
            *by = 0.0;
        }
    }
}

/// Adds ∂L/∂(time network) from ∂L/∂(its features), for an encoded time.
pub(crate) fn time_network_backward(
    net: &TimeNetwork,
    encoded: &[f64],
    by_features: &[f64],
    gradients: &mut [LayerGradient],
) {
    let mut hidden = linear(&net.hidden, encoded);
    rectify(&mut hidden);
    let mut by_hidden = linear_backward(&net.output, &hidden, by_features, &mut gradients[1]);
    rectify_backward(&hidden, &mut by_hidden);
    linear_backward(&net.hidden, encoded, &by_hidden, &mut gradients[0]);
}

/// ∂L/∂w and ∂L/∂v from ∂L/∂(displacement), for a splat at `x`.
///
/// With the axis a = w/θ + ε, p = v/θ + ε and c = 1 − cos θ the displacement is
/// sin θ a×x + c a×(a×x) + (v + θ ε) + c a×p + (θ − sin θ) a×(a×p). Of a×b, with the gradient g, a
/// gets b×g and b gets g×a.
#[must_use]
pub(crate) fn screw_backward(
    w: [f64; 3],
    v: [f64; 3],
    x: [f64; 3],
    by_displacement: [f64; 3],
) -> ([f64; 3], [f64; 3]) {
    let [w, v, x, g] = [w, v, x, by_displacement].map(DVec3::from);
    let theta = w.length();
    if theta < f64::MIN_POSITIVE {
        // The limit: the displacement is v + w×x + ½ w×v, up to terms in θ².
        return ((x + 0.5 * v).cross(g).to_array(), g.to_array());
    }
    let (axis, pitch) = (w / theta + UPSTREAM_SCREW_OFFSET, v / theta + UPSTREAM_SCREW_OFFSET);
    let (sin, cos) = theta.sin_cos();
    let one_minus_cos = 2.0 * (theta / 2.0).sin().powi(2);
    let (axis_x, axis_pitch) = (axis.cross(x), axis.cross(pitch));
    let (square_x, square_pitch) = (axis.cross(axis_x), axis.cross(axis_pitch));

    let by_square_x = one_minus_cos * g;
    let by_axis_x = by_square_x.cross(axis) + sin * g;
    let by_square_pitch = (theta - sin) * g;
    let by_axis_pitch = by_square_pitch.cross(axis) + one_minus_cos * g;
    let by_axis = axis_x.cross(by_square_x)
        + x.cross(by_axis_x)
        + axis_pitch.cross(by_square_pitch)
        + pitch.cross(by_axis_pitch);
    let by_pitch = by_axis_pitch.cross(axis);
    let by_theta = cos * g.dot(axis_x)
        + sin * g.dot(square_x + axis_pitch)
        + one_minus_cos * g.dot(square_pitch)
        + g.dot(UPSTREAM_SCREW_OFFSET)
        - (by_axis.dot(w) + by_pitch.dot(v)) / (theta * theta);
    let by_w = by_axis / theta + by_theta * w / theta;
    (by_w.to_array(), (by_pitch / theta + g).to_array())
}

#[cfg(test)]
mod tests;
