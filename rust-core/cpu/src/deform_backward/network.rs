//! The network's own way back: ∂L/∂(its outputs) → ∂L/∂(weights and biases).
//!
//! Activations are computed once more, as dense matrices of a batch of splats, instead of being
//! kept from the forward pass: 9 KB a splat that nobody has to hold. Every product here needs all
//! the features of a batch (∂L/∂W = δᵀ h sums over splats whose zeros lie in different places), so
//! unlike in the forward pass a general matrix product is the right tool.
//!
//! Splats are dealt to at most [`LANES`] sums, which are added in their order: the bits do not
//! depend on the number of threads. The specification is
//! [`reference::network_gradient`](crate::reference::network_gradient).

use std::ops::Range;

use fearless_simd::Level;
use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, s};
use rayon::prelude::*;
use trapeze_scene::DeformationNetwork;
use trapeze_scene::deformation::{Linear, PositionHead};

use crate::deform::encode_positions;
use crate::reference::deform::{encoded_time, time_features};
use crate::reference::{NetworkGradient, screw_backward, time_network_backward};

/// ∂L/∂(what the network adds to one splat): displacement (3), rotation (4), linear scale (3).
pub(crate) type OutputGradient = [f32; 10];

/// Splats that get their gradient at one time.
#[derive(Clone, Debug, Default)]
pub(crate) struct MovedSplats {
    /// World positions.
    pub(crate) positions: Vec<[f64; 3]>,
    /// Gradients by their outputs.
    pub(crate) by_outputs: Vec<OutputGradient>,
}

/// Rows of a matrix product: its operands stay in the second-level cache.
const BATCH: usize = 128;
/// Sums over splats that are made side by side; each takes as much memory as the network.
const LANES: usize = 16;
/// Numbers that one task adds up over the lanes.
const CHUNK: usize = 8192;

/// Adds ∂L/∂(weights and biases) at time `t` to `by_network`, in the order of
/// [`DeformationNetwork::layers`], the weight of each layer (row-major) before its bias.
pub(crate) fn network_backward(
    level: Level,
    network: &DeformationNetwork,
    t: f64,
    splats: &MovedSplats,
    by_network: &mut [f32],
) {
    let layout = Layout::of(network);
    let features = time_features(network.time_encoding, network.time_network.as_ref(), t);
    let time_row: Vec<f32> = features.iter().map(|&x| x as f32).collect();
    let length = splats.positions.len().div_ceil(LANES).max(BATCH);
    let add_lane = |batch: &mut Batch, (positions, by_outputs): (&[_], &[_])| {
        let mut sum = vec![0.0; layout.numbers];
        for (positions, by_outputs) in positions.chunks(BATCH).zip(by_outputs.chunks(BATCH)) {
            batch.encode(level, network, positions, &time_row);
            batch.evaluate(network);
            batch.set_head_gradients(network, positions, by_outputs);
            batch.carry_back(network, &layout, &mut sum);
        }
        sum
    };
    let lanes: Vec<Vec<f32>> = splats
        .positions
        .par_chunks(length)
        .zip(splats.by_outputs.par_chunks(length))
        .map_init(|| Batch::new(network), add_lane)
        .collect();
    by_network.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, to)| {
        for lane in &lanes {
            let from = &lane[chunk * CHUNK..][..to.len()];
            to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        }
    });
    add_time_network(network, &layout, t, &lanes, by_network);
}

/// The time network sees one time, so the sum over the splats goes through it: ∂L/∂features =
/// Σ Wᵀ ∂L/∂b over the two layers that they enter.
fn add_time_network(
    network: &DeformationNetwork,
    layout: &Layout,
    t: f64,
    lanes: &[Vec<f32>],
    by_network: &mut [f32],
) {
    let Some(net) = &network.time_network else { return };
    let mut by_features = vec![0.0; network.time_width()];
    for i in [0, network.skip_after + 1] {
        let layer = &network.hidden[i];
        for (output, row) in layer.weight.chunks_exact(layer.inputs).enumerate() {
            let place = layout.hidden(i).bias.start + output;
            let by_sum: f64 = lanes.iter().map(|lane| f64::from(lane[place])).sum();
            let row = &row[network.position_width()..network.input_width()];
            for (by, &w) in by_features.iter_mut().zip(row) {
                *by += by_sum * f64::from(w);
            }
        }
    }
    let encoded = encoded_time(network.time_encoding, t);
    let mut gradient = NetworkGradient::zeros(network);
    time_network_backward(net, &encoded, &by_features, &mut gradient.layers[..2]);
    for (place, gradient) in layout.places.iter().zip(&gradient.layers[..2]) {
        for (range, from) in [(&place.weight, &gradient.weight), (&place.bias, &gradient.bias)] {
            let to = by_network[range.clone()].iter_mut();
            to.zip(from).for_each(|(to, &from)| *to += from as f32);
        }
    }
}

/// Where the numbers of each layer are among all of them.
struct Layout {
    /// In the order of [`DeformationNetwork::layers`].
    places: Vec<Place>,
    /// Layers in front of the hidden ones.
    time_layers: usize,
    numbers: usize,
}

struct Place {
    weight: Range<usize>,
    bias: Range<usize>,
}

impl Layout {
    fn of(network: &DeformationNetwork) -> Self {
        let mut numbers = 0;
        let mut take = |count: usize| {
            numbers += count;
            numbers - count..numbers
        };
        let mut place =
            |l: &Linear| Place { weight: take(l.weight.len()), bias: take(l.bias.len()) };
        let places = network.layers().map(&mut place).collect();
        Self { places, time_layers: network.time_network.iter().len() * 2, numbers }
    }

    fn hidden(&self, i: usize) -> &Place {
        &self.places[self.time_layers + i]
    }

    fn heads(&self, network: &DeformationNetwork) -> &[Place] {
        &self.places[self.time_layers + network.hidden.len()..]
    }
}

/// The heads in the order of the layers.
fn heads(network: &DeformationNetwork) -> Vec<&Linear> {
    let mut heads = match &network.position_head {
        PositionHead::Translation(warp) => vec![warp],
        PositionHead::Screw { w, v } => vec![w, v],
    };
    heads.extend([&network.rotation_head, &network.scale_head]);
    heads
}

/// Columns of hidden layer `i` that multiply the output of the layer before it.
fn hidden_columns(network: &DeformationNetwork, i: usize) -> Range<usize> {
    let inputs = network.hidden[i].inputs;
    let hidden = if i == 0 { 0 } else { network.width() };
    inputs - hidden..inputs
}

/// Whether the input of the network enters hidden layer `i`.
fn takes_input(network: &DeformationNetwork, i: usize) -> bool {
    i == 0 || i == network.skip_after + 1
}

/// Up to [`BATCH`] splats on their way through the network and back; one row each.
struct Batch {
    rows: usize,
    /// [γ(xyz), time features].
    input: Array2<f32>,
    /// Output of each hidden layer, after the ReLU.
    outputs: Vec<Array2<f32>>,
    /// ∂L/∂(output of the heads), side by side.
    by_heads: Array2<f32>,
    /// ∂L/∂(output of the layer in work), and of the one before it.
    by_output: Array2<f32>,
    by_previous: Array2<f32>,
}

impl Batch {
    fn new(network: &DeformationNetwork) -> Self {
        let zeros = |columns: usize| Array2::zeros((BATCH, columns));
        Self {
            rows: 0,
            input: zeros(network.input_width()),
            outputs: network.hidden.iter().map(|layer| zeros(layer.outputs)).collect(),
            by_heads: zeros(heads(network).iter().map(|head| head.outputs).sum()),
            by_output: zeros(network.width()),
            by_previous: zeros(network.width()),
        }
    }

    fn encode(
        &mut self,
        level: Level,
        network: &DeformationNetwork,
        positions: &[[f64; 3]],
        time_row: &[f32],
    ) {
        self.rows = positions.len();
        encode_positions(level, network.position_encoding, positions, |s, encoded| {
            let mut row = self.input.row_mut(s);
            let values = encoded.iter().chain(time_row);
            row.iter_mut().zip(values).for_each(|(to, &from)| *to = from);
        });
    }

    /// The forward pass over the hidden layers.
    fn evaluate(&mut self, network: &DeformationNetwork) {
        let rows = self.rows;
        let inputs = network.input_width();
        let input = self.input.slice(s![..rows, ..]);
        for (i, layer) in network.hidden.iter().enumerate() {
            let (before, from_here) = self.outputs.split_at_mut(i);
            let mut output = from_here[0].slice_mut(s![..rows, ..]);
            output.rows_mut().into_iter().for_each(|mut row| {
                row.iter_mut().zip(&layer.bias).for_each(|(to, &bias)| *to = bias);
            });
            let weight = matrix(layer);
            if takes_input(network, i) {
                let weight = weight.slice(s![.., ..inputs]);
                general_mat_mul(1.0, &input, &weight.t(), 1.0, &mut output);
            }
            if let Some(previous) = before.last() {
                let weight = weight.slice(s![.., hidden_columns(network, i)]);
                let previous = previous.slice(s![..rows, ..]);
                general_mat_mul(1.0, &previous, &weight.t(), 1.0, &mut output);
            }
            // NaN → 0, as in the forward pass.
            output.mapv_inplace(|x| if x > 0.0 { x } else { 0.0 });
        }
    }

    /// ∂L/∂(output of the heads): the outputs themselves, or for a screw what made them.
    fn set_head_gradients(
        &mut self,
        network: &DeformationNetwork,
        positions: &[[f64; 3]],
        by_outputs: &[OutputGradient],
    ) {
        let PositionHead::Screw { w, v } = &network.position_head else {
            for (mut row, by) in self.by_heads.rows_mut().into_iter().zip(by_outputs) {
                row.iter_mut().zip(by).for_each(|(to, &from)| *to = from);
            }
            return;
        };
        let last = &self.outputs[network.hidden.len() - 1];
        for (s, (&position, by)) in positions.iter().zip(by_outputs).enumerate() {
            let h = last.row(s);
            let evaluate = |head: &Linear| -> [f64; 3] {
                std::array::from_fn(|o| {
                    let row = &head.weight[o * head.inputs..(o + 1) * head.inputs];
                    let products = row.iter().zip(h).map(|(&w, &x)| f64::from(w) * f64::from(x));
                    f64::from(head.bias[o]) + products.sum::<f64>()
                })
            };
            let by_displacement = std::array::from_fn(|c| f64::from(by[c]));
            let (by_w, by_v) = screw_backward(evaluate(w), evaluate(v), position, by_displacement);
            let screw = by_w.into_iter().chain(by_v).map(|g| g as f32);
            let values = screw.chain(by[3..].iter().copied());
            self.by_heads.row_mut(s).iter_mut().zip(values).for_each(|(to, from)| *to = from);
        }
    }

    /// Adds the batch's part of ∂L/∂(weights and biases) to `sum`.
    fn carry_back(&mut self, network: &DeformationNetwork, layout: &Layout, sum: &mut [f32]) {
        let rows = self.rows;
        let last = self.outputs[network.hidden.len() - 1].slice(s![..rows, ..]);
        let mut by_last = self.by_output.slice_mut(s![..rows, ..]);
        by_last.fill(0.0);
        let mut column = 0;
        for (head, place) in heads(network).into_iter().zip(layout.heads(network)) {
            let by = self.by_heads.slice(s![..rows, column..column + head.outputs]);
            column += head.outputs;
            add_bias_gradient(&by, &mut sum[place.bias.clone()]);
            let mut by_weight = matrix_mut(head, &mut sum[place.weight.clone()]);
            general_mat_mul(1.0, &by.t(), &last, 1.0, &mut by_weight);
            general_mat_mul(1.0, &by, &matrix(head), 1.0, &mut by_last);
        }
        for (i, layer) in network.hidden.iter().enumerate().rev() {
            let mut by = self.by_output.slice_mut(s![..rows, ..]);
            by.zip_mut_with(&self.outputs[i].slice(s![..rows, ..]), |by, &y| {
                *by = if y > 0.0 { *by } else { 0.0 };
            });
            let place = layout.hidden(i);
            add_bias_gradient(&by.view(), &mut sum[place.bias.clone()]);
            let mut by_weight = matrix_mut(layer, &mut sum[place.weight.clone()]);
            if takes_input(network, i) {
                let input = self.input.slice(s![..rows, ..]);
                let mut by_weight = by_weight.slice_mut(s![.., ..network.input_width()]);
                general_mat_mul(1.0, &by.t(), &input, 1.0, &mut by_weight);
            }
            if i > 0 {
                let columns = hidden_columns(network, i);
                let previous = self.outputs[i - 1].slice(s![..rows, ..]);
                let mut by_weight = by_weight.slice_mut(s![.., columns.clone()]);
                general_mat_mul(1.0, &by.t(), &previous, 1.0, &mut by_weight);
                let weight = matrix(layer);
                let mut by_previous = self.by_previous.slice_mut(s![..rows, ..]);
                general_mat_mul(1.0, &by, &weight.slice(s![.., columns]), 0.0, &mut by_previous);
                std::mem::swap(&mut self.by_output, &mut self.by_previous);
            }
        }
    }
}

/// A layer's weight as outputs × inputs.
fn matrix(layer: &Linear) -> ArrayView2<'_, f32> {
    ArrayView2::from_shape((layer.outputs, layer.inputs), &layer.weight)
        .expect("a layer's weight has outputs × inputs numbers")
}

/// The place of a layer's gradient in the same form.
fn matrix_mut<'a>(layer: &Linear, numbers: &'a mut [f32]) -> ArrayViewMut2<'a, f32> {
    ArrayViewMut2::from_shape((layer.outputs, layer.inputs), numbers)
        .expect("a layer's weight has outputs × inputs numbers")
}

/// Adds the sum over the rows.
fn add_bias_gradient(by: &ArrayView2<'_, f32>, sum: &mut [f32]) {
    for row in by.rows() {
        sum.iter_mut().zip(row).for_each(|(sum, by)| *sum += by);
    }
}
