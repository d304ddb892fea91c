//! The deformation network of Deformable-3D-Gaussians (Yang et al. 2023, arXiv 2309.13101) as data.
//!
//! This module knows what a network *is*: its tensors, and which of the published variants they
//! form. Evaluating it is the work of the backends; the f64 specification is in the `cpu` crate.

mod architecture;
mod encoding;
mod resting;

pub use architecture::{NamedTensors, Tensor};
pub use encoding::{Encoding, MAX_OCTAVES};
pub use resting::{DeformationOutputs, RestingSplats};

/// A fully connected layer y = W x + b.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// Length of x.
    pub inputs: usize,
    /// Length of y.
    pub outputs: usize,
    /// W, row-major, `outputs` × `inputs`.
    pub weight: Vec<f32>,
    /// b, `outputs`.
    pub bias: Vec<f32>,
}

/// The small network that upstream's `is_blender` option puts behind the encoded time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeNetwork {
    /// γ(t) → hidden, followed by ReLU.
    pub hidden: Linear,
    /// hidden → time features, linear.
    pub output: Linear,
}

/// How the last hidden layer becomes a displacement.
#[derive(Clone, Debug, PartialEq)]
pub enum PositionHead {
    /// d_xyz = W h + b, in world units.
    Translation(Linear),
    /// Upstream's `is_6dof`: a screw axis (w, v); θ = ‖w‖, the axis is (w/θ + 1e-5, v/θ + 1e-5)
    /// and the position moves by exp of it (Lynch & Park, "Modern Robotics", eq. 3.88, as used by
    /// Nerfies).
    Screw {
        /// Rotation part.
        w: Linear,
        /// Translation part.
        v: Linear,
    },
}

/// What happens to the sum of canonical rotation and its delta.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RotationRule {
    /// normalise(normalise(q) + d_q): the original app, and the sample scene.
    #[default]
    Renormalised,
    /// normalise(q) + d_q goes into the covariance as it is: upstream's CUDA rasteriser.
    AsTrained,
}

/// The network that moves, turns and scales each splat in time.
///
/// Input [γ(xyz), time features]; every hidden layer is followed by ReLU; after layer index
/// `skip_after` the input is concatenated in front of the hidden vector.
#[derive(Clone, Debug, PartialEq)]
pub struct DeformationNetwork {
    /// Encoding of the position.
    pub position_encoding: Encoding,
    /// Encoding of the time.
    pub time_encoding: Encoding,
    /// Upstream's `is_blender` variant.
    pub time_network: Option<TimeNetwork>,
    /// Hidden layers, in order.
    pub hidden: Vec<Linear>,
    /// Index of the hidden layer whose output gets the input put in front.
    pub skip_after: usize,
    /// d_xyz.
    pub position_head: PositionHead,
    /// d_rotation (w, x, y, z).
    pub rotation_head: Linear,
    /// d_scale, added to the *linear* scale.
    pub scale_head: Linear,
    /// What happens to the sum of rotations.
    pub rotation_rule: RotationRule,
}

impl DeformationNetwork {
    /// Width of the hidden layers.
    #[must_use]
    pub fn width(&self) -> usize {
        self.hidden[0].outputs
    }

    /// Length of γ(xyz): 63 in the standard network.
    #[must_use]
    pub fn position_width(&self) -> usize {
        self.position_encoding.width()
    }

    /// Length of the time features that enter layer 0: 21 in the standard network.
    #[must_use]
    pub fn time_width(&self) -> usize {
        self.time_network.as_ref().map_or(self.time_encoding.width(), |net| net.output.outputs)
    }

    /// Length of the input of layer 0: 84 in the standard network.
    #[must_use]
    pub fn input_width(&self) -> usize {
        self.position_width() + self.time_width()
    }

    /// All layers in the order of the original `weights.bin`: time network, hidden, heads.
    pub fn layers(&self) -> impl Iterator<Item = &Linear> {
        let time = self.time_network.iter().flat_map(|net| [&net.hidden, &net.output]);
        let position: Vec<&Linear> = match &self.position_head {
            PositionHead::Translation(warp) => vec![warp],
            PositionHead::Screw { w, v } => vec![w, v],
        };
        time.chain(&self.hidden).chain(position).chain([&self.rotation_head, &self.scale_head])
    }

    /// [`layers`](Self::layers), to be changed; the lengths must stay.
    pub fn layers_mut(&mut self) -> impl Iterator<Item = &mut Linear> {
        let time = self.time_network.iter_mut().flat_map(|net| [&mut net.hidden, &mut net.output]);
        let position: Vec<&mut Linear> = match &mut self.position_head {
            PositionHead::Translation(warp) => vec![warp],
            PositionHead::Screw { w, v } => vec![w, v],
        };
        let heads = [&mut self.rotation_head, &mut self.scale_head];
        time.chain(&mut self.hidden).chain(position).chain(heads)
    }

    /// Number of weights and biases.
    #[must_use]
    pub fn parameter_count(&self) -> usize {
        self.layers().map(|l| l.weight.len() + l.bias.len()).sum()
    }

    /// Multiply–adds of one evaluation of one splat.
    #[must_use]
    pub fn multiply_adds(&self) -> usize {
        self.layers().map(|l| l.weight.len()).sum()
    }

    /// Whether this is the network that the headerless `weights.bin` can hold: 84 inputs, eight
    /// layers of 256, translation head.
    #[must_use]
    pub fn is_standard(&self) -> bool {
        self.position_encoding == Encoding { dimensions: 3, octaves: 10 }
            && self.time_encoding == Encoding { dimensions: 1, octaves: 10 }
            && self.time_network.is_none()
            && self.hidden.len() == 8
            && self.width() == 256
            && self.skip_after == 4
            && matches!(self.position_head, PositionHead::Translation(_))
    }

    /// One line for people: variant, depth × width, input width.
    #[must_use]
    pub fn describe(&self) -> String {
        let time = if self.time_network.is_some() { ", time network" } else { "" };
        let head = match self.position_head {
            PositionHead::Translation(_) => "",
            PositionHead::Screw { .. } => ", screw motion (6-dof)",
        };
        format!(
            "{} × {}, {} inputs (xyz {} octaves, t {} octaves){time}{head}",
            self.hidden.len(),
            self.width(),
            self.input_width(),
            self.position_encoding.octaves,
            self.time_encoding.octaves,
        )
    }
}
