//! Values that are not finite, and rates that explode.

use trapeze_train::{ParameterGroup, network_parameters};

use super::*;

fn is_finite(splats: &Splats) -> bool {
    ParameterGroup::ALL.iter().all(|group| group.of(splats).iter().all(|v| v.is_finite()))
}

fn network_is_finite(state: &TrainingState) -> bool {
    let trained = state.network.as_ref().unwrap();
    let moments = trained.first_moments.iter().chain(&trained.second_moments);
    network_parameters(&trained.network).iter().chain(moments).all(|v| v.is_finite())
}

#[test]
fn a_network_rate_that_explodes_leaves_everything_finite() {
    let views = views(&[0.0, 0.5, 1.0]);
    let exploding = DeformationTraining {
        warm_up: 2,
        rate_start: 1e6,
        rate_end: 1e6,
        ..DeformationTraining::default()
    };
    let config = config(12, Some(exploding));
    let mut backend = loaded(balls(0.5), &config, &views);
    let reports = take_steps(&mut backend, &views, &config);
    let state = backend.state().unwrap();
    assert!(is_finite(&state.splats) && network_is_finite(&state), "{reports:?}");
    let trained = state.network.unwrap();
    assert!(trained.network.scale_head.bias[0].abs() >= 1e5);
}

#[test]
fn weights_that_are_not_finite_are_counted_and_spread_no_further() {
    let views = views(&[0.0, 0.5, 1.0]);
    let training = DeformationTraining { warm_up: 0, ..DeformationTraining::default() };
    let config = config(6, Some(training));
    let mut backend = loaded(balls(0.5), &config, &views);
    take_steps(&mut backend, &views, &config);
    let mut state = backend.state().unwrap();
    let trained = state.network.as_mut().unwrap();
    trained.network.hidden[3].weight[7] = f32::NAN;
    backend.load(state, 5).unwrap();
    let reports = take_steps(&mut backend, &views, &config);
    assert!(reports.iter().all(|report| report.not_finite > 0), "{reports:?}");
    let mut after = backend.state().unwrap();
    assert!(is_finite(&after.splats));
    let weight = &mut after.network.as_mut().unwrap().network.hidden[3].weight[7];
    assert!(weight.is_nan());
    *weight = 0.0;
    assert!(network_is_finite(&after));
}

#[test]
fn splats_out_of_view_and_times_that_are_no_numbers_change_nothing_of_the_network() {
    let mut views = views(&[f32::NAN, f32::INFINITY, 1e30]);
    let mut away = balls(0.5);
    away.positions.iter_mut().for_each(|p| p[1] += 1e3);
    let training = DeformationTraining { warm_up: 0, ..DeformationTraining::default() };
    let config = config(6, Some(training));
    for view in &mut views {
        view.camera = camera(0);
    }
    let mut backend = loaded(away, &config, &views);
    let reports = take_steps(&mut backend, &views, &config);
    assert!(reports.iter().all(|report| report.is_sound() && report.visible == 0));
    let state = backend.state().unwrap();
    assert_eq!(state.network, Some(TrainedNetwork::standard(config.seed)));
}
