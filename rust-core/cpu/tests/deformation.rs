//! The deformation stage against its f64 specification, and that against outputs of the training
//! code's own network evaluation in f64.

mod support;

use fearless_simd::Level;
use glam::DVec3;
use support::{Random, STANDARD, Shape, random_network, random_scene, random_splats};
use trapeze_cpu::deform::{DeformationOptions, DeformationStage, Deformed, MAX_SCALE};
use trapeze_cpu::reference::deform::{MIN_DEFORMED_SCALE, deform_splat};
use trapeze_scene::deformation::RotationRule;
use trapeze_scene::{DeformationNetwork, Motion, Scene};

/// Largest difference between the fast stage and the specification, per component. The f32 sums
/// of eight layers of 256 products lose about 2⁻²⁴ · √256 · 8 ≈ 8e-6 of activations of size 1.
const TOLERANCE: f64 = 2e-5;

fn reference(scene: &Scene, i: usize, t: f64) -> ([f64; 3], [f64; 4], [f64; 3]) {
    let network = scene.deformation.as_ref().unwrap();
    let pose = deform_splat(network, &scene.splats, i, scene.origin, t);
    (pose.position, pose.rotation, pose.scale)
}

/// Largest component-wise difference of `deformed` from the specification, over all splats.
fn worst_error(scene: &Scene, deformed: &Deformed, t: f64) -> f64 {
    let mut worst: f64 = 0.0;
    for i in 0..scene.len() {
        let pose = deformed.pose(i);
        let (position, rotation, scale) = reference(scene, i, t);
        let fast = pose.position.into_iter().chain(pose.rotation).chain(pose.scale);
        let exact = position.into_iter().chain(rotation).chain(scale);
        for (f, e) in fast.zip(exact) {
            worst = worst.max((f64::from(f) - e).abs());
            assert!(!f.is_nan(), "splat {i}");
        }
    }
    worst
}

#[test]
fn every_published_variant_agrees_with_the_specification() {
    let variants = [
        ("standard", STANDARD),
        ("blender", Shape { inputs: 93, blender: true, ..STANDARD }),
        ("6-dof", Shape { six_dof: true, ..STANDARD }),
        ("blender and 6-dof", Shape { inputs: 93, blender: true, six_dof: true, ..STANDARD }),
        ("3 octaves", Shape { inputs: 42, ..STANDARD }),
        ("narrow", Shape { width: 40, depth: 3, ..STANDARD }),
        ("wide", Shape { width: 300, depth: 4, ..STANDARD }),
    ];
    for (seed, (name, shape)) in variants.into_iter().enumerate() {
        // Not a multiple of the group size: the last group is filled up.
        let scene = random_scene(203, &shape, seed as u64);
        let mut stage = DeformationStage::new(&scene);
        for t in [0.0, 0.37, 1.0] {
            let worst = worst_error(&scene, stage.evaluate(t, None), f64::from(t));
            assert!(worst < TOLERANCE, "{name} at {t}: {worst}");
        }
    }
}

#[test]
fn options_do_not_change_the_result() {
    let scene = random_scene(100, &STANDARD, 7);
    let expected = DeformationStage::new(&scene).evaluate(0.3, None).clone();
    let options = DeformationOptions { position_term_budget: 0, ..DeformationOptions::default() };
    let recomputed = DeformationStage::with_options(&scene, options).evaluate(0.3, None).clone();
    assert_eq!(recomputed, expected);
    let options = DeformationOptions { level: Level::baseline(), ..options };
    let mut stage = DeformationStage::with_options(&scene, options);
    assert!(worst_error(&scene, stage.evaluate(0.3, None), f64::from(0.3f32)) < TOLERANCE);
}

#[test]
fn the_result_is_the_same_on_any_number_of_threads() {
    let scene = random_scene(1000, &STANDARD, 8);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| DeformationStage::new(&scene).evaluate(0.6, None).clone())
    };
    assert_eq!(on(1), on(5));
}

#[test]
fn static_splats_hold_their_deformed_state_at_zero_whatever_came_before() {
    let scene = random_scene(300, &STANDARD, 9);
    let mut stage = DeformationStage::new(&scene);
    let initial = stage.evaluate(0.0, None).clone();
    let later = stage.evaluate(0.8, None).clone();
    let masks: [Vec<u32>; 4] =
        [(0..300).step_by(7).collect(), (0..300).step_by(2).collect(), vec![299], vec![]];
    for dynamic in &masks {
        // The same mask twice: the second frame does not touch the static splats.
        for (t, moved) in [(0.8, &later), (0.0, &initial), (0.8, &later)] {
            let masked = stage.evaluate(t, Some(dynamic));
            for i in 0..300 {
                // Bit for bit: who else is evaluated does not change a splat's sums.
                let expected = if dynamic.contains(&(i as u32)) { moved } else { &initial };
                assert_eq!(masked.pose(i), expected.pose(i), "splat {i} at {t}");
            }
        }
        stage.evaluate(0.5, None);
    }
}

#[test]
fn a_threshold_selects_the_splats_that_move_by_more() {
    let mut scene = random_scene(50, &STANDARD, 10);
    let values = (0..50).map(|i| i as f32).collect();
    scene.motion = Some(Motion { values, ..Motion::default() });
    let mut stage = DeformationStage::new(&scene);
    let dynamic: Vec<u32> = (31..50).collect();
    let expected = stage.evaluate(0.4, Some(&dynamic)).clone();
    assert_eq!(stage.deform(&scene, 0.4, Some(30.0)), &expected);
    let all = stage.deform(&scene, 0.4, None).clone();
    assert_ne!(all, expected);
    assert_eq!(stage.deform(&scene, 0.4, Some(30.0)), &expected);
    assert_eq!(stage.deform(&scene, 0.4, Some(-1.0)), &all);
    scene.motion = None;
    assert_eq!(stage.deform(&scene, 0.4, Some(30.0)), &all);
}

#[test]
fn any_time_gives_finite_poses_and_none_is_taken_as_zero() {
    let scene = random_scene(60, &STANDARD, 11);
    let mut stage = DeformationStage::new(&scene);
    for t in [-2.0, 1.5, 100.0] {
        let worst = worst_error(&scene, stage.evaluate(t, None), f64::from(t));
        assert!(worst < 10.0 * TOLERANCE, "{t}: {worst}");
    }
    let initial = stage.evaluate(0.0, None).clone();
    for t in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(stage.evaluate(t, None), &initial, "{t}");
    }
    let extreme = stage.evaluate(f32::MAX, None);
    assert!(extreme.positions.iter().flatten().all(|x| x.is_finite()));
}

/// A network whose answer is the same for every splat and time.
fn constant_network(displacement: f32, d_rotation: [f32; 4], d_scale: f32) -> DeformationNetwork {
    let mut tensors = random_network(&Shape { width: 8, depth: 3, ..STANDARD }, 1).to_tensors();
    tensors.values_mut().for_each(|tensor| tensor.data.fill(0.0));
    tensors.get_mut("gaussian_warp.bias").unwrap().data.fill(displacement);
    tensors.get_mut("gaussian_scaling.bias").unwrap().data.fill(d_scale);
    tensors.get_mut("gaussian_rotation.bias").unwrap().data.copy_from_slice(&d_rotation);
    DeformationNetwork::from_tensors(tensors).unwrap()
}

#[test]
fn degenerate_rotations_and_scales_follow_the_rules() {
    let mut splats = random_splats(6, 12);
    splats.rotations = vec![
        [0.0; 4],
        [f32::NAN, 0.0, 0.0, 0.0],
        [0.0, 1e-20, 0.0, 0.0],
        [0.0, 1e20, 0.0, 0.0],
        [0.6, 0.8, 0.0, 0.0],
        [1.0, 0.0, 0.0, 0.0],
    ];
    splats.log_scales[0] = [40.0; 3];
    splats.log_scales[1] = [-40.0; 3];
    splats.log_scales[2] = [f32::NAN; 3];
    for rule in [RotationRule::Renormalised, RotationRule::AsTrained] {
        // Cancels the rotation about x, and every scale below 1.
        let mut network = constant_network(0.5, [0.0, -1.0, 0.0, 0.0], -1.0);
        network.rotation_rule = rule;
        let scene = Scene { deformation: Some(network), ..Scene::from_splats(splats.clone()) };
        let mut stage = DeformationStage::new(&scene);
        let deformed = stage.evaluate(0.5, None).clone();
        for i in [2, 3] {
            assert_eq!(deformed.rotations[i], [1.0, 0.0, 0.0, 0.0], "cancelled");
        }
        let sum = [1.0, -1.0, 0.0, 0.0];
        let length = if rule == RotationRule::AsTrained { 1.0 } else { 2f32.sqrt() };
        for i in [0, 1, 5] {
            for c in 0..4 {
                assert!((deformed.rotations[i][c] - sum[c] / length).abs() < 1e-6, "splat {i}");
            }
        }
        assert_eq!(deformed.scales[0], [MAX_SCALE; 3]);
        assert_eq!(deformed.scales[1], [MIN_DEFORMED_SCALE as f32; 3]);
        assert!(deformed.scales[2].iter().all(|s| s.is_nan()), "left out by the projection");
        assert_eq!(deformed.scales[4], [MIN_DEFORMED_SCALE as f32; 3]);
        for i in [0, 1, 3, 4, 5] {
            let (_, rotation, scale) = reference(&scene, i, 0.5);
            let pose = deformed.pose(i);
            for c in 0..4 {
                assert!((f64::from(pose.rotation[c]) - rotation[c]).abs() < TOLERANCE);
            }
            for c in 0..3 {
                assert!((f64::from(pose.scale[c]) - scale[c]).abs() <= 1e-6 * scale[c]);
            }
        }
    }
}

#[test]
fn positions_that_are_not_numbers_harm_no_other_splat() {
    let mut scene = random_scene(64, &STANDARD, 13);
    let expected = DeformationStage::new(&scene).evaluate(0.5, None).clone();
    scene.splats.positions[20] = [f32::NAN, 0.0, f32::INFINITY];
    let deformed = DeformationStage::new(&scene).evaluate(0.5, None).clone();
    assert!(!deformed.positions[20].iter().all(|x| x.is_finite()), "left out by the projection");
    for i in (0..64).filter(|&i| i != 20) {
        assert_eq!(deformed.pose(i), expected.pose(i), "splat {i}");
    }
}

#[test]
fn the_network_sees_world_coordinates() {
    let near = random_scene(40, &STANDARD, 14);
    let origin = DVec3::new(64.0, -32.0, 128.0);
    let mut moved = near.clone();
    moved.origin = origin;
    for position in &mut moved.splats.positions {
        // Exact: the offsets are powers of two and the positions are rounded to multiples of 2⁻¹².
        *position = position.map(|x| (x * 4096.0).round() / 4096.0);
    }
    let mut world = moved.clone();
    world.origin = DVec3::ZERO;
    for position in &mut world.splats.positions {
        *position = std::array::from_fn(|c| position[c] + origin[c] as f32);
    }
    let moved = DeformationStage::new(&moved).evaluate(0.5, None).clone();
    let world = DeformationStage::new(&world).evaluate(0.5, None).clone();
    assert_eq!(moved.rotations, world.rotations);
    assert_eq!(moved.scales, world.scales);
}

#[test]
fn positions_up_to_8_units_away_keep_the_accuracy() {
    let mut scene = random_scene(100, &STANDARD, 15);
    let mut random = Random(16);
    scene.splats.positions.iter_mut().for_each(|p| *p = random.vector(8.0));
    let worst =
        worst_error(&scene, DeformationStage::new(&scene).evaluate(0.7, None), f64::from(0.7f32));
    assert!(worst < TOLERANCE, "{worst}");
}

#[test]
fn scenes_without_splats_or_network_are_posed() {
    let empty = random_scene(0, &STANDARD, 17);
    assert!(DeformationStage::new(&empty).evaluate(0.5, None).positions.is_empty());
    let one = random_scene(1, &STANDARD, 18);
    assert_eq!(DeformationStage::new(&one).evaluate(0.5, None).positions.len(), 1);

    let scene = Scene::from_splats(random_splats(10, 19));
    let mut stage = DeformationStage::new(&scene);
    assert_eq!(stage.evaluate(0.5, Some(&[1])), &Deformed::from_static(&scene.splats));
}
