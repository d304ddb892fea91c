//! The kernels against a plain double-precision forward and backward pass.

mod reference;
mod resting;

use trapeze_scene::deformation::{
    Encoding, Linear, PositionHead, RestingSplats, RotationRule, TimeNetwork,
};
use trapeze_scene::{DeformationNetwork, ShDegree, Splats};

use super::{DifferentiableDeformation, NetworkProducts};
use crate::kernel_tests::device;
use crate::{Gpu, GpuError, ParameterBuffers};
use reference::{Evaluation, evaluate, flat_parameters};

const TIME: f32 = 0.37;
/// Activations of any number of splats in one chunk.
const AMPLE: u64 = 64 << 20;

/// Numbers in −1…1, the same in every run (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn array<const N: usize>(&mut self) -> [f32; N] {
        std::array::from_fn(|_| self.next())
    }

    fn linear(&mut self, inputs: usize, outputs: usize, scale: f32) -> Linear {
        let bound = scale / (inputs as f32).sqrt();
        let mut draw = |n| (0..n).map(|_| bound * self.next()).collect();
        Linear { inputs, outputs, weight: draw(inputs * outputs), bias: draw(outputs) }
    }
}

fn network(depth: usize, width: usize) -> DeformationNetwork {
    let mut random = Random(depth as u64);
    let encoding = |dimensions| Encoding { dimensions, octaves: 10 };
    let (inputs, skip_after) = (84, depth / 2);
    let inputs_of = |i: usize| match i {
        0 => inputs,
        i if i == skip_after + 1 => inputs + width,
        _ => width,
    };
    // √6 keeps the size of the hidden vectors from layer to layer (He et al. 2015).
    let hidden = (0..depth).map(|i| random.linear(inputs_of(i), width, 6f32.sqrt())).collect();
    DeformationNetwork {
        position_encoding: encoding(3),
        time_encoding: encoding(1),
        time_network: None,
        hidden,
        skip_after,
        position_head: PositionHead::Translation(random.linear(width, 3, 0.2)),
        rotation_head: random.linear(width, 4, 0.2),
        scale_head: random.linear(width, 3, 0.1),
        rotation_rule: RotationRule::Renormalised,
    }
}

/// Splats that the network can be compared on: none at a kink of it.
fn splats(network: &DeformationNetwork, n: usize) -> Splats {
    let mut random = Random(n as u64);
    let mut splats = Splats { sh_degree: ShDegree::Zero, ..Splats::default() };
    while splats.positions.len() < n {
        let mut one = Splats {
            positions: vec![random.array()],
            log_scales: vec![random.array::<3>().map(|s| s - 3.0)],
            rotations: vec![random.array()],
            opacity_logits: vec![random.next()],
            sh_dc: vec![random.array()],
            ..Splats::default()
        };
        if evaluate(network, &one, TIME, &gradients(1)).is_smooth {
            splats.positions.append(&mut one.positions);
            splats.log_scales.append(&mut one.log_scales);
            splats.rotations.append(&mut one.rotations);
            splats.opacity_logits.append(&mut one.opacity_logits);
            splats.sh_dc.append(&mut one.sh_dc);
        }
    }
    splats
}

/// ∂L/∂(deformed position, scale, rotation) of each splat.
fn gradients(n: usize) -> Vec<[f32; 10]> {
    let mut random = Random(7);
    (0..n).map(|_| random.array()).collect()
}

/// What the device makes of the same.
struct Found {
    deformed: Splats,
    by_canonical: Splats,
    by_parameters: Vec<f32>,
}

/// A device, and how it may compute products.
struct Device {
    gpu: Gpu,
    products: NetworkProducts,
    activation_budget: u64,
}

impl Device {
    fn within(&self, activation_budget: u64) -> Self {
        Self { gpu: self.gpu.clone(), activation_budget, ..*self }
    }
}

/// The device with each kind of products that it has.
fn devices() -> Vec<Device> {
    let Some(gpu) = device() else { return Vec::new() };
    let with = |products| Device { gpu: gpu.clone(), products, activation_budget: AMPLE };
    if !gpu.has_matrices() {
        eprintln!("SKIPPED: split products need a device with cooperative matrices");
        return vec![with(NetworkProducts::Single)];
    }
    vec![with(NetworkProducts::Single), with(NetworkProducts::Split)]
}

/// Runs both passes with gradients of the log-scales that come from those of the scales.
fn run(
    device: &Device,
    network: &DeformationNetwork,
    splats: &Splats,
    by_deformed: &[[f32; 10]],
) -> Found {
    run_beside(device, network, splats, by_deformed, None)
}

/// The same with splats that rest.
fn run_beside(
    device: &Device,
    network: &DeformationNetwork,
    splats: &Splats,
    by_deformed: &[[f32; 10]],
    resting: Option<&RestingSplats>,
) -> Found {
    let Device { gpu, products, activation_budget } = device;
    let parameters = flat_parameters(network);
    let n = splats.positions.len();
    let mut deformation = DifferentiableDeformation::with_products(
        gpu,
        network,
        &parameters,
        n as u32,
        *activation_budget,
        *products,
    )
    .unwrap();
    assert_eq!(deformation.products(), *products);
    assert_eq!(deformation.read().unwrap(), parameters);
    deformation.set_resting(resting).unwrap();
    let canonical = ParameterBuffers::from_splats(gpu, splats, n as u32).unwrap();
    let submit = |record: &mut dyn FnMut(&mut wgpu::ComputePass<'_>)| {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        record(&mut encoder.begin_compute_pass(&Default::default()));
        gpu.queue().submit([encoder.finish()]);
    };
    submit(&mut |pass| deformation.forward(pass, &canonical, TIME).unwrap());
    let deformed = deformation.deformed(&canonical).read(gpu).unwrap();
    let by_log_scale = |i: usize| {
        let scales = deformed.log_scales[i].map(f32::exp);
        std::array::from_fn(|c| by_deformed[i][3 + c] * scales[c])
    };
    let by_splats = Splats {
        positions: by_deformed.iter().map(|g| [g[0], g[1], g[2]]).collect(),
        log_scales: (0..n).map(by_log_scale).collect(),
        rotations: by_deformed.iter().map(|g| [g[6], g[7], g[8], g[9]]).collect(),
        ..splats.clone()
    };
    let gradients = ParameterBuffers::from_splats(gpu, &by_splats, n as u32).unwrap();
    submit(&mut |pass| deformation.backward(pass, &canonical, &gradients).unwrap());
    let by_parameters = deformation.read_packed(deformation.gradients()).unwrap();
    Found { deformed, by_canonical: gradients.read(gpu).unwrap(), by_parameters }
}

/// Largest difference, relative to the largest value.
fn difference(found: &[f32], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(f64::MIN_POSITIVE, |m, e| m.max(e.abs()));
    let differences = found.iter().zip(expected).map(|(&f, e)| {
        let difference = (f64::from(f) - e).abs();
        assert!(!difference.is_nan(), "{f} {e}");
        difference
    });
    differences.fold(0.0, f64::max) / largest
}

/// A sum of products rounds by √n·2⁻²⁴ of its terms' size, some 1e-6 for the widest layers; nine layers
/// one way and nine back add up, and what a layer takes in is not as small as what it gives.
const TOLERANCE: f64 = 1e-5;

fn assert_close(network: &DeformationNetwork, found: &Found, expected: &Evaluation) {
    let check = |name: &str, found: &[f32], expected: &[f64]| {
        let worst = difference(found, expected);
        println!("{name}: {worst:.1e}");
        assert!(worst <= TOLERANCE, "{name}: {worst:.2e}");
    };
    check("positions", found.deformed.positions.as_flattened(), &expected.positions);
    check("rotations", found.deformed.rotations.as_flattened(), &expected.rotations);
    check("log-scales", found.deformed.log_scales.as_flattened(), &expected.log_scales);
    check("by log-scales", found.by_canonical.log_scales.as_flattened(), &expected.by_log_scales);
    check("by rotations", found.by_canonical.rotations.as_flattened(), &expected.by_rotations);
    let mut at = 0;
    for (i, layer) in network.layers().enumerate() {
        for (name, length) in [("weight", layer.weight.len()), ("bias", layer.bias.len())] {
            let range = at..at + length;
            let name = format!("layer {i}, {name}");
            check(&name, &found.by_parameters[range.clone()], &expected.by_parameters[range]);
            at += length;
        }
    }
    assert_eq!(at, found.by_parameters.len());
}

#[test]
fn both_passes_follow_double_precision_for_any_number_of_splats() {
    let network = network(4, 64);
    for device in devices() {
        for n in [1, 63, 65, 200] {
            let (splats, by_deformed) = (splats(&network, n), gradients(n));
            let found = run(&device, &network, &splats, &by_deformed);
            let expected = evaluate(&network, &splats, TIME, &by_deformed);
            assert_close(&network, &found, &expected);
            assert_eq!(found.by_canonical.positions[n - 1], by_deformed[n - 1][..3]);
            assert_eq!(found.deformed.sh_dc, splats.sh_dc);
            if n == 200 {
                let held = expected.scales.iter().filter(|&&s| s <= 1e-6).count();
                assert!((20..580).contains(&held), "{held} scales at their floor");
            }
        }
    }
}

#[test]
fn the_standard_network_follows_double_precision() {
    let network = network(8, 256);
    assert!(network.is_standard());
    let (splats, by_deformed) = (splats(&network, 130), gradients(130));
    let expected = evaluate(&network, &splats, TIME, &by_deformed);
    for device in devices() {
        assert_close(&network, &run(&device, &network, &splats, &by_deformed), &expected);
    }
}

#[test]
fn gradients_as_small_as_the_share_of_a_pixel_keep_their_digits() {
    let network = network(4, 160);
    // Far below the smallest half, 6e-8, and each splat at another size.
    let mut by_deformed = gradients(200);
    for (i, gradient) in by_deformed.iter_mut().enumerate() {
        *gradient = gradient.map(|g| g * 1e-9 * 2f32.powi(-(i as i32 % 12)));
    }
    let splats = splats(&network, 200);
    let expected = evaluate(&network, &splats, TIME, &by_deformed);
    for device in devices() {
        assert_close(&network, &run(&device, &network, &splats, &by_deformed), &expected);
    }
}

#[test]
fn far_places_are_deformed_as_near_ones_are() {
    let mut network = network(4, 64);
    // Weights that see places of this size.
    for layer in &mut network.hidden {
        for row in layer.weight.chunks_exact_mut(layer.inputs).filter(|row| row.len() % 64 != 0) {
            row[..3].iter_mut().for_each(|weight| *weight *= 1e-3);
        }
    }
    let mut splats = splats(&network, 130);
    for position in splats.positions.as_flattened_mut() {
        *position = (*position * NetworkProducts::FARTHEST).round();
    }
    let by_deformed = gradients(130);
    let expected = evaluate(&network, &splats, TIME, &by_deformed);
    for device in devices() {
        let found = run(&device, &network, &splats, &by_deformed);
        let rotations = difference(found.deformed.rotations.as_flattened(), &expected.rotations);
        assert!(rotations <= TOLERANCE, "{rotations:.1e}");
        // A hidden feature within rounding of zero may be on its other side: one splat's share.
        let first_layer = ..84 * 64;
        let by_weights = &expected.by_parameters[first_layer];
        let error = difference(&found.by_parameters[first_layer], by_weights);
        assert!(error <= 1e-3, "{error:.1e}");
    }
}

#[test]
fn a_splat_that_has_gone_astray_leaves_all_gradients_finite() {
    let network = network(4, 160);
    let mut splats = splats(&network, 130);
    splats.positions[7] = [1e12, -3e9, 2e7];
    let mut by_deformed = gradients(130);
    // It is not seen.
    by_deformed[7] = [0.0; 10];
    for device in devices() {
        let found = run(&device, &network, &splats, &by_deformed);
        assert!(found.by_parameters.iter().all(|g| g.is_finite()), "{:?}", device.products);
        assert!(found.deformed.rotations.as_flattened().iter().all(|r| r.is_finite()));
    }
}

#[test]
fn split_products_are_not_for_scenes_beyond_the_range_of_halves() {
    let Some(gpu) = device() else { return };
    let near = NetworkProducts::Split.suited(&gpu, &[]);
    let at = |x: f32| NetworkProducts::Split.suited(&gpu, &[[0.0, -x, 1.0]]);
    assert_eq!(at(NetworkProducts::FARTHEST), near);
    assert_eq!(at(NetworkProducts::FARTHEST * 1.01), NetworkProducts::Single);
    // Three of four have gone astray.
    let astray = [0.0, 1e9, f32::NAN];
    let one_near = [[0.0; 3], astray, astray, astray];
    assert_eq!(NetworkProducts::Split.suited(&gpu, &one_near), near);
    // These are not drawn.
    assert_eq!(at(f32::NAN), near);
    assert_eq!(at(f32::INFINITY), near);
}

#[test]
fn splats_that_do_not_fit_together_are_evaluated_in_chunks_with_one_result() {
    let network = network(3, 68);
    let (splats, by_deformed) = (splats(&network, 300), gradients(300));
    let expected = evaluate(&network, &splats, TIME, &by_deformed);
    for device in devices() {
        let whole = run(&device, &network, &splats, &by_deformed);
        let parts = run(&device.within(1), &network, &splats, &by_deformed);
        assert_eq!(parts.deformed, whole.deformed);
        assert_eq!(parts.by_canonical, whole.by_canonical);
        assert_close(&network, &parts, &expected);
        assert_close(&network, &whole, &expected);
    }
}

#[test]
fn two_runs_have_the_same_bits() {
    let network = network(3, 64);
    // Enough for eight parts of each sum; the second run is on fresh buffers.
    let (splats, by_deformed) = (splats(&network, 400), gradients(400));
    for device in devices() {
        let first = run(&device, &network, &splats, &by_deformed);
        let second = run(&device, &network, &splats, &by_deformed);
        assert_eq!(first.by_parameters, second.by_parameters);
        assert_eq!(first.by_canonical, second.by_canonical);
    }
}

#[test]
fn no_splats_give_no_gradient() {
    let network = network(3, 64);
    for device in devices() {
        let found = run(&device, &network, &splats(&network, 0), &[]);
        assert!(found.by_parameters.iter().all(|&g| g == 0.0));
    }
}

#[test]
fn a_splat_that_is_not_finite_stays_out_of_the_weights() {
    let network = network(3, 64);
    let (mut splats, mut by_deformed) = (splats(&network, 100), gradients(100));
    // The renderer draws none of these, so no gradient comes back for them.
    let poisoned = [3, 40, 41, 99];
    poisoned.iter().for_each(|&i| by_deformed[i] = [0.0; 10]);
    let expected = evaluate(&network, &splats, TIME, &by_deformed).by_parameters;
    splats.positions[3] = [f32::NAN, 0.0, 0.0];
    splats.positions[40] = [0.0, f32::INFINITY, 1.0];
    splats.log_scales[41] = [f32::NAN; 3];
    splats.rotations[99] = [f32::NAN, 1.0, 0.0, f32::NEG_INFINITY];
    for device in devices() {
        let found = run(&device, &network, &splats, &by_deformed);
        assert!(difference(&found.by_parameters, &expected) <= TOLERANCE);
        assert!(found.deformed.positions[3][0].is_nan());
        assert!(found.deformed.log_scales[41].iter().all(|s| s.is_nan()));
        assert!(found.by_canonical.rotations[99].iter().all(|&g| g == 0.0));
    }
}

#[test]
fn a_rotation_that_its_delta_cancels_is_the_identity_without_a_gradient() {
    let mut network = network(3, 64);
    network.rotation_head.weight.fill(0.0);
    network.rotation_head.bias = vec![-1.0, 0.0, 0.0, 0.0];
    let mut splats = splats(&network, 1);
    splats.rotations[0] = [5.0, 0.0, 0.0, 0.0];
    for device in devices() {
        let found = run(&device, &network, &splats, &gradients(1));
        // What has no direction is the identity to the projection, and its gradient there is zero.
        assert_eq!(found.deformed.rotations[0], [0.0; 4]);
    }
}

#[test]
fn split_products_are_used_where_the_device_has_them_and_they_are_right() {
    let Some(gpu) = device() else { return };
    let (single, split) = (NetworkProducts::Single, NetworkProducts::Split);
    assert_eq!(split.suited(&gpu, &[]), if gpu.has_matrices() { split } else { single });
    assert_eq!(single.suited(&gpu, &[]), single);
}

#[test]
fn networks_that_cannot_be_trained_are_refused_by_name() {
    let refused = |change: fn(&mut DeformationNetwork), what: &str| {
        let mut network = network(3, 64);
        change(&mut network);
        let error = DifferentiableDeformation::bytes(&network, 10, AMPLE).unwrap_err();
        assert!(matches!(error, GpuError::Untrainable { .. }), "{error}");
        assert!(error.to_string().contains(what), "{error}");
    };
    refused(|n| n.rotation_rule = RotationRule::AsTrained, "rotations");
    refused(
        |n| {
            let linear = || Random(1).linear(64, 3, 1.0);
            n.position_head = PositionHead::Screw { w: linear(), v: linear() };
        },
        "screw",
    );
    refused(
        |n| {
            let (hidden, output) = (Random(1).linear(21, 8, 1.0), Random(1).linear(8, 21, 1.0));
            n.time_network = Some(TimeNetwork { hidden, output });
        },
        "time network",
    );
    refused(|n| n.position_encoding.octaves = 3, "multiple of 4, found 42");
}

#[test]
fn a_steady_evaluation_creates_nothing_and_more_splats_than_fit_are_refused() {
    // Nobody else's objects are to be counted.
    if device().is_none() {
        return;
    }
    let gpu = Gpu::open(&crate::GpuOptions::default()).unwrap();
    let network = network(3, 64);
    let parameters = flat_parameters(&network);
    let mut deformation =
        DifferentiableDeformation::new(&gpu, &network, &parameters, 20, AMPLE).unwrap();
    let canonical = ParameterBuffers::from_splats(&gpu, &splats(&network, 20), 20).unwrap();
    let gradients = ParameterBuffers::zeroed(&gpu, 20, ShDegree::Zero).unwrap();
    let mut evaluate = || {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        deformation.forward(&mut pass, &canonical, 0.5).unwrap();
        deformation.backward(&mut pass, &canonical, &gradients).unwrap();
        assert!(deformation.backward(&mut pass, &canonical, &gradients).is_err(), "twice");
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        gpu.created()
    };
    let first = evaluate();
    assert_eq!(evaluate(), first);
    assert!(deformation.fits(&network, 20) && !deformation.fits(&network, 21));
    assert!(!deformation.fits(&self::network(3, 68), 20));
    let many = ParameterBuffers::zeroed(&gpu, 21, ShDegree::Zero).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    let error = deformation.forward(&mut pass, &many, 0.5).unwrap_err();
    assert!(matches!(error, GpuError::OutOfMemory { need: 840, have: 800, .. }), "{error}");
}
