//! Splats that the network is not evaluated for.

use trapeze_scene::deformation::RestingSplats;

use super::*;

/// Every third splat moves; the others hold some outputs.
fn resting(n: usize) -> RestingSplats {
    let mut random = Random(11);
    let moving: Vec<u32> = (0..n as u32).filter(|i| i % 3 == 1).collect();
    let held = (moving.len()..n).map(|_| random.array::<10>().map(|d| 0.04 * d)).collect();
    RestingSplats::new(moving, held).unwrap()
}

#[test]
fn splats_that_move_are_deformed_and_differentiated_as_if_they_were_alone() {
    let network = network(3, 64);
    let (splats, by_deformed) = (splats(&network, 300), gradients(300));
    let resting = resting(300);
    let alone = |i: usize| by_deformed[i];
    let moving = resting.moving();
    let by_moving: Vec<[f32; 10]> = moving.iter().map(|&i| alone(i as usize)).collect();
    for device in devices() {
        let expected = run(&device, &network, &splats.gather(moving), &by_moving);
        for budget in [AMPLE, 1] {
            let device = device.within(budget);
            let found = run_beside(&device, &network, &splats, &by_deformed, Some(&resting));
            assert_eq!(found.deformed.gather(moving), expected.deformed);
            assert_eq!(found.by_canonical.gather(moving), expected.by_canonical);
            // In chunks the sums are added up in another order.
            let exact: Vec<f64> = expected.by_parameters.iter().copied().map(f64::from).collect();
            assert!(difference(&found.by_parameters, &exact) <= TOLERANCE, "{budget}");
        }
    }
}

#[test]
fn splats_that_rest_get_what_they_hold_and_their_gradients_pass_by_the_network() {
    let Some(device) = devices().pop() else { return };
    let mut network = network(3, 64);
    let (splats, by_deformed) = (splats(&network, 100), gradients(100));
    let resting = resting(100);
    let found = run_beside(&device, &network, &splats, &by_deformed, Some(&resting));
    for (i, held) in resting.resting().zip(resting.held()) {
        let (i, held) = (i as usize, held.map(f64::from));
        // A network that says the same of every splat.
        for head in network.layers_mut().skip(3) {
            head.weight.fill(0.0);
        }
        let PositionHead::Translation(position) = &mut network.position_head else { panic!() };
        position.bias = held[..3].iter().map(|&d| d as f32).collect();
        network.rotation_head.bias = held[3..7].iter().map(|&d| d as f32).collect();
        network.scale_head.bias = held[7..].iter().map(|&d| d as f32).collect();
        let one = splats.gather(&[i as u32]);
        let expected = evaluate(&network, &one, TIME, &by_deformed[i..=i]);
        let deformed = &found.deformed;
        assert!(difference(&deformed.positions[i], &expected.positions) <= TOLERANCE);
        assert!(difference(&deformed.rotations[i], &expected.rotations) <= TOLERANCE);
        assert!(difference(&deformed.log_scales[i], &expected.log_scales) <= TOLERANCE);
        let by = &found.by_canonical;
        assert_eq!(by.positions[i], by_deformed[i][..3]);
        assert!(difference(&by.rotations[i], &expected.by_rotations) <= TOLERANCE);
        if expected.is_smooth {
            assert!(difference(&by.log_scales[i], &expected.by_log_scales) <= TOLERANCE);
        }
    }
}

#[test]
fn all_move_again_when_none_is_to_rest() {
    let Some(gpu) = device() else { return };
    let network = network(3, 64);
    let splats = splats(&network, 50);
    let parameters = flat_parameters(&network);
    let mut deformation =
        DifferentiableDeformation::new(&gpu, &network, &parameters, 50, AMPLE).unwrap();
    let canonical = ParameterBuffers::from_splats(&gpu, &splats, 50).unwrap();
    let mut deformed = |resting: Option<&RestingSplats>| {
        deformation.set_resting(resting).unwrap();
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        deformation.forward(&mut pass, &canonical, TIME).unwrap();
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        deformation.deformed(&canonical).read(&gpu).unwrap()
    };
    let before = deformed(None);
    assert_ne!(deformed(Some(&resting(50))), before);
    let all = RestingSplats::new(Vec::new(), vec![[0.0; 10]; 50]).unwrap();
    assert_eq!(deformed(Some(&all)).positions, splats.positions);
    assert_eq!(deformed(None), before);
    let error = deformation.set_resting(Some(&resting(51))).unwrap_err();
    assert!(matches!(error, GpuError::OutOfMemory { .. }), "{error}");
}
