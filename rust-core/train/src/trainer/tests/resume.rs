//! Killed and paused runs end as the uninterrupted one does.

use super::mosaic::{Failure, Failures};
use super::*;
use crate::TrainingState;
use crate::backend::TrainingBackend;
use crate::checkpoint::Progress;
use crate::config::BudgetSearch;

/// All that a run ends with but its seconds.
fn ending(trainer: &mut Trainer<Mosaic>) -> (TrainingState, Progress) {
    finish(trainer);
    let progress = Progress { seconds: 0.0, ..trainer.progress().clone() };
    (trainer.backend().state().unwrap(), progress)
}

fn failing(at: Option<u32>) -> Mosaic {
    let failures: Failures = Failures::default();
    if let Some(step) = at {
        failures.lock().unwrap().insert(step, Failure::LossAbove(0.01));
    }
    Mosaic { failures, ..Mosaic::default() }
}

fn uninterrupted(config: &TrainingConfig, fault: Option<u32>) -> (TrainingState, Progress) {
    let place = Workplace::new();
    ending(&mut place.start(config.clone(), failing(fault)))
}

/// The same run, given up at each of `stops` (steps of work, not of progress) and taken up again
/// by another trainer; saved before where `save` says so.
fn interrupted(
    config: &TrainingConfig,
    fault: Option<u32>,
    stops: &[u32],
    save: bool,
) -> (TrainingState, Progress) {
    let place = Workplace::new();
    let mut trainer = place.start(config.clone(), failing(fault));
    for &stop in stops {
        trainer.advance(stop, &mut |_| ()).unwrap();
        if save {
            trainer.save(&mut |_| ()).unwrap();
        }
        trainer = place.resume(config, failing(fault));
    }
    ending(&mut trainer)
}

#[test]
fn a_killed_run_ends_bit_identical() {
    let config = config(230);
    let expected = uninterrupted(&config, None);
    for stops in [&[1][..], &[49, 3], &[50], &[130, 20, 60], &[229], &[230]] {
        assert_eq!(interrupted(&config, None, stops, false), expected, "{stops:?}");
    }
}

#[test]
fn a_paused_run_goes_on_where_it_was_and_ends_bit_identical() {
    let config = config(230);
    let expected = uninterrupted(&config, None);
    for stops in [&[1][..], &[49, 3], &[50], &[130, 20, 60], &[229], &[230]] {
        assert_eq!(interrupted(&config, None, stops, true), expected, "{stops:?}");
    }
    let place = Workplace::new();
    let mut trainer = place.start(config.clone(), Mosaic::default());
    trainer.advance(130, &mut |_| ()).unwrap();
    let mut saved = Vec::new();
    assert!(trainer.save(&mut |event| saved.push(event)).unwrap().is_some());
    assert!(matches!(saved[..], [Event::Saved { step: 130, .. }]));
    assert_eq!(place.resume(&config, Mosaic::default()).step(), 130);
}

#[test]
fn interruptions_around_a_fault_change_nothing() {
    let config = config(230);
    let expected = uninterrupted(&config, Some(130));
    assert_ne!(expected, uninterrupted(&config, None));
    for save in [false, true] {
        // Before the fault, between the fault and its report, right after the roll-back.
        for stops in [&[129][..], &[131], &[140, 9], &[147, 30], &[120, 15, 15]] {
            assert_eq!(interrupted(&config, Some(130), stops, save), expected, "{save} {stops:?}");
        }
    }
}

#[test]
fn a_search_ends_bit_identical_whenever_it_is_interrupted() {
    use super::searches::{frequently_searching, searching};
    for config in [searching(280), frequently_searching(280)] {
        let expected = uninterrupted(&config, None);
        for save in [false, true] {
            // 84: a branch of the second trial, which begins at step 40, grows at its steps 40 to 48.
            for stops in [&[25][..], &[39, 41], &[60, 5, 90], &[84], &[300]] {
                assert_eq!(interrupted(&config, None, stops, save), expected, "{save} {stops:?}");
            }
        }
    }
}

#[test]
fn a_run_that_waits_to_be_thinned_is_paused_where_it_is_and_ends_bit_identical() {
    let mut config = super::searches::searching(560);
    // Nothing may be added: from the first trial that is due on, at step 40, the search waits.
    let search = BudgetSearch { most_numbers: Some(0), ..config.search.unwrap() };
    config.search = Some(search);
    let expected = uninterrupted(&config, None);
    assert_eq!(expected.1.search.as_ref().unwrap().all_views_from, Some(40));
    for save in [false, true] {
        for stops in [&[39][..], &[40], &[41, 30], &[57, 100]] {
            assert_eq!(interrupted(&config, None, stops, save), expected, "{save} {stops:?}");
        }
    }
    let place = Workplace::new();
    let mut trainer = place.start(config.clone(), Mosaic::default());
    trainer.advance(57, &mut |_| ()).unwrap();
    trainer.save(&mut |_| ()).unwrap();
    assert_eq!(place.resume(&config, Mosaic::default()).step(), 57);
}

#[test]
fn other_datasets_and_settings_are_refused_by_name() {
    let place = Workplace::new();
    drop(place.start(config(230), Mosaic::default()));
    let refusal = |dataset: &Dataset, config: &TrainingConfig| {
        let result = Trainer::resume(dataset, config.clone(), Mosaic::default(), place.options());
        result.err().unwrap().to_string()
    };
    let other = TrainingConfig { seed: 9, ..config(230) };
    let message = refusal(&place.dataset, &other);
    assert_eq!(message, "resume: settings: expected seed 0 as in the checkpoint, found seed 9");
    let mut moved = place.dataset.clone();
    moved.views[1].camera.cx += 0.5;
    let message = refusal(&moved, &config(230));
    assert!(message.starts_with("resume: dataset: expected 15 views of 16 x 12"), "{message}");
}

#[test]
fn resuming_where_nothing_is_starts() {
    let place = Workplace::new();
    let trainer = place.resume(&config(10), Mosaic::default());
    assert_eq!(trainer.step(), 0);
    assert!(place.checkpoints().load_newest().unwrap().is_some());
}
