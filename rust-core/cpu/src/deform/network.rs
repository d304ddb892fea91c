//! The deformation network, arranged for evaluation frame after frame.
//!
//! The input [γ(xyz), time] enters layer 0 and the layer after the skip. Its two parts are summed
//! apart: what depends on the position alone can be kept for the whole scene, what depends on the
//! time alone is computed once per frame.

use fearless_simd::prelude::*;
use fearless_simd_macros::simd;
use trapeze_scene::DeformationNetwork;
use trapeze_scene::deformation::{Encoding, Linear, PositionHead, TimeNetwork};

use super::encoding::encode_group;
use super::group::{Activations, BLOCK, GROUP, Group, Row, blocks, to_rows};
use super::layer::{Activation, PackedLayer, Start, apply_layer};
use crate::reference::deform::time_features;

/// Outputs of the heads, in this order: displacement (3) or screw axis (6), rotation (4), scale (3).
pub(super) const MAX_HEAD_OUTPUTS: usize = 13;

/// Splats that go through the network layer by layer: with eight groups their activations take a
/// quarter of a megabyte, and the weights of one layer another.
pub(super) const BATCH: usize = 8 * GROUP;

/// What the heads say about one splat.
pub(super) type HeadOutputs = [f32; MAX_HEAD_OUTPUTS];

/// A network with packed weights.
#[derive(Clone, Debug)]
pub(super) struct PackedNetwork {
    position_encoding: Encoding,
    hidden_blocks: usize,
    width: usize,
    /// γ(xyz) → sums of layer 0 and of the layer after the skip.
    position_layers: [PackedLayer; 2],
    /// Time features → sums of the same two layers, with their biases.
    time_layers: [Linear; 2],
    /// Layer 0 has nothing but these sums.
    first: PackedLayer,
    layers: Vec<HiddenLayer>,
    heads: PackedLayer,
    head_bias: Vec<Row>,
    time_encoding: Encoding,
    time_network: Option<TimeNetwork>,
    zeros: Vec<Group>,
    zero_bias: Vec<Row>,
}

#[derive(Clone, Debug)]
struct HiddenLayer {
    weights: PackedLayer,
    bias: Vec<Row>,
    after_skip: bool,
}

/// The part of the two input sums that the time gives, biases included.
#[derive(Clone, Debug)]
pub(super) struct TimeTerms([Vec<Row>; 2]);

/// Working memory of a few groups that go through the network layer by layer, so that a layer's
/// weights are read once for all of them.
#[derive(Debug)]
pub(super) struct Scratch {
    groups: Vec<GroupScratch>,
    encoded: Activations,
    heads: Activations,
    no_input: Activations,
}

#[derive(Debug)]
struct GroupScratch {
    /// The part of the two input sums that the position gives.
    position_terms: [Activations; 2],
    /// Input and output of the layer in work.
    hidden: [Activations; 2],
}

impl Scratch {
    /// Keeps the position terms of splat `s`.
    pub(super) fn store_position_terms(&self, s: usize, kept: &mut [Row]) {
        let terms = &self.groups[s / GROUP].position_terms;
        let groups = terms.iter().flat_map(|terms| &terms.rows);
        kept.iter_mut().zip(groups).for_each(|(row, group)| *row = group[s % GROUP]);
    }

    /// Sets the position terms of splat `s`.
    pub(super) fn load_position_terms(&mut self, s: usize, kept: &[Row]) {
        let terms = &mut self.groups[s / GROUP].position_terms;
        let groups = terms.iter_mut().flat_map(|terms| &mut terms.rows);
        kept.iter().zip(groups).for_each(|(row, group)| group[s % GROUP] = *row);
    }
}

impl PackedNetwork {
    pub(super) fn new(network: &DeformationNetwork) -> Self {
        let positions = 0..network.position_width();
        let times = positions.end..network.input_width();
        let inputs = network.input_width();
        let first = &network.hidden[0];
        let skip = &network.hidden[network.skip_after + 1];
        let layers = network.hidden.iter().enumerate().skip(1).map(|(i, layer)| {
            let after_skip = i == network.skip_after + 1;
            let columns = if after_skip { inputs..layer.inputs } else { 0..layer.inputs };
            HiddenLayer {
                weights: PackedLayer::pack(&layer.weight, layer.inputs, columns),
                bias: to_rows(&layer.bias),
                after_skip,
            }
        });
        let (head_weight, head_bias) = fuse_heads(network);
        let width = network.width();
        Self {
            position_encoding: network.position_encoding,
            hidden_blocks: blocks(width),
            width,
            position_layers: [first, skip]
                .map(|layer| PackedLayer::pack(&layer.weight, layer.inputs, positions.clone())),
            time_layers: [first, skip].map(|layer| select_columns(layer, times.clone())),
            first: PackedLayer::without_inputs(width),
            layers: layers.collect(),
            heads: PackedLayer::pack(&head_weight, width, 0..width),
            head_bias: to_rows(&head_bias),
            time_encoding: network.time_encoding,
            time_network: network.time_network.clone(),
            zeros: vec![[[0.0; BLOCK]; GROUP]; blocks(width)],
            zero_bias: vec![[0.0; BLOCK]; blocks(width)],
        }
    }

    /// Rows that the position terms of one splat take: two sums of the hidden width.
    pub(super) fn position_term_rows(&self) -> usize {
        2 * self.hidden_blocks
    }

    /// Working memory for [`BATCH`] splats.
    pub(super) fn scratch(&self) -> Scratch {
        let hidden = || [Activations::new(self.width), Activations::new(self.width)];
        let group = || GroupScratch { position_terms: hidden(), hidden: hidden() };
        Scratch {
            groups: std::iter::repeat_with(group).take(BATCH / GROUP).collect(),
            encoded: Activations::new(self.position_encoding.width()),
            heads: Activations::new(MAX_HEAD_OUTPUTS),
            no_input: Activations::new(0),
        }
    }

    /// The time's part of a frame, once for all splats.
    pub(super) fn time_terms(&self, t: f64) -> TimeTerms {
        // A few thousand products per frame: the specification itself is fast enough.
        let features = time_features(self.time_encoding, self.time_network.as_ref(), t);
        TimeTerms(self.time_layers.each_ref().map(|layer| {
            let sums = layer.weight.chunks_exact(layer.inputs).zip(&layer.bias).map(|(row, &b)| {
                let products = row.iter().zip(&features).map(|(&w, x)| f64::from(w) * x);
                (f64::from(b) + products.sum::<f64>()) as f32
            });
            to_rows(&sums.collect::<Vec<f32>>())
        }))
    }

    /// Computes the position terms of up to [`BATCH`] splats at these world positions.
    #[simd]
    pub(super) fn position_terms<S: Simd>(
        &self,
        simd: S,
        positions: &[[f64; 3]],
        scratch: &mut Scratch,
    ) {
        let Scratch { groups, encoded, .. } = scratch;
        for (positions, group) in positions.chunks(GROUP).zip(groups) {
            encode_group(simd, self.position_encoding, positions, &mut encoded.rows[0]);
            let start = Start { own: &self.zeros, shared: &self.zero_bias };
            for (layer, terms) in self.position_layers.iter().zip(&mut group.position_terms) {
                apply_layer(simd, layer, encoded, start, Activation::None, terms);
            }
        }
    }

    /// Evaluates up to [`BATCH`] splats whose position terms are in `scratch`.
    #[simd]
    pub(super) fn evaluate<S: Simd>(
        &self,
        simd: S,
        time: &TimeTerms,
        scratch: &mut Scratch,
        outputs: &mut [HeadOutputs],
    ) {
        let Scratch { groups, heads, no_input, .. } = scratch;
        let groups = &mut groups[..outputs.len().div_ceil(GROUP)];
        for GroupScratch { position_terms, hidden: [h, _] } in &mut *groups {
            let start = Start { own: &position_terms[0].rows, shared: &time.0[0] };
            apply_layer(simd, &self.first, no_input, start, Activation::Relu, h);
        }
        for layer in &self.layers {
            for GroupScratch { position_terms, hidden: [h, next] } in &mut *groups {
                let start = if layer.after_skip {
                    Start { own: &position_terms[1].rows, shared: &time.0[1] }
                } else {
                    Start { own: &self.zeros, shared: &layer.bias }
                };
                apply_layer(simd, &layer.weights, h, start, Activation::Relu, next);
                std::mem::swap(h, next);
            }
        }
        let start = Start { own: &self.zeros, shared: &self.head_bias };
        for (group, outputs) in groups.iter().zip(outputs.chunks_mut(GROUP)) {
            apply_layer(simd, &self.heads, &group.hidden[0], start, Activation::None, heads);
            for (row, outputs) in heads.rows[0].iter().zip(outputs) {
                outputs.copy_from_slice(&row[..MAX_HEAD_OUTPUTS]);
            }
        }
    }
}

/// Weights and biases of all heads, one below the other.
fn fuse_heads(network: &DeformationNetwork) -> (Vec<f32>, Vec<f32>) {
    let position: &[&Linear] = match &network.position_head {
        PositionHead::Translation(warp) => &[warp],
        PositionHead::Screw { w, v } => &[w, v],
    };
    let heads = || position.iter().copied().chain([&network.rotation_head, &network.scale_head]);
    let weight = heads().flat_map(|head| &head.weight).copied().collect();
    let bias = heads().flat_map(|head| &head.bias).copied().collect();
    (weight, bias)
}

fn select_columns(layer: &Linear, columns: std::ops::Range<usize>) -> Linear {
    let rows = layer.weight.chunks_exact(layer.inputs);
    Linear {
        inputs: columns.len(),
        outputs: layer.outputs,
        weight: rows.flat_map(|row| &row[columns.clone()]).copied().collect(),
        bias: layer.bias.clone(),
    }
}
