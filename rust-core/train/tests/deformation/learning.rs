//! What a network learns, and when it is left alone.

use trapeze_train::evaluation::psnr_of;

use super::*;

/// Mean PSNR on moments that no step has seen.
fn test_psnr(backend: &mut CpuBackend) -> f64 {
    let times = [0.08, 0.22, 0.41, 0.57, 0.71, 0.93];
    let views = views(&times);
    let psnr = views.iter().map(|view| {
        let frame = render(backend, view);
        psnr_of(&frame.color, &photograph_of(balls(view.time), &view.camera), [0.0; 3])
    });
    psnr.sum::<f64>() / times.len() as f64
}

/// The balls at the middle of their way, moved a little.
fn start() -> Splats {
    let mut splats = balls(0.5);
    for (i, position) in splats.positions.iter_mut().enumerate() {
        position[i % 3] += 0.05;
    }
    splats
}

#[test]
fn moving_balls_are_learned_between_the_moments_that_were_seen() {
    let times: Vec<f32> = (0..16u8).map(|i| f32::from(i) / 15.0).collect();
    let views = views(&times);
    let trained = |deformation: Option<DeformationTraining>| {
        let config = config(500, deformation);
        let mut backend = loaded(start(), &config, &views);
        assert!(take_steps(&mut backend, &views, &config).iter().all(StepReport::is_sound));
        test_psnr(&mut backend)
    };
    let at_rest = trained(None);
    let moving =
        trained(Some(DeformationTraining { warm_up: 50, ..DeformationTraining::default() }));
    println!("static {at_rest:.2} dB, moving {moving:.2} dB");
    assert!(moving > at_rest + 5.0, "{at_rest} {moving}");
}

#[test]
fn while_warming_up_the_network_is_neither_evaluated_nor_changed() {
    let views = views(&[0.0, 0.5, 1.0]);
    let warming =
        DeformationTraining { warm_up: 30, undisturbed: 0, ..DeformationTraining::default() };
    let mut config = config(20, Some(warming));
    let mut backend = loaded(start(), &config, &views);
    take_steps(&mut backend, &views, &config);
    let state = backend.state().unwrap();
    assert_eq!(state.network, Some(TrainedNetwork::standard(config.seed)));
    // The same splats as a run that knows no network.
    config.deformation = None;
    let mut at_rest = loaded(start(), &config, &views);
    take_steps(&mut at_rest, &views, &config);
    assert_eq!(at_rest.state().unwrap().splats, state.splats);
}

#[test]
fn a_step_counts_from_the_end_of_the_warm_up() {
    let views = views(&[0.0, 0.5, 1.0]);
    let training = DeformationTraining { warm_up: 3, ..DeformationTraining::default() };
    let config = config(4, Some(training));
    let mut backend = loaded(start(), &config, &views);
    take_steps(&mut backend, &views, &config);
    let trained = backend.state().unwrap().network.unwrap();
    // The heads are zero at the first step, so only they get a gradient; Adam's first step has the
    // size of the rate.
    let moved = trained.network.scale_head.bias[0].abs();
    assert!((moved - 8e-4).abs() < 1e-7, "{moved}");
    assert_eq!(trained.network.hidden, TrainedNetwork::standard(config.seed).network.hidden);
}
