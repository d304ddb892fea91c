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
    let position_encoding = Encoding { dimensions: 3, octaves: OCTAVES };
    let time_encoding = Encoding { dimensions: 1, octaves: OCTAVES };
    let inputs = position_encoding.width() + time_encoding.width();
    let inputs_of = |layer: usize| match layer {
        0 => inputs,
        _ if layer == SKIP_AFTER + 1 => inputs + WIDTH,
        _ => WIDTH,
    };
    let head = |outputs| Linear {
        inputs: WIDTH,
        outputs,
        weight: vec![0.0; WIDTH * outputs],
        bias: vec![0.0; outputs],
    };
    DeformationNetwork {
        position_encoding,
        time_encoding,
        time_network: None,
        hidden: (0..HIDDEN_LAYERS).map(|l| uniform_layer(seed, l as u32, inputs_of(l))).collect(),
        skip_after: SKIP_AFTER,
        position_head: PositionHead::Translation(head(3)),
        rotation_head: head(4),
        scale_head: head(3),
        rotation_rule: RotationRule::default(),
    }
}

fn uniform_layer(seed: u64, layer: u32, inputs: usize) -> Linear {
    let stream = Stream::new(seed, Purpose::NetworkInitialisation, layer);
    let bound = (inputs as f32).sqrt().recip();
    let draw = |i: usize| bound * (2.0 * uniform(stream.words((i / 4) as u32)[i % 4]) - 1.0);
    let weights = WIDTH * inputs;
    Linear {
        inputs,
        outputs: WIDTH,
        weight: (0..weights).map(draw).collect(),
        bias: (weights..weights + WIDTH).map(draw).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_network_is_the_standard_one_and_moves_nothing() {
        let trained = TrainedNetwork::standard(3);
        assert!(trained.network.is_standard());
        assert_eq!(trained.network.parameter_count(), 506_378);
        let PositionHead::Translation(warp) = &trained.network.position_head else { panic!() };
        for head in [warp, &trained.network.rotation_head, &trained.network.scale_head] {
            assert!(head.weight.iter().chain(&head.bias).all(|&w| w == 0.0));
        }
        assert_ne!(trained, TrainedNetwork::standard(4));
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
