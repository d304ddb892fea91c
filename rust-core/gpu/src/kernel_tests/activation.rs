//! Activations of stored parameters, which follow the host's.

use super::device;
use crate::kernel::{Binding, Interface, whole};
use crate::readback;
use crate::shaders::common;
use crate::stage_pass::{Groups, dispatch};

const KERNEL: &str = "
@group(0) @binding(0) var<storage, read> stored: array<f32>;
@group(0) @binding(1) var<storage, read_write> activated: array<vec4<f32>>;
@compute @workgroup_size(64)
fn activate(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = stored[id.x];
    activated[2u * id.x] =
        vec4<f32>(linear_scale(x), log2_opacity_of(x), transparency_of(x), 0.0);
    let unit = unit_rotation(vec4<f32>(x, 0.5, -0.25, x * 0.125));
    activated[2u * id.x + 1u] = vec4<f32>(unit.rotation.xyz, unit.length);
}
";

/// [scale, log₂ opacity, transparency, 0] and [w, x, y of the unit quaternion, length] of each.
fn activated(stored: &[f32]) -> Option<Vec<[[f32; 4]; 2]>> {
    let gpu = device()?;
    let parts = [common::NUMBERS, common::ACTIVATION, common::ROTATION, KERNEL];
    let source = parts.join("\n");
    let interface = Interface::checked(&gpu, "activate", &source, &[Binding::Read, Binding::Write]);
    let pipeline = interface.pipeline(&gpu, "activate", &[]);
    let input = gpu.storage_of("stored", stored).unwrap();
    let output = gpu.storage("activated", (stored.len() * 32) as u64).unwrap();
    let group = interface.bind(&gpu, &[whole(&input), whole(&output)]);
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        dispatch(&mut pass, Groups::Direct(stored.len().div_ceil(64) as u32));
    }
    gpu.queue().submit([encoder.finish()]);
    Some(readback::read(&gpu, &output, stored.len() as u64).unwrap())
}

#[test]
fn activations_are_good_to_single_precision() {
    let stored: Vec<f32> = (0..4096).map(|i| (i as f32 - 2048.0) / 64.0).collect();
    let Some(found) = activated(&stored) else { return };
    for (&x, [numbers, rotation]) in stored.iter().zip(&found) {
        let x = f64::from(x);
        let relative = |found: f32, exact: f64| (f64::from(found) - exact).abs() / exact.abs();
        // The argument's reduction and a polynomial of seven terms: a few units in the last place.
        assert!(relative(numbers[0], x.exp().min(1e12)) < 1e-6, "exp {x}: {}", numbers[0]);
        assert!(relative(numbers[2], 1.0 / (1.0 + x.exp())) < 1e-6, "transparency {x}");
        // A device's log₂ may be off by 2⁻²¹ between ½ and 2 (Vulkan), and x·log₂ e is rounded.
        let log2_opacity = -(-x).exp().ln_1p() * std::f64::consts::LOG2_E;
        let error = (f64::from(numbers[1]) - log2_opacity).abs();
        assert!(error < 1e-6 + 2e-7 * x.abs(), "log2 opacity {x}: {error}");
        let quaternion = [x, 0.5, -0.25, x * 0.125];
        let length = quaternion.iter().map(|c| c * c).sum::<f64>().sqrt();
        assert!(relative(rotation[3], length) < 1e-6, "length {x}");
        for (&found, exact) in rotation[..3].iter().zip(quaternion) {
            assert!((f64::from(found) - exact / length).abs() < 1e-6, "rotation {x}");
        }
    }
}

#[test]
fn activations_have_limits_where_formulas_overflow() {
    let stored = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e4, -1e4, 1e20, f32::MAX];
    let Some(found) = activated(&stored) else { return };
    let [nan, inf, negative_inf, large, small, ..] = found[..] else { panic!("seven numbers") };
    // A negative scale is how a kernel is told of NaN: the splat is not drawn.
    assert!(nan[0][0] < 0.0 && nan[0][1] < -8.0);
    assert_eq!((inf[0][0], inf[0][1], inf[0][2]), (1e12, 0.0, 0.0));
    assert!(negative_inf[0][0] == 0.0 && negative_inf[0][1] <= -1e3 && negative_inf[0][2] == 1.0);
    assert_eq!((large[0][0], large[0][1], large[0][2]), (1e12, 0.0, 0.0));
    assert!(small[0][0] == 0.0 && small[0][1] <= -1e3 && small[0][2] == 1.0);
    for (x, [_, rotation]) in stored.iter().zip(&found) {
        let direction = x.is_finite();
        assert_eq!(rotation[3] > 0.0, direction, "{x}");
        assert!(rotation[..3].iter().all(|c| c.abs() <= 1.0), "{x}: {rotation:?}");
        assert!(direction || rotation[..3] == [1.0, 0.0, 0.0], "{x}: {rotation:?}");
    }
}
