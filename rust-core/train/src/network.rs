//! The deformation network under training.

use trapeze_scene::deformation::{
    DeformationNetwork, Encoding, Linear, PositionHead, RotationRule,
};

use crate::random::{Purpose, Stream, uniform};

/// Layers of the standard network.
const HIDDEN_LAYERS: usize = 8;
/// Width of its hidden layers.
const WIDTH: usize = 256;
/// The hidden layer after which the input comes in again.
const SKIP_AFTER: usize = 4;
/// Octaves of the encodings of positions and time.
const OCTAVES: usize = 10;
/// Weights and biases of the standard network.
const STANDARD_PARAMETERS: u64 = 506_378;

/// A network with the state of its optimiser.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainedNetwork {
    /// The weights.
    pub network: DeformationNetwork,
    /// Adam's running mean of the gradient, in the order of [`network_parameters`].
    pub first_moments: Vec<f32>,
    /// Adam's running mean of the squared gradient, likewise.
    pub second_moments: Vec<f32>,
}

impl TrainedNetwork {
    /// A network at rest.
    #[must_use]
    pub fn new(network: DeformationNetwork) -> Self {
        let zeros = vec![0.0; network.parameter_count()];
        Self { network, first_moments: zeros.clone(), second_moments: zeros }
    }

    /// The standard network with nothing but zeros, moments too.
    #[must_use]
    pub fn zeros() -> Self {
        Self::new(zero_network())
    }

    /// Bytes that the standard network takes with its moments.
    #[must_use]
    pub fn bytes() -> u64 {
        3 * STANDARD_PARAMETERS * size_of::<f32>() as u64
    }

    /// Whether it has the shape and the rule that training gives a network, and moments of its size.
    #[must_use]
    pub fn is_standard(&self) -> bool {
        let network = &self.network;
        let count = network.parameter_count();
        network.is_standard()
            && network.rotation_rule == RotationRule::default()
            && [&self.first_moments, &self.second_moments].iter().all(|m| m.len() == count)
    }

    /// Whether no splat is moved, whatever its position and time: the heads are zero.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        let position: Vec<&Linear> = match &self.network.position_head {
            PositionHead::Translation(warp) => vec![warp],
            PositionHead::Screw { w, v } => vec![w, v],
        };
        let heads = [&self.network.rotation_head, &self.network.scale_head];
        let mut numbers =
            position.into_iter().chain(heads).flat_map(|head| head.weight.iter().chain(&head.bias));
        numbers.all(|&w| w == 0.0)
    }

    /// The standard network before its first step: hidden layers uniform in ±1/√inputs, weights and
    /// biases alike, and heads of zero, so that nothing moves until a step says so.
    #[must_use]
    pub fn standard(seed: u64) -> Self {
        Self::new(initial_network(seed))
    }
}

/// All weights and biases in the order of `weights.bin`: layer by layer, the weight (row-major,
/// outputs × inputs) and then the bias.
#[must_use]
pub fn network_parameters(network: &DeformationNetwork) -> Vec<f32> {
    let layers = network.layers();
    layers.flat_map(|layer| layer.weight.iter().chain(&layer.bias)).copied().collect()
}

/// Puts weights and biases back that [`network_parameters`] gave.
///
/// # Panics
/// When there are not as many as the network has.
pub fn set_network_parameters(network: &mut DeformationNetwork, parameters: &[f32]) {
    assert_eq!(parameters.len(), network.parameter_count(), "parameters of the network");
    let mut rest = parameters;
    for layer in network.layers_mut() {
        for array in [&mut layer.weight, &mut layer.bias] {
            let (these, after) = rest.split_at(array.len());
            array.copy_from_slice(these);
            rest = after;
        }
    }
}

fn initial_network(seed: u64) -> DeformationNetwork {
    let mut network = zero_network();
    for (layer, hidden) in (0..).zip(&mut network.hidden) {
        draw_uniform(seed, layer, hidden);
    }
    network
}

fn zero_network() -> DeformationNetwork {
    let position_encoding = Encoding { dimensions: 3, octaves: OCTAVES };
    let time_encoding = Encoding { dimensions: 1, octaves: OCTAVES };
    let inputs = position_encoding.width() + time_encoding.width();
    let inputs_of = |layer: usize| match layer {
        0 => inputs,
        _ if layer == SKIP_AFTER + 1 => inputs + WIDTH,
        _ => WIDTH,
    };
    let zeros = |inputs: usize, outputs: usize| Linear {
        inputs,
        outputs,
        weight: vec![0.0; inputs * outputs],
        bias: vec![0.0; outputs],
    };
    DeformationNetwork {
        position_encoding,
        time_encoding,
        time_network: None,
        hidden: (0..HIDDEN_LAYERS).map(|l| zeros(inputs_of(l), WIDTH)).collect(),
        skip_after: SKIP_AFTER,
        position_head: PositionHead::Translation(zeros(WIDTH, 3)),
        rotation_head: zeros(WIDTH, 4),
        scale_head: zeros(WIDTH, 3),
        rotation_rule: RotationRule::default(),
    }
}

fn draw_uniform(seed: u64, index: u32, layer: &mut Linear) {
    let stream = Stream::new(seed, Purpose::NetworkInitialisation, index);
    let bound = (layer.inputs as f32).sqrt().recip();
    let draw = |i: usize| bound * (2.0 * uniform(stream.words((i / 4) as u32)[i % 4]) - 1.0);
    for (i, number) in layer.weight.iter_mut().chain(&mut layer.bias).enumerate() {
        *number = draw(i);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_network_is_the_standard_one_and_moves_nothing() {
        let mut trained = TrainedNetwork::standard(3);
        assert!(trained.network.is_standard());
        assert_eq!(trained.network.parameter_count() as u64, STANDARD_PARAMETERS);
        assert!(trained.is_standard() && trained.is_at_rest());
        assert_ne!(trained, TrainedNetwork::standard(4));
        trained.network.scale_head.bias[2] = 1e-20;
        assert!(!trained.is_at_rest());
    }

    #[test]
    fn hidden_weights_fill_their_range_evenly() {
        for layer in &TrainedNetwork::standard(1).network.hidden {
            let bound = 1.0 / (layer.inputs as f64).sqrt();
            let n = layer.weight.len() as f64;
            let mean = layer.weight.iter().map(|&w| f64::from(w)).sum::<f64>() / n;
            let square = layer.weight.iter().map(|&w| f64::from(w).powi(2)).sum::<f64>() / n;
            assert!(layer.weight.iter().all(|w| f64::from(w.abs()) <= bound));
            // A uniform number has variance bound²/3; five deviations of the mean and of the mean
            // square (whose variance is 4/45 bound⁴).
            assert!(mean.abs() < 5.0 * bound / (3.0 * n).sqrt(), "{mean}");
            let expected = bound * bound / 3.0;
            assert!((square - expected).abs() < 5.0 * bound * bound * (4.0 / 45.0 / n).sqrt());
        }
    }

    #[test]
    fn parameters_go_out_and_come_back_in_one_order() {
        let network = TrainedNetwork::standard(5).network;
        let mut parameters = network_parameters(&network);
        assert_eq!(parameters[..4], network.hidden[0].weight[..4]);
        assert_eq!(parameters[256 * 84], network.hidden[0].bias[0]);
        parameters[256 * 84] = 7.0;
        let mut changed = network.clone();
        set_network_parameters(&mut changed, &parameters);
        assert_eq!(changed.hidden[0].bias[0], 7.0);
        changed.hidden[0].bias[0] = network.hidden[0].bias[0];
        assert_eq!(changed, network);
    }
}
