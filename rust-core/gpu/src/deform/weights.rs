//! The deformation network packed for the kernels: transposed, padded, and with what depends on
//! the time alone taken out.

use trapeze_scene::DeformationNetwork;
use trapeze_scene::deformation::{Linear, PositionHead, TimeNetwork};

use crate::GpuError;

/// Outputs of all heads, padded.
pub(crate) const HEAD_OUTPUTS: usize = 16;
/// Hidden widths are padded to a multiple of this.
const WIDTH_STEP: usize = 64;
/// Widest hidden layer that the kernels hold in workgroup memory.
const MAX_WIDTH: usize = 256;
/// Rows for γ(xyz) are padded to a multiple of this.
const INPUT_STEP: usize = 16;

/// A network in the layout of deform.wgsl.
#[derive(Clone, Debug)]
pub(crate) struct PackedWeights {
    /// Padded width of the hidden layers.
    pub width: usize,
    /// Padded width of γ(xyz).
    pub input_rows: usize,
    /// Hidden layers.
    pub depth: usize,
    /// Layer that also takes γ(xyz), besides layer 0.
    pub skip_layer: usize,
    /// Rows of `width` weights, then rows of 16 for the heads.
    pub weights: Vec<f32>,
    /// `width` biases per layer, then 16; those of layer 0 and of the skip layer lack what
    /// [`time_biases`](Self::time_biases) adds.
    pub biases: Vec<f32>,
    /// Biases in double precision, and weights of the time features, of layer 0 and of the skip
    /// layer: outputs × (1 + time features).
    time_parts: [Vec<f64>; 2],
    time_width: usize,
    network: TimeInputs,
}

/// What is needed to compute the time features.
#[derive(Clone, Debug)]
struct TimeInputs {
    encoding: trapeze_scene::deformation::Encoding,
    network: Option<TimeNetwork>,
}

impl PackedWeights {
    pub(crate) fn new(network: &DeformationNetwork) -> Result<Self, GpuError> {
        let width = network.width().next_multiple_of(WIDTH_STEP);
        if width > MAX_WIDTH {
            return Err(GpuError::Network {
                what: "width of the hidden layers",
                most: MAX_WIDTH,
                found: network.width(),
            });
        }
        let position_width = network.position_width();
        let time_width = network.time_width();
        let input_rows = position_width.next_multiple_of(INPUT_STEP);
        let skip_layer = network.skip_after + 1;
        let mut weights = Vec::new();
        let mut biases = Vec::new();
        for (i, layer) in network.hidden.iter().enumerate() {
            // Columns in the file: [γ(xyz), time] in layer 0, [γ(xyz), time, h] in the skip layer.
            let hidden_columns = match i {
                0 => 0..0,
                i if i == skip_layer => position_width + time_width..layer.inputs,
                _ => 0..layer.inputs,
            };
            if i > 0 {
                push_rows(&mut weights, layer, hidden_columns, width, width);
            }
            if i == 0 || i == skip_layer {
                push_rows(&mut weights, layer, 0..position_width, input_rows, width);
            }
            biases.extend_from_slice(&layer.bias);
            biases.resize((i + 1) * width, 0.0);
        }
        push_heads(&mut weights, &mut biases, network, width);
        let time_part =
            |layer: usize| time_part(&network.hidden[layer], position_width, time_width);
        Ok(Self {
            width,
            input_rows,
            depth: network.hidden.len(),
            skip_layer,
            weights,
            biases,
            time_parts: [time_part(0), time_part(skip_layer)],
            time_width,
            network: TimeInputs {
                encoding: network.time_encoding,
                network: network.time_network.clone(),
            },
        })
    }

    /// Biases of layer 0 and of the skip layer at time `t`: b + W_t · (time features), in double
    /// precision before rounding.
    pub(crate) fn time_biases(&self, t: f64) -> [Vec<f32>; 2] {
        let features = self.network.features(t);
        self.time_parts.each_ref().map(|part| {
            let mut biases: Vec<f32> = part
                .chunks_exact(1 + self.time_width)
                .map(|row| {
                    let sum: f64 = row[1..].iter().zip(&features).map(|(w, f)| w * f).sum();
                    (row[0] + sum) as f32
                })
                .collect();
            biases.resize(self.width, 0.0);
            biases
        })
    }
}

impl TimeInputs {
    /// γ(t), or the time network's answer to it.
    fn features(&self, t: f64) -> Vec<f64> {
        let mut encoded = vec![0.0; self.encoding.width()];
        self.encoding.encode(&[t], &mut encoded);
        match &self.network {
            None => encoded,
            Some(network) => {
                let mut hidden = linear(&network.hidden, &encoded);
                hidden.iter_mut().for_each(|h| *h = h.max(0.0));
                linear(&network.output, &hidden)
            }
        }
    }
}

fn linear(layer: &Linear, x: &[f64]) -> Vec<f64> {
    layer
        .weight
        .chunks_exact(layer.inputs)
        .zip(&layer.bias)
        .map(|(row, &bias)| {
            f64::from(bias) + row.iter().zip(x).map(|(&w, x)| f64::from(w) * x).sum::<f64>()
        })
        .collect()
}

/// Appends `rows` rows, one per column of the layer in `columns`, each with the weights of all
/// outputs and zeros up to `width`; rows without a column are zero.
fn push_rows(
    weights: &mut Vec<f32>,
    layer: &Linear,
    columns: std::ops::Range<usize>,
    rows: usize,
    width: usize,
) {
    let first = weights.len();
    weights.resize(first + rows * width, 0.0);
    for (row, column) in columns.enumerate() {
        for output in 0..layer.outputs {
            weights[first + row * width + output] = layer.weight[output * layer.inputs + column];
        }
    }
}

fn push_heads(
    weights: &mut Vec<f32>,
    biases: &mut Vec<f32>,
    network: &DeformationNetwork,
    width: usize,
) {
    let position: Vec<&Linear> = match &network.position_head {
        PositionHead::Translation(warp) => vec![warp],
        PositionHead::Screw { w, v } => vec![w, v],
    };
    let heads = position.into_iter().chain([&network.rotation_head, &network.scale_head]);
    let (first, first_bias) = (weights.len(), biases.len());
    weights.resize(first + width * HEAD_OUTPUTS, 0.0);
    biases.resize(first_bias + HEAD_OUTPUTS, 0.0);
    let mut output = 0;
    for head in heads {
        for (row, &bias) in head.weight.chunks_exact(head.inputs).zip(&head.bias) {
            for (k, &weight) in row.iter().enumerate() {
                weights[first + k * HEAD_OUTPUTS + output] = weight;
            }
            biases[first_bias + output] = bias;
            output += 1;
        }
    }
}

fn time_part(layer: &Linear, position_width: usize, time_width: usize) -> Vec<f64> {
    layer
        .weight
        .chunks_exact(layer.inputs)
        .zip(&layer.bias)
        .flat_map(|(row, &bias)| {
            let time = &row[position_width..position_width + time_width];
            std::iter::once(bias).chain(time.iter().copied()).map(f64::from)
        })
        .collect()
}
