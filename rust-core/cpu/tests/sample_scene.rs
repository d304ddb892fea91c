//! The deformation stage on a trained network, against outputs computed in f64 by the code that
//! trained it.

#[path = "support/sample_scene.rs"]
mod sample_scene;

use std::ops::ControlFlow;

use glam::DVec3;
use trapeze_cpu::deform::DeformationStage;
use trapeze_cpu::motion::{MotionOptions, measure_motion};
use trapeze_cpu::reference::deform::{NetworkOutput, Pose};
use trapeze_cpu::reference::deform::{apply_output, canonical_pose, evaluate_network};
use trapeze_formats::read_npz;
use trapeze_scene::Scene;

/// Golden outputs: (time, splat, output).
fn goldens() -> Vec<(f32, usize, NetworkOutput)> {
    let arrays =
        read_npz(&sample_scene::repository("tests/goldens/sample-scene/deform_f64.npz")).unwrap();
    let splats = arrays["index"].values.to_f64();
    let mut goldens = Vec::new();
    for (name, t) in [("t0.0", 0.0), ("t0.5", 0.5), ("t1.0", 1.0)] {
        assert_eq!(arrays[name].shape, [splats.len(), 10]);
        let outputs = arrays[name].values.to_f64();
        for (&splat, v) in splats.iter().zip(outputs.chunks_exact(10)) {
            let output = NetworkOutput {
                displacement: std::array::from_fn(|c| v[c]),
                d_rotation: std::array::from_fn(|c| v[3 + c]),
                d_scale: std::array::from_fn(|c| v[7 + c]),
            };
            goldens.push((t, splat as usize, output));
        }
    }
    goldens
}

fn flatten(output: &NetworkOutput) -> impl Iterator<Item = f64> {
    output.displacement.into_iter().chain(output.d_rotation).chain(output.d_scale)
}

#[test]
fn the_specification_gives_the_outputs_of_the_training_code() {
    let scene = sample_scene::load();
    let network = scene.deformation.as_ref().unwrap();
    for (t, splat, golden) in goldens() {
        let world = scene.splats.positions[splat].map(f64::from);
        let output = evaluate_network(network, world, f64::from(t));
        for (ours, theirs) in flatten(&output).zip(flatten(&golden)) {
            // Both are f64 and differ in the order of sums only.
            assert!((ours - theirs).abs() < 1e-12, "splat {splat} at {t}: {ours} {theirs}");
        }
    }
}

#[test]
fn the_fast_stage_is_close_to_the_outputs_of_the_training_code() {
    let scene = sample_scene::load();
    let rule = scene.deformation.as_ref().unwrap().rotation_rule;
    let mut stage = DeformationStage::new(&scene);
    let mut worst: f64 = 0.0;
    for (t, splat, golden) in goldens() {
        let expected = apply_output(&canonical_pose(&scene.splats, splat), &golden, rule);
        let Pose { position, rotation, scale } = expected;
        let pose = stage.evaluate(t, None).pose(splat);
        let fast = pose.position.into_iter().chain(pose.rotation).chain(pose.scale);
        for (f, e) in fast.zip(position.into_iter().chain(rotation).chain(scale)) {
            worst = worst.max((f64::from(f) - e).abs());
        }
    }
    println!("largest error of the fast stage: {worst:.2e}");
    assert!(worst < 2e-5, "{worst}");
}

#[test]
fn the_original_measure_gives_the_mask_of_the_original_app() {
    let scene = sample_scene::load();
    let theirs = &scene.motion.as_ref().unwrap().values;
    let go_on = |_, _| ControlFlow::Continue(());
    let ours = measure_motion(&scene, &MotionOptions::original(), go_on).unwrap().values;
    let error = |(ours, theirs): (&f32, &f32)| (ours - theirs).abs();
    let worst = ours.iter().zip(theirs).map(error).fold(0.0, f32::max);
    println!("largest difference of motion values: {worst:.2e}");
    // Two f32 networks, each within 2e-5 of the exact displacement, at two times.
    assert!(worst < 8e-5, "{worst}");
}

#[test]
fn a_scene_far_from_zero_keeps_its_motion() {
    let scene = sample_scene::load();
    let picked: Vec<u32> = (0..scene.len() as u32).step_by(50).collect();
    let near = scene.gather(&picked);
    // The same world coordinates, stored relative to another origin.
    let mut stored = near.clone();
    stored.origin = DVec3::new(-0.5, 0.25, 0.125);
    for position in &mut stored.splats.positions {
        for (x, o) in position.iter_mut().zip(stored.origin.to_array()) {
            *x = (f64::from(*x) - o) as f32;
        }
    }
    let pose = |scene: &Scene| DeformationStage::new(scene).evaluate(0.5, None).clone();
    let (near, stored) = (pose(&near), pose(&stored));
    for i in 0..picked.len() {
        for c in 0..4 {
            // Positions that were rounded again differ by 6e-8, and the highest octave of the
            // encoding turns that into 3e-5 of one input.
            assert!((near.rotations[i][c] - stored.rotations[i][c]).abs() < 1e-4, "splat {i}");
        }
    }
}
