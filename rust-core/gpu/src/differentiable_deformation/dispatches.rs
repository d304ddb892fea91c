//! Both passes as lists of dispatches: recorded one after the other into one pass, or each into a
//! pass of its own, to be timed.

use super::bindings::{BackwardBindings, ForwardBindings, LayerBindings};
use super::chunk::Chunk;
use super::kernels::{DeformationKernels, Stage};
use super::network_layout::{NetworkLayout, TILE};
use crate::kernel::folded;
use crate::layout::NetworkLayer;

/// One dispatch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dispatch<'a> {
    pub(super) stage: Stage,
    bind_group: &'a wgpu::BindGroup,
    /// The chunk whose uniform block it reads.
    chunk: Option<Chunk>,
    groups: (u32, u32, u32),
}

impl Dispatch<'_> {
    pub(super) fn record(&self, kernels: &DeformationKernels, pass: &mut wgpu::ComputePass<'_>) {
        let offset = self.chunk.map(Chunk::offset);
        pass.set_pipeline(&kernels.of(self.stage).pipeline);
        pass.set_bind_group(0, self.bind_group, offset.as_slice());
        let (x, y, z) = self.groups;
        pass.dispatch_workgroups(x, y, z);
    }
}

/// The layers of a network, and what they bind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layers<'a> {
    pub(super) layers: &'a [NetworkLayer],
    pub(super) bindings: &'a [LayerBindings],
}

/// Splats to deformed splats, chunk by chunk, and those that rest.
pub(super) fn forward<'a>(
    layers: Layers<'a>,
    splats: &'a ForwardBindings,
    chunks: &[Chunk],
    resting: Chunk,
) -> Vec<Dispatch<'a>> {
    let mut list = Vec::new();
    for &chunk in chunks {
        push_hidden(&mut list, layers, splats, chunk);
        list.push(Dispatch {
            stage: Stage::Apply,
            bind_group: &splats.apply,
            chunk: Some(chunk),
            groups: folded(chunk.splats.div_ceil(64)),
        });
    }
    push_resting(&mut list, Stage::Hold, &splats.hold, resting);
    list
}

/// Gradients by deformed splats to those by splats and parameters; the activations at hand are those
/// of the last chunk.
pub(super) fn backward<'a>(
    layers: Layers<'a>,
    splats: &'a ForwardBindings,
    gradients: &'a BackwardBindings,
    chunks: &[Chunk],
    resting: Chunk,
) -> Vec<Dispatch<'a>> {
    let mut list = Vec::new();
    push_resting(&mut list, Stage::HoldBackward, &gradients.hold, resting);
    for &chunk in chunks.iter().rev() {
        if chunk.index + 1 < chunks.len() as u32 {
            push_hidden(&mut list, layers, splats, chunk);
        }
        list.push(Dispatch {
            stage: Stage::ApplyBackward,
            bind_group: &gradients.apply,
            chunk: Some(chunk),
            groups: folded(chunk.columns.div_ceil(64)),
        });
        for (layer, bound) in layers.layers.iter().zip(layers.bindings).rev() {
            push_layer_backward(&mut list, layer, bound, chunk);
        }
    }
    list
}

/// One thread for each splat that rests.
fn push_resting<'a>(
    list: &mut Vec<Dispatch<'a>>,
    stage: Stage,
    bind_group: &'a wgpu::BindGroup,
    resting: Chunk,
) {
    if resting.splats > 0 {
        let groups = folded(resting.splats.div_ceil(64));
        list.push(Dispatch { stage, bind_group, chunk: Some(resting), groups });
    }
}

/// γ and the hidden layers of a chunk.
fn push_hidden<'a>(
    list: &mut Vec<Dispatch<'a>>,
    layers: Layers<'a>,
    splats: &'a ForwardBindings,
    chunk: Chunk,
) {
    list.push(Dispatch {
        stage: Stage::Encode,
        bind_group: &splats.encode,
        chunk: Some(chunk),
        groups: folded(chunk.columns.div_ceil(64)),
    });
    let hidden = layers.layers.len() - 1;
    for (layer, bound) in layers.layers.iter().zip(layers.bindings).take(hidden) {
        list.push(Dispatch {
            stage: Stage::Layer,
            bind_group: &bound.forward,
            chunk: None,
            groups: (layer.outputs.div_ceil(TILE), chunk.columns / TILE, 1),
        });
    }
}

/// The way back through one layer, whose outputs have their gradients.
fn push_layer_backward<'a>(
    list: &mut Vec<Dispatch<'a>>,
    layer: &NetworkLayer,
    bound: &'a LayerBindings,
    chunk: Chunk,
) {
    let tiles = layer.outputs.div_ceil(TILE) * layer.inputs.div_ceil(TILE);
    // The twin of `sum_parts` in common/network.wgsl.
    let parts = (chunk.steps() / 4).clamp(1, layer.most_parts);
    let vectors = NetworkLayout::layer_floats(layer) as u32 / 4;
    list.push(Dispatch {
        stage: Stage::WeightsBackward,
        bind_group: &bound.weights_backward,
        chunk: Some(chunk),
        groups: (tiles, parts, 1),
    });
    list.push(Dispatch {
        stage: Stage::WeightsSum,
        bind_group: &bound.weights_sum,
        chunk: Some(chunk),
        groups: folded(vectors.div_ceil(64)),
    });
    let hidden_inputs = layer.inputs - layer.encoded_inputs;
    if hidden_inputs > 0 {
        list.push(Dispatch {
            stage: Stage::LayerBackward,
            bind_group: &bound.backward,
            chunk: None,
            groups: (hidden_inputs.div_ceil(TILE), chunk.columns / TILE, 1),
        });
    }
}
