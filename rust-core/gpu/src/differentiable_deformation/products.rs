//! How the network's products of matrices are computed, and whether a device computes them right.

use trapeze_scene::deformation::{Encoding, Linear, PositionHead, RotationRule};
use trapeze_scene::{DeformationNetwork, ShDegree, Splats};

use super::DifferentiableDeformation;
use crate::{Gpu, GpuError, ParameterBuffers};

/// How the products of a network under training are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NetworkProducts {
    /// In 32 bits, on any device.
    #[default]
    Single,
    /// On cooperative matrices (tensor cores), each number as the sum of two halves, which carry 22 of
    /// its 24 bits: where the device [has them](Gpu::has_matrices).
    Split,
}

impl NetworkProducts {
    /// Largest coordinate of a splat that split products are made for, world units. There the rounding of
    /// the smallest weights, 2⁻³¹, is 2e-6 of a feature.
    pub const FARTHEST: f32 = 4096.0;

    /// These, or single ones where the device has no others, computes them wrong, or fewer than a quarter of
    /// the splats are near enough: what training scatters changes nothing then, and a run that is resumed
    /// goes on as it began. The first call for split ones on a device waits for a probe of them.
    #[must_use]
    pub fn suited(self, gpu: &Gpu, positions: &[[f32; 3]]) -> Self {
        let is_near = |position: &&[f32; 3]| {
            position.iter().all(|x| !x.is_finite() || x.abs() <= Self::FARTHEST)
        };
        let is_suited = self == Self::Split
            && gpu.has_matrices()
            && 4 * positions.iter().filter(is_near).count() >= positions.len()
            && gpu.kernels().split_products_agree(|| agree(gpu));
        if is_suited { Self::Split } else { Self::Single }
    }
}

/// Splats of the probe: more than a tile, and not a multiple of one.
const SPLATS: u32 = 300;
/// Width of its hidden layers: likewise.
const WIDTH: usize = 160;
/// Largest part of a result by which the two kinds of products may differ (root mean squares).
/// Splitting and rounding give some 10⁻⁶, and 10⁻⁴ where they move a hidden feature across zero; a
/// wrong layout of a matrix gives about 1.
const MAX_RELATIVE_ERROR: f64 = 1e-2;

/// Whether both kinds of products have one result on this device.
fn agree(gpu: &Gpu) -> bool {
    let results = probe(gpu, NetworkProducts::Single)
        .and_then(|single| Ok((single, probe(gpu, NetworkProducts::Split)?)));
    let agree = match results {
        Ok((single, split)) => single.iter().zip(&split).all(|(a, b)| are_close(a, b)),
        Err(_) => false,
    };
    if !agree {
        tracing::warn!("products on cooperative matrices differ from plain ones on this device");
    }
    agree
}

fn are_close(single: &[f32], split: &[f32]) -> bool {
    let mut size = 0.0;
    let mut error = 0.0;
    for (&a, &b) in single.iter().zip(split) {
        size += f64::from(a).powi(2);
        error += (f64::from(a) - f64::from(b)).powi(2);
    }
    // False for NaN.
    error <= MAX_RELATIVE_ERROR * MAX_RELATIVE_ERROR * size
}

/// Deformed positions and ∂L/∂ parameters of a small network, layer by layer: with a gradient as small
/// as the share of a splat in a photograph.
fn probe(gpu: &Gpu, products: NetworkProducts) -> Result<Vec<Vec<f32>>, GpuError> {
    let network = network();
    let layers = || network.layers();
    let parameters: Vec<f32> =
        layers().flat_map(|l| l.weight.iter().chain(&l.bias)).copied().collect();
    let mut deformation = DifferentiableDeformation::with_products(
        gpu,
        &network,
        &parameters,
        SPLATS,
        u64::MAX,
        products,
    )?;
    let canonical = ParameterBuffers::from_splats(gpu, &splats(1.0), SPLATS)?;
    let gradients = ParameterBuffers::from_splats(gpu, &splats(1e-6), SPLATS)?;
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        deformation.forward(&mut pass, &canonical, 0.37)?;
        deformation.backward(&mut pass, &canonical, &gradients)?;
    }
    gpu.queue().submit([encoder.finish()]);
    let deformed = deformation.deformed(&canonical).read(gpu)?;
    let by_parameters = deformation.read_packed(deformation.gradients())?;
    let mut results = vec![deformed.positions.into_flattened()];
    let mut rest = by_parameters.as_slice();
    for layer in layers() {
        let (of_layer, after) = rest.split_at(layer.weight.len() + layer.bias.len());
        results.push(of_layer.to_vec());
        rest = after;
    }
    Ok(results)
}

/// Numbers in −1…1 that look random: the fractional parts of multiples of the golden ratio.
fn spread(from: usize) -> impl Iterator<Item = f32> {
    (from..).map(|i| ((i as f64 * 0.618_033_988_749_895).fract() * 2.0 - 1.0) as f32)
}

fn network() -> DeformationNetwork {
    let linear = |from: usize, inputs: usize, outputs: usize| {
        // √(6/n) keeps the size of the hidden vectors from layer to layer (He et al. 2015).
        let bound = (6.0 / inputs as f32).sqrt();
        // Steps that no row length divides, so that no two rows are alike.
        let mut numbers = spread(from).step_by(7).map(|x| bound * x);
        let mut draw = |n| numbers.by_ref().take(n).collect();
        Linear { inputs, outputs, weight: draw(inputs * outputs), bias: draw(outputs) }
    };
    let encoding = |dimensions| Encoding { dimensions, octaves: 10 };
    DeformationNetwork {
        position_encoding: encoding(3),
        time_encoding: encoding(1),
        time_network: None,
        hidden: vec![linear(1, 84, WIDTH), linear(2, WIDTH, WIDTH), linear(3, 84 + WIDTH, WIDTH)],
        skip_after: 1,
        position_head: PositionHead::Translation(linear(4, WIDTH, 3)),
        rotation_head: linear(5, WIDTH, 4),
        scale_head: linear(6, WIDTH, 3),
        rotation_rule: RotationRule::Renormalised,
    }
}

/// Splats, or gradients by them, of this size.
fn splats(size: f32) -> Splats {
    let mut numbers = spread(11).map(|x| size * x);
    let n = SPLATS as usize;
    let mut draw = |n: usize| -> Vec<f32> { numbers.by_ref().take(n).collect() };
    let triples = |flat: Vec<f32>| flat.as_chunks::<3>().0.to_vec();
    Splats {
        positions: triples(draw(3 * n)),
        log_scales: triples(draw(3 * n)),
        rotations: draw(4 * n).as_chunks::<4>().0.to_vec(),
        opacity_logits: draw(n),
        sh_dc: triples(draw(3 * n)),
        sh_degree: ShDegree::Zero,
        ..Splats::default()
    }
}
