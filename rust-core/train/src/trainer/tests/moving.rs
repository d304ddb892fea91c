//! Runs of scenes that move, on the CPU's own backend.

use std::ops::ControlFlow;

use glam::DVec3;
use trapeze_scene::{DeformationNetwork, Scene};

use super::*;
use crate::backend::TrainingBackend;
use crate::config::{Background, DeformationTraining};
use crate::{CpuBackend, TrainedNetwork, deformation_for_training, with_measured_motion};

/// The capture, each photograph at a time of its own.
fn moving_place() -> Workplace {
    let mut place = Workplace::new();
    let last = (place.dataset.views.len() - 1) as f32;
    for (i, view) in place.dataset.views.iter_mut().enumerate() {
        view.time = Some(i as f32 / last);
    }
    place
}

fn moving_config(steps: u32) -> TrainingConfig {
    let deformation =
        DeformationTraining { warm_up: 10, time_noise: 0.01, ..DeformationTraining::default() };
    TrainingConfig { deformation: Some(deformation), checkpoint_interval: 15, ..config(steps) }
}

fn start(place: &Workplace, config: &TrainingConfig) -> Result<Trainer<CpuBackend>, TrainError> {
    Trainer::start(&place.dataset, config.clone(), CpuBackend::default(), place.options())
}

/// The run, stopped after each of `stops` steps, saved there or not, and taken up again.
fn run(place: &Workplace, config: &TrainingConfig, stops: &[u32], save: bool) -> Scene {
    let mut trainer = start(place, config).unwrap();
    for &stop in stops {
        trainer.advance(stop, &mut |_| ()).unwrap();
        if save {
            trainer.save(&mut |_| ()).unwrap();
        }
        let backend = CpuBackend::default();
        trainer =
            Trainer::resume(&place.dataset, config.clone(), backend, place.options()).unwrap();
    }
    trainer.advance(u32::MAX, &mut |_| ()).unwrap();
    trainer.scene().unwrap()
}

#[test]
fn a_killed_or_paused_run_of_a_moving_scene_ends_bit_identical() {
    let config = moving_config(40);
    let expected = run(&moving_place(), &config, &[], false);
    let network = expected.deformation.as_ref();
    assert!(network.is_some_and(DeformationNetwork::is_standard));
    for (stops, save) in [(&[19][..], false), (&[7, 14][..], true)] {
        assert_eq!(run(&moving_place(), &config, stops, save), expected, "{stops:?}");
    }
}

#[test]
fn a_killed_or_paused_run_with_splats_at_rest_ends_bit_identical() {
    let mut config = moving_config(40);
    let motion = config.deformation.as_mut().unwrap();
    // Photographs of one place: what the network has learned in a few steps moves by less.
    (motion.rest_from, motion.rest_within) = (12, 0.5);
    let place = moving_place();
    let mut trainer = start(&place, &config).unwrap();
    trainer.advance(u32::MAX, &mut |_| ()).unwrap();
    let record = trainer.summary().rest.unwrap();
    let splats = u64::from(trainer.splat_count());
    assert!(record.resting > 0 && record.spared > 0, "{record:?}");
    assert!(record.spared < record.evaluations && record.evaluations <= 30 * splats, "{record:?}");
    let expected = trainer.scene().unwrap();
    for (stops, save) in [(&[29][..], false), (&[17, 16][..], true)] {
        assert_eq!(run(&moving_place(), &config, stops, save), expected, "{stops:?}");
    }
    let all = TrainingConfig {
        deformation: config
            .deformation
            .map(|motion| DeformationTraining { rest_within: 0.0, ..motion }),
        ..config
    };
    assert_ne!(run(&moving_place(), &all, &[], false), expected);
}

#[test]
fn a_killed_search_of_a_moving_scene_ends_bit_identical() {
    let mut config = super::searches::frequently_searching(140);
    let motion = DeformationTraining { warm_up: 10, undisturbed: 0, ..Default::default() };
    config.deformation = Some(motion);
    if let Some(densification) = &mut config.densification {
        densification.max_splats = 30;
    }
    let place = moving_place();
    let mut trainer = start(&place, &config).unwrap();
    trainer.advance(u32::MAX, &mut |_| ()).unwrap();
    let search = trainer.summary().search.unwrap();
    // States are taken out of the backend, put back and replaced, whichever branch is kept.
    assert!(search.trials.iter().any(|trial| trial.kept), "{search:?}");
    assert!(search.trials.iter().any(|trial| !trial.kept), "{search:?}");
    let expected = trainer.scene().unwrap();
    assert_eq!(run(&moving_place(), &config, &[35, 52], true), expected);
}

#[test]
fn a_roll_back_restores_the_network() {
    let (place, config) = (moving_place(), moving_config(40));
    let mut trainer = start(&place, &config).unwrap();
    trainer.advance(15, &mut |_| ()).unwrap();
    let good = trainer.backend().state().unwrap();
    assert!(good.network.as_ref().is_some_and(|trained| !trained.is_at_rest()));
    trainer.advance(5, &mut |_| ()).unwrap();
    let mut damaged = trainer.backend().state().unwrap();
    if let Some(trained) = &mut damaged.network {
        trained.network.rotation_head.bias[1] = f32::NAN;
    }
    let capacity = damaged.splats.len() as u32;
    trainer.backend().load(damaged, capacity).unwrap();
    let mut returned_to = None;
    while returned_to.is_none() && !trainer.is_finished() {
        let taken = trainer.advance(1, &mut |event| {
            if let Event::RolledBack { to, .. } = event {
                returned_to = Some(to);
            }
        });
        taken.unwrap();
    }
    assert_eq!(returned_to, Some(15));
    assert_eq!(trainer.backend().state().unwrap(), good);
}

#[test]
fn a_run_that_ends_while_it_warms_up_gives_a_static_scene() {
    let place = moving_place();
    let scene = run(&place, &moving_config(8), &[], false);
    assert!(scene.deformation.is_none());
}

#[test]
fn the_estimate_of_the_memory_includes_the_network() {
    let place = moving_place();
    let bytes = |config: &TrainingConfig| start(&place, config).unwrap().memory();
    let (moving, at_rest) = (bytes(&moving_config(40)), bytes(&config(40)));
    let network = TrainedNetwork::bytes();
    assert_eq!(network, 3 * 4 * 506_378);
    assert_eq!(moving.parameters - at_rest.parameters, network + network / 3);
    assert_eq!(moving.copies - at_rest.copies, network);
    assert!(moving.working >= at_rest.working + (32 << 20));
}

#[test]
fn photographs_of_one_moment_and_geographic_coordinates_are_refused_by_name() {
    let refusal = |place: &Workplace| start(place, &moving_config(40)).err().unwrap().to_string();
    let error = refusal(&Workplace::new());
    assert!(error.starts_with("dataset: times of the training views: expected more"), "{error}");
    let mut far = moving_place();
    far.dataset.origin = DVec3::new(5e5, 4e6, 0.0);
    let error = refusal(&far);
    assert!(error.starts_with("dataset: origin: expected coordinates near 0"), "{error}");
}

#[test]
fn settings_follow_from_the_times_of_the_photographs() {
    let place = Workplace::new();
    assert_eq!(deformation_for_training(&place.dataset, 40_000).unwrap(), None);
    let place = moving_place();
    let settings = |steps| deformation_for_training(&place.dataset, steps).unwrap().unwrap();
    // 15 of 18 photographs are trained on, from 1/17 to 17/17: every eighth is held out, the first
    // among them. Their mean interval is (16/17)/14.
    let captured = settings(40_000);
    assert!((captured.time_noise - 0.1 * (16.0 / 17.0) / 14.0).abs() < 1e-7, "{captured:?}");
    assert_eq!((captured.warm_up, captured.noisy_steps), (300, 20_000));
    assert_eq!((settings(4_000).warm_up, settings(4_000).noisy_steps), (200, 2_000));
    assert_eq!((captured.undisturbed, settings(4_000).undisturbed), (3_000, 600));
    assert_eq!(settings(400_000).warm_up, 300);
    assert_eq!(settings(1).noisy_steps, 1);
    for index in place.dataset.training_views() {
        let path = &place.dataset.views[index].image_path;
        image::RgbaImage::new(captures::WIDTH, captures::HEIGHT).save(path).unwrap();
    }
    assert_eq!(settings(40_000), DeformationTraining { time_noise: 0.0, ..captured });
    assert_eq!(crate::background_for_training(&place.dataset).unwrap(), Background::Random);
}

#[test]
fn measuring_motion_ends_when_it_is_told_to() {
    let place = moving_place();
    let scene = run(&place, &moving_config(12), &[], false);
    let mut calls = 0;
    let broken_off = |calls: &mut u32| {
        *calls += 1;
        ControlFlow::Break(())
    };
    let (_, summary) =
        with_measured_motion(scene.clone(), &place.dataset, || broken_off(&mut calls)).unwrap();
    assert_eq!((summary, calls), (None, 1));
    let go_on = || ControlFlow::Continue(());
    let (measured, summary) = with_measured_motion(scene, &place.dataset, go_on).unwrap();
    let motion = measured.motion.unwrap();
    assert_eq!(motion.recommended_percentile, summary.map(|s| s.recommended_percentile));
}
