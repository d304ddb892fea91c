//! Motion values on scenes whose motion is known.

mod support;

use std::ops::ControlFlow;

use support::{STANDARD, Shape, random_network, random_scene, random_splats};
use trapeze_cpu::motion::{MotionOptions, measure_motion};
use trapeze_scene::{Clusters, DeformationNetwork, MotionMeasure, Scene};

fn go_on(_: usize, _: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// A scene of one splat whose network adds relu(t) times these values to its pose.
fn driven_by_time(per_unit: &[(&str, [f32; 4])]) -> Scene {
    let shape = Shape { width: 8, depth: 3, ..STANDARD };
    let mut tensors = random_network(&shape, 1).to_tensors();
    tensors.values_mut().for_each(|tensor| tensor.data.fill(0.0));
    // Feature 0 carries t through all layers: input 63 is t itself.
    tensors.get_mut("linear.0.weight").unwrap().data[63] = 1.0;
    tensors.get_mut("linear.1.weight").unwrap().data[0] = 1.0;
    tensors.get_mut("linear.2.weight").unwrap().data[84] = 1.0;
    for (head, values) in per_unit {
        let weight = &mut tensors.get_mut(&format!("{head}.weight")).unwrap().data;
        weight.chunks_exact_mut(8).zip(values).for_each(|(row, &v)| row[0] = v);
    }
    let mut splats = random_splats(1, 2);
    splats.rotations[0] = [1.0, 0.0, 0.0, 0.0];
    splats.log_scales[0] = [0.0, 1f32.ln(), 2f32.ln()];
    Scene {
        deformation: Some(DeformationNetwork::from_tensors(tensors).unwrap()),
        ..Scene::from_splats(splats)
    }
}

#[test]
fn a_splat_that_travels_has_its_greatest_distance() {
    let scene = driven_by_time(&[("gaussian_warp", [3.0, 0.0, 4.0, 0.0])]);
    for options in [MotionOptions::default(), MotionOptions::original()] {
        let motion = measure_motion(&scene, &options, go_on).unwrap();
        assert!((motion.values[0] - 5.0).abs() < 1e-5, "{:?}", motion.values);
        assert_eq!(motion.measure, options.measure);
    }
}

#[test]
fn a_splat_that_only_turns_moves_too() {
    // normalise(1 + t·(0, 1, 0, 0)): a quarter turn about x at t = 1, which swaps the variances
    // 1 and 4 of y and z: Σ changes by ±3 on the diagonal, ‖·‖_F = √18.
    let scene = driven_by_time(&[("gaussian_rotation", [0.0, 1.0, 0.0, 0.0])]);
    let motion = measure_motion(&scene, &MotionOptions::default(), go_on).unwrap();
    assert!((f64::from(motion.values[0]) - 18f64.sqrt().sqrt()).abs() < 1e-5);
    let original = measure_motion(&scene, &MotionOptions::original(), go_on).unwrap();
    assert_eq!(original.values, [0.0]);
    assert_eq!(original.measure, MotionMeasure::PositionOnly);
}

#[test]
fn a_cluster_takes_the_value_of_its_liveliest_splat() {
    let mut scene = random_scene(30, &STANDARD, 3);
    let ids: Vec<u32> = (0..30).map(|i| i % 3).collect();
    scene.clusters = Some(Clusters::from_ids(&ids, &[[0.0; 3]; 30]).unwrap());
    let options = MotionOptions { times: vec![0.5, 1.0], ..MotionOptions::default() };
    let single = measure_motion(&scene, &options, go_on).unwrap().values;
    let options = MotionOptions { per_cluster: true, ..options };
    let whole = measure_motion(&scene, &options, go_on).unwrap().values;
    for i in 0..30 {
        let highest = (i % 3..30).step_by(3).map(|j| single[j]).fold(0.0, f32::max);
        assert_eq!(whole[i], highest);
    }
}

#[test]
fn progress_is_reported_and_can_stop_the_measurement() {
    let scene = random_scene(10, &STANDARD, 4);
    let mut calls = Vec::new();
    let stopped = measure_motion(&scene, &MotionOptions::default(), |done, total| {
        calls.push((done, total));
        if done == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(stopped.is_none());
    assert_eq!(calls, [(1, 64), (2, 64), (3, 64)]);
}

#[test]
fn nothing_moves_in_a_static_scene_and_nothing_is_evaluated() {
    let scene = Scene::from_splats(random_splats(5, 5));
    let motion = measure_motion(&scene, &MotionOptions::default(), |_, _| unreachable!()).unwrap();
    assert_eq!(motion.values, [0.0; 5]);
}
