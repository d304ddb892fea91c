//! Faults on the way.

use super::mosaic::{Failure, Failures};
use super::*;

/// A run with failures at some steps.
fn run_with(failures: &[(u32, Failure)]) -> (Trainer<Mosaic>, Result<Vec<Event>, TrainError>) {
    let place = Workplace::new();
    let shared: Failures = Failures::default();
    shared.lock().unwrap().extend(failures.iter().copied());
    let backend = Mosaic { failures: shared, ..Mosaic::default() };
    let mut trainer = place.start(config(200), backend);
    let mut events = Vec::new();
    while !trainer.is_finished() {
        if let Err(error) = trainer.advance(7, &mut |event| events.push(event)) {
            return (trainer, Err(error));
        }
    }
    (trainer, Ok(events))
}

fn rollbacks(events: &[Event]) -> Vec<(u32, f64, String)> {
    let rollback = |event: &Event| match event {
        Event::RolledBack { to, rate_factor, reason, .. } => {
            Some((*to, *rate_factor, reason.clone()))
        }
        _ => None,
    };
    events.iter().filter_map(rollback).collect()
}

#[test]
fn a_loss_that_is_not_finite_returns_to_the_good_state_with_lower_rates_until_it_is_gone() {
    // The rate is 0.02: gone after two roll-backs, at 0.0008.
    let (trainer, events) = run_with(&[(130, Failure::LossAbove(0.001))]);
    let rollbacks = rollbacks(&events.unwrap());
    assert_eq!(rollbacks.len(), 2);
    for (count, (to, rate_factor, reason)) in (1..).zip(&rollbacks) {
        assert_eq!(*to, 100);
        assert!((rate_factor - 0.2f64.powi(count)).abs() < 1e-12);
        assert!(reason.contains("loss of step 130"), "{reason}");
    }
    assert_eq!((trainer.step(), trainer.progress().rollbacks), (200, 2));
}

#[test]
fn skipped_parameters_are_a_fault_too() {
    let (trainer, events) = run_with(&[(10, Failure::SkippedOnce)]);
    let rollbacks = rollbacks(&events.unwrap());
    assert_eq!(rollbacks.len(), 1);
    assert!(rollbacks[0].0 == 0 && rollbacks[0].2.contains("5 parameters"), "{rollbacks:?}");
    assert_eq!(trainer.step(), 200);
}

#[test]
fn a_fault_that_stays_ends_the_run_and_keeps_the_good_state() {
    let (_, events) = run_with(&[(130, Failure::LossAbove(0.0))]);
    let error = events.unwrap_err();
    assert!(matches!(error, TrainError::Diverged { good_step: 100, .. }), "{error:?}");
    let message = error.to_string();
    assert!(message.contains("of step 100, is kept") && !message.contains('\n'), "{message}");
}

#[test]
fn a_lost_device_is_loaded_again_and_changes_nothing_of_the_result() {
    let (mut sound, _) = run_with(&[]);
    let (mut trainer, events) = run_with(&[(120, Failure::DeviceLost(2))]);
    let rollbacks = rollbacks(&events.unwrap());
    assert_eq!(rollbacks.len(), 2);
    assert!(rollbacks.iter().all(|(to, factor, _)| *to == 100 && *factor == 1.0));
    assert_eq!(trainer.scene().unwrap(), sound.scene().unwrap());
    let (_, events) = run_with(&[(120, Failure::DeviceLost(9))]);
    assert!(events.unwrap_err().to_string().contains("unplugged"));
}

#[test]
fn running_out_of_memory_ends_the_run_at_once() {
    let (_, events) = run_with(&[(120, Failure::OutOfMemory)]);
    assert!(events.unwrap_err().to_string().contains("2 bytes are needed"));
}

#[test]
fn without_a_folder_the_good_state_is_in_memory() {
    let place = Workplace::new();
    let failures: Failures = Failures::default();
    failures.lock().unwrap().insert(130, Failure::LossAbove(0.01));
    let backend = Mosaic { failures, ..Mosaic::default() };
    let options = TrainerOptions { checkpoints: None, ..place.options() };
    let mut trainer = Trainer::start(&place.dataset, config(200), backend, options).unwrap();
    let events = finish(&mut trainer);
    assert_eq!(rollbacks(&events).len(), 1);
    assert!(trainer.save(&mut |_| ()).unwrap().is_none());
}
