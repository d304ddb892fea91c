//! Where the parameters and the activations of a network are on the device.

use trapeze_scene::DeformationNetwork;
use trapeze_scene::deformation::{Encoding, PositionHead, RotationRule};

use crate::GpuError;
use crate::layout::{NetworkChunk, NetworkLayer};

/// Rows and columns of a tile, as in common/matrix_tile.wgsl.
pub(super) const TILE: u32 = 128;
/// Indices of a sum that a tile takes at a time, likewise.
pub(super) const STEP: u32 = 16;
/// Workgroups that the sum over splats of a layer's weights is cut into, about: two for each core of
/// the largest GPUs.
const SUM_WORKGROUPS: u32 = 256;
/// Outputs of the heads (displacement 3, rotation 4, scale 3), and as many as are computed.
const HEAD_OUTPUTS: usize = 10;
const PADDED_HEAD_OUTPUTS: usize = 12;

/// The layers of a network that the kernels train: the hidden ones, then the heads stacked to one.
///
/// The parameters on the device are those of `weights.bin` up to the heads; then the weights of all
/// heads, padded with zeros to twelve outputs, and their biases likewise. So every matrix starts at,
/// and has rows of, a multiple of four floats.
#[derive(Clone, Debug)]
pub(super) struct NetworkLayout {
    /// With `row_vectors` still 0.
    pub(super) layers: Vec<NetworkLayer>,
    /// Floats on the device.
    pub(super) parameters: usize,
    /// Rows of the activations.
    pub(super) rows: u32,
    encoding_row: u32,
    octaves: u32,
    time_encoding: Encoding,
    /// Parameters of the hidden layers.
    hidden: usize,
    width: usize,
}

impl NetworkLayout {
    pub(super) fn new(network: &DeformationNetwork) -> Result<Self, GpuError> {
        check(network)?;
        let (width, inputs) = (network.width() as u32, network.input_width() as u32);
        let skip = network.skip_after as u32;
        let encoding_row = skip * width;
        let row_of = |layer: u32| layer * width + if layer < skip { 0 } else { inputs };
        let mut at = 0;
        let mut layers = Vec::new();
        let hidden = (0..network.hidden.len() as u32).map(|i| {
            let (taken, encoded_inputs, input_row) = match i {
                0 => (inputs, inputs, encoding_row),
                i if i == skip + 1 => (inputs + width, inputs, encoding_row),
                i => (width, 0, row_of(i - 1)),
            };
            (taken, width, encoded_inputs, input_row, row_of(i))
        });
        let depth = network.hidden.len() as u32;
        let heads = (width, PADDED_HEAD_OUTPUTS as u32, 0, row_of(depth - 1), row_of(depth));
        for (inputs, outputs, encoded_inputs, input_row, output_row) in hidden.chain([heads]) {
            let tiles = inputs.div_ceil(TILE) * outputs.div_ceil(TILE);
            layers.push(NetworkLayer {
                inputs,
                outputs,
                input_row,
                output_row,
                weights: at / 4,
                encoded_inputs,
                row_vectors: 0,
                most_parts: SUM_WORKGROUPS.div_ceil(tiles),
                head_row: row_of(depth),
            });
            at += outputs * inputs + outputs;
        }
        Ok(Self {
            parameters: at as usize,
            rows: row_of(depth) + PADDED_HEAD_OUTPUTS as u32,
            encoding_row,
            octaves: network.position_encoding.octaves as u32,
            time_encoding: network.time_encoding,
            hidden: network.hidden.iter().map(|l| l.weight.len() + l.bias.len()).sum(),
            width: network.width(),
            layers,
        })
    }

    /// Whether a network has the same layers.
    pub(super) fn fits(&self, network: &DeformationNetwork) -> bool {
        Self::new(network).is_ok_and(|other| {
            self.layers == other.layers
                && self.octaves == other.octaves
                && self.time_encoding == other.time_encoding
        })
    }

    /// Floats of the gradient of one layer.
    pub(super) fn layer_floats(layer: &NetworkLayer) -> u64 {
        u64::from(layer.outputs) * u64::from(layer.inputs) + u64::from(layer.outputs)
    }

    /// Bytes of the parts of a sum over splats, for the layer that takes most.
    pub(super) fn parts_bytes(&self) -> u64 {
        let bytes = |l: &NetworkLayer| 4 * u64::from(l.most_parts) * Self::layer_floats(l);
        self.layers.iter().map(bytes).max().unwrap_or(0)
    }

    /// Bytes of the activations of one splat.
    pub(super) fn column_bytes(&self) -> u64 {
        4 * u64::from(self.rows)
    }

    /// What every chunk has at time `t`; a time that is not finite is 0.
    pub(super) fn chunk_at(&self, time: f32) -> NetworkChunk {
        let time = if time.is_finite() { f64::from(time) } else { 0.0 };
        let mut features = vec![0.0; self.time_encoding.width()];
        self.time_encoding.encode(&[time], &mut features);
        let mut chunk = NetworkChunk {
            octaves: self.octaves,
            time_features: features.len() as u32,
            encoding_row: self.encoding_row,
            ..NetworkChunk::default()
        };
        let slots = chunk.time.as_flattened_mut();
        slots.iter_mut().zip(features).for_each(|(slot, feature)| *slot = feature as f32);
        chunk
    }

    /// From the order of `weights.bin` to that on the device.
    pub(super) fn pack(&self, parameters: &[f32]) -> Vec<f32> {
        let (hidden, heads) = parameters.split_at(self.hidden);
        let mut packed = hidden.to_vec();
        packed.resize(self.parameters, 0.0);
        for (place, &value) in self.head_places().zip(heads) {
            packed[self.hidden + place] = value;
        }
        packed
    }

    /// The inverse of [`pack`](Self::pack).
    pub(super) fn unpack(&self, packed: &[f32]) -> Vec<f32> {
        let (hidden, heads) = packed.split_at(self.hidden);
        hidden.iter().copied().chain(self.head_places().map(|place| heads[place])).collect()
    }

    /// Places of the heads' parameters on the device, in the order of the file: head by head, the
    /// weights and then the biases.
    fn head_places(&self) -> impl Iterator<Item = usize> {
        let width = self.width;
        let heads = [0..3, 3..7, 7..HEAD_OUTPUTS];
        heads.into_iter().flat_map(move |outputs| {
            let weights = outputs.start * width..outputs.end * width;
            let first_bias = PADDED_HEAD_OUTPUTS * width;
            weights.chain(first_bias + outputs.start..first_bias + outputs.end)
        })
    }
}

/// Refuses what the kernels do not train.
fn check(network: &DeformationNetwork) -> Result<(), GpuError> {
    let refuse =
        |what, expected, found: String| Err(GpuError::Untrainable { what, expected, found });
    let (width, inputs) = (network.width(), network.input_width());
    match network {
        _ if network.time_network.is_some() => {
            refuse("encoding of the time", "γ(t) itself", "a time network".into())
        }
        _ if !matches!(network.position_head, PositionHead::Translation(_)) => {
            refuse("position head", "a translation", "a screw motion".into())
        }
        _ if network.rotation_rule != RotationRule::Renormalised => {
            refuse("sum of rotations", "normalised again", "as it is".into())
        }
        _ if !width.is_multiple_of(4) => {
            refuse("width of the hidden layers", "a multiple of 4", width.to_string())
        }
        _ if !inputs.is_multiple_of(4) => refuse("inputs", "a multiple of 4", inputs.to_string()),
        _ => Ok(()),
    }
}
