//! The positional encoding's own sine and cosine.

use super::device;
use crate::kernel::{Binding, Interface, whole};
use crate::stage_pass::{Groups, dispatch};
use crate::{readback, shaders};

const KERNEL: &str = "
@group(0) @binding(0) var<storage, read> angles: array<f32>;
@group(0) @binding(1) var<storage, read_write> waves: array<vec2<f32>>;
const OCTAVES: u32 = 10u;
@compute @workgroup_size(256)
fn encode(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let i = flat_group(group, groups) * 256u + thread;
    if (i >= arrayLength(&angles)) {
        return;
    }
    let turns = turns_of(angles[i]);
    for (var octave = 0u; octave < OCTAVES; octave++) {
        waves[i * OCTAVES + octave] = sin_cos_of_turns(turns, f32(1u << octave), 0.0);
    }
}
";
const OCTAVES: usize = 10;

/// Largest difference from f64 over all octaves, for |x| ≤ `range`.
fn worst_error(range: f32) -> Option<f64> {
    let gpu = device()?;
    let n = 1 << 16;
    let angles: Vec<f32> =
        (0..n).map(|i| (2.0 * (i as f32 / (n - 1) as f32) - 1.0) * range).collect();
    let source = format!("{}\n{KERNEL}", shaders::encoding_source());
    let interface = Interface::new(&gpu, "encode", &source, &[Binding::Read, Binding::Write]);
    let pipeline = interface.pipeline(&gpu, "encode", &[]);
    let input = gpu.storage_of("angles", &angles).unwrap();
    let output = gpu.storage("waves", (n * OCTAVES * 8) as u64).unwrap();
    let group = interface.bind(&gpu, &[whole(&input), whole(&output)]);
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        dispatch(&mut pass, Groups::Direct((n / 256) as u32));
    }
    gpu.queue().submit([encoder.finish()]);
    let waves: Vec<[f32; 2]> = readback::read(&gpu, &output, (n * OCTAVES) as u64).unwrap();
    let mut worst = 0.0f64;
    for (i, &x) in angles.iter().enumerate() {
        for octave in 0..OCTAVES {
            let (sine, cosine) = (f64::from(x) * f64::from(1u32 << octave)).sin_cos();
            let [ours_sine, ours_cosine] = waves[i * OCTAVES + octave].map(f64::from);
            let error = (ours_sine - sine).abs().max((ours_cosine - cosine).abs());
            assert!(error.is_finite(), "{x}, octave {octave}");
            worst = worst.max(error);
        }
    }
    Some(worst)
}

#[test]
fn every_octave_is_accurate_up_to_8_units() {
    // Parts of a turn are exact to 2⁻²⁵; a rounded sum of four of them, times 2π, is 4e-7 off at
    // most, and the polynomials add 1e-7.
    let Some(worst) = worst_error(8.0) else { return };
    println!("worst error {worst:.2e}");
    assert!(worst < 7e-7, "{worst}");
}

#[test]
fn every_octave_is_accurate_far_from_the_origin() {
    let Some(worst) = worst_error(1e4) else { return };
    println!("worst error {worst:.2e}");
    assert!(worst < 2e-6, "{worst}");
}
