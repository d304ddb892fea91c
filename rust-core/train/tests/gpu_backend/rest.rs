//! Splats of a moving scene that rest.

use trapeze_scene::deformation::RestingSplats;
use trapeze_train::CpuBackend;
use trapeze_train::rest::{Look, find_resting};

use super::deformation::{WARM_UP, both, config, moving_state, moving_views};
use super::*;

/// All but every third splat rest, with what the network gives them at `time`.
fn resting(backend: &mut dyn TrainingBackend, time: f32) -> RestingSplats {
    let all = find_resting(&backend.look(&[time]).unwrap(), &[], 1.0);
    assert!(all.moving().is_empty());
    let moving: Vec<u32> = (0..all.splats() as u32).filter(|i| i % 3 == 1).collect();
    let held = all.held().iter().enumerate().filter(|(i, _)| i % 3 != 1).map(|(_, held)| *held);
    RestingSplats::new(moving, held.collect()).unwrap()
}

/// The state after one step at `time`, with or without splats that rest as they are at that time.
fn stepped(backend: &mut dyn TrainingBackend, time: f32, rest: bool) -> (TrainingState, f64) {
    backend.load(moving_state(120), 120).unwrap();
    let mut views = moving_views(backend);
    let step = WARM_UP + 1;
    let mut config = config(10);
    config.deformation.as_mut().unwrap().time_noise = 0.0;
    views.iter_mut().for_each(|view| view.time = time);
    if rest {
        let resting = resting(backend, time);
        backend.rest(Some(resting)).unwrap();
    }
    take_steps(backend, &views, &config, step..step + 1);
    let report = backend.reports(step).unwrap()[0];
    (backend.state().unwrap(), report.loss.total)
}

fn largest(values: &[f32]) -> f32 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

fn difference(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).fold(0.0f32, |most, (a, b)| most.max((a - b).abs())) / largest(a)
}

/// What holds the outputs of the very time of the step is in the same place, and its gradient is the
/// same; only the network hears less.
fn compare_with_all_moving(backend: &mut dyn TrainingBackend, name: &str) {
    let (all, expected) = stepped(backend, 0.6, false);
    let (rested, found) = stepped(backend, 0.6, true);
    assert!((found - expected).abs() <= 1e-5 * expected, "{name}: {found} {expected}");
    for group in ParameterGroup::ALL.into_iter().take(5) {
        let (a, b) = (group.of(&all.first_moments), group.of(&rested.first_moments));
        // Outputs are held as differences of sums, rounded to 6e-8 of these.
        assert!(difference(a, b) <= 1e-3, "{name}, {}: {}", group.name(), difference(a, b));
    }
    let [all, heard] = [&all, &rested].map(|state| &state.network.as_ref().unwrap().first_moments);
    assert!(difference(all, heard) > 0.1, "{name}: the network learned from splats at rest");
    assert!(largest(heard) > 0.1 * largest(all), "{name}: the network learned from none");
    assert_eq!(rested.resting.as_ref().map(|resting| resting.moving().len()), Some(40));
}

#[test]
fn splats_at_rest_are_where_they_were_put_and_the_network_learns_from_the_others() {
    compare_with_all_moving(&mut CpuBackend::default(), "CPU");
    if let Some(gpu) = device() {
        compare_with_all_moving(&mut backend(&gpu), "GPU");
    }
}

#[test]
fn both_backends_agree_on_a_step_with_splats_at_rest() {
    let Some(gpu) = device() else { return };
    let [cpu, gpu] = both(&gpu).map(|mut backend| stepped(&mut *backend, 0.6, true).0);
    for group in ParameterGroup::ALL.into_iter().take(5) {
        let found = difference(group.of(&cpu.first_moments), group.of(&gpu.first_moments));
        assert!(found <= 1e-3, "{}: {found}", group.name());
    }
    let [cpu, gpu] = [cpu, gpu].map(|state| state.network.unwrap().first_moments);
    assert!(difference(&cpu, &gpu) <= 1e-3);
}

#[test]
fn both_backends_see_all_splats_at_all_times_whatever_rests() {
    let Some(gpu) = device() else { return };
    let [cpu, gpu] = both(&gpu).map(|mut backend| {
        backend.load(moving_state(50), 50).unwrap();
        let before = backend.look(&[0.0, 0.3]).unwrap();
        let resting = resting(&mut *backend, 0.9);
        backend.rest(Some(resting)).unwrap();
        assert_eq!(backend.look(&[0.0, 0.3]).unwrap(), before);
        assert_eq!(backend.state().unwrap().resting, None);
        before
    });
    let close = |what: &str, a: &[f32], b: &[f32]| {
        assert!(difference(a, b) <= 2e-5, "{what}: {}", difference(a, b));
    };
    let geometries = |look: &Look| [std::slice::from_ref(&look.stored), &look.moments].concat();
    for (cpu, gpu) in geometries(&cpu).iter().zip(geometries(&gpu)) {
        close("positions", cpu.positions.as_flattened(), gpu.positions.as_flattened());
        close("rotations", cpu.rotations.as_flattened(), gpu.rotations.as_flattened());
        close("scales", cpu.scales.as_flattened(), gpu.scales.as_flattened());
    }
    assert_ne!(cpu.moments[0], cpu.moments[1]);
    assert_eq!(cpu.moments.len(), 2);
}

#[test]
fn a_change_of_the_set_ends_all_rest() {
    let check = |backend: &mut dyn TrainingBackend| {
        backend.load(moving_state(120), 130).unwrap();
        let resting = resting(backend, 0.0);
        backend.rest(Some(resting.clone())).unwrap();
        assert_eq!(backend.state().unwrap().resting, Some(resting));
        let seed = 1;
        let plan = trapeze_train::schedule::DensifyPlan { seed, dead_opacity: 0.005, count: 130 };
        backend.densify(&plan).unwrap();
        assert_eq!(backend.state().unwrap().resting, None);
    };
    check(&mut CpuBackend::default());
    if let Some(gpu) = device() {
        check(&mut backend(&gpu));
    }
}
