//! The network and what its outputs do to a splat, forward and backward in double precision, one
//! splat after the other.

use trapeze_scene::deformation::{Linear, PositionHead};
use trapeze_scene::{DeformationNetwork, Splats};

/// Both passes over some splats.
pub(super) struct Evaluation {
    pub(super) positions: Vec<f64>,
    pub(super) rotations: Vec<f64>,
    pub(super) scales: Vec<f64>,
    pub(super) log_scales: Vec<f64>,
    pub(super) by_log_scales: Vec<f64>,
    pub(super) by_rotations: Vec<f64>,
    /// In the order of `weights.bin`.
    pub(super) by_parameters: Vec<f64>,
    /// Whether everything is differentiable there, and stays so when it is rounded: no hidden
    /// feature within rounding of zero, no scale just above its floor.
    pub(super) is_smooth: bool,
}

/// Smallest linear scale.
const FLOOR: f64 = 1e-6;

/// All weights and biases in the order of `weights.bin`.
pub(super) fn flat_parameters(network: &DeformationNetwork) -> Vec<f32> {
    network.layers().flat_map(|l| l.weight.iter().chain(&l.bias)).copied().collect()
}

/// Evaluates the splats at a time, and carries ∂L/∂(deformed position 3, linear scale 3, sum of
/// rotations 4) back.
pub(super) fn evaluate(
    network: &DeformationNetwork,
    splats: &Splats,
    time: f32,
    by_deformed: &[[f32; 10]],
) -> Evaluation {
    let mut out = Evaluation {
        positions: Vec::new(),
        rotations: Vec::new(),
        scales: Vec::new(),
        log_scales: Vec::new(),
        by_log_scales: Vec::new(),
        by_rotations: Vec::new(),
        by_parameters: vec![0.0; network.parameter_count()],
        is_smooth: true,
    };
    for i in 0..splats.positions.len() {
        one_splat(network, splats, i, time, by_deformed[i].map(f64::from), &mut out);
    }
    out
}

fn one_splat(
    network: &DeformationNetwork,
    splats: &Splats,
    i: usize,
    time: f32,
    by: [f64; 10],
    out: &mut Evaluation,
) {
    let mut input = vec![0.0; network.input_width()];
    let (position, time_part) = input.split_at_mut(network.position_width());
    let x = splats.positions[i].map(f64::from);
    network.position_encoding.encode(&x, position);
    network.time_encoding.encode(&[f64::from(time)], time_part);

    // What each hidden layer takes in and gives.
    let mut taken = Vec::new();
    let mut given: Vec<Vec<f64>> = Vec::new();
    for (l, layer) in network.hidden.iter().enumerate() {
        let x = match given.last() {
            None => input.clone(),
            Some(h) if l == network.skip_after + 1 => [&input[..], h].concat(),
            Some(h) => h.clone(),
        };
        let sums = product(layer, &x);
        out.is_smooth &= sums.iter().all(|sum| sum.abs() > 1e-5);
        taken.push(x);
        given.push(sums.iter().map(|&sum| sum.max(0.0)).collect());
    }
    let last = given.last().unwrap();
    let PositionHead::Translation(warp) = &network.position_head else { panic!() };
    let heads = [warp, &network.rotation_head, &network.scale_head];
    let [d, d_q, d_s] = heads.map(|head| product(head, last));

    let q = splats.rotations[i].map(f64::from);
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    let unit = q.map(|c| c / length);
    let scales = splats.log_scales[i].map(|l| f64::from(l).exp());
    let sums: [f64; 3] = std::array::from_fn(|c| scales[c] + d_s[c]);
    out.is_smooth &= sums.iter().all(|&sum| !(FLOOR * 0.5..1e-3).contains(&sum));
    out.positions.extend((0..3).map(|c| x[c] + d[c]));
    out.rotations.extend((0..4).map(|c| unit[c] + d_q[c]));
    out.scales.extend(sums.map(|sum| sum.max(FLOOR)));
    out.log_scales.extend(sums.map(|sum| sum.max(FLOOR).ln()));

    let by_scale: [f64; 3] = std::array::from_fn(|c| if sums[c] > FLOOR { by[3 + c] } else { 0.0 });
    out.by_log_scales.extend((0..3).map(|c| by_scale[c] * scales[c]));
    let along: f64 = (0..4).map(|c| unit[c] * by[6 + c]).sum();
    out.by_rotations.extend((0..4).map(|c| (by[6 + c] - along * unit[c]) / length));

    // Backward, from the end of the parameters to their start.
    let mut end = out.by_parameters.len();
    let mut by_last = vec![0.0; last.len()];
    for (head, by) in heads.into_iter().zip([&by[..3], &by[6..], &by_scale[..]]).rev() {
        let by_input = layer_backward(head, last, by, &mut out.by_parameters, &mut end);
        by_last.iter_mut().zip(by_input).for_each(|(sum, g)| *sum += g);
    }
    for (l, layer) in network.hidden.iter().enumerate().rev() {
        let by_sums: Vec<f64> =
            by_last.iter().zip(&given[l]).map(|(&g, &h)| if h > 0.0 { g } else { 0.0 }).collect();
        let by_input = layer_backward(layer, &taken[l], &by_sums, &mut out.by_parameters, &mut end);
        let hidden = by_input.len().saturating_sub(network.width());
        by_last = by_input[hidden..].to_vec();
    }
    assert_eq!(end, 0);
}

fn product(layer: &Linear, x: &[f64]) -> Vec<f64> {
    let rows = layer.weight.chunks_exact(layer.inputs).zip(&layer.bias);
    rows.map(|(row, &bias)| {
        f64::from(bias) + row.iter().zip(x).map(|(&w, x)| f64::from(w) * x).sum::<f64>()
    })
    .collect()
}

/// Adds the gradient of a layer's parameters, which end at `end`, and returns that of its input.
fn layer_backward(
    layer: &Linear,
    x: &[f64],
    by_output: &[f64],
    by_parameters: &mut [f64],
    end: &mut usize,
) -> Vec<f64> {
    let first = *end - layer.weight.len() - layer.bias.len();
    let (by_weight, by_bias) = by_parameters[first..*end].split_at_mut(layer.weight.len());
    let mut by_input = vec![0.0; layer.inputs];
    for (o, &g) in by_output.iter().enumerate() {
        by_bias[o] += g;
        let row = o * layer.inputs..(o + 1) * layer.inputs;
        for (k, (w, by)) in layer.weight[row.clone()].iter().zip(&mut by_weight[row]).enumerate() {
            *by += g * x[k];
            by_input[k] += g * f64::from(*w);
        }
    }
    *end = first;
    by_input
}
