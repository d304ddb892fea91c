//! Searching for the budget.

use trapeze_scene::ShDegree;

use super::*;
use crate::config::BudgetSearch;
use crate::search_for_training;
use crate::trainer::{Proposal, Trial};

/// 12 splats, far fewer than the 192 pixels need, up to 400.
pub(super) fn searching(steps: u32) -> TrainingConfig {
    let mut config = config(steps);
    config.initial.random_count = 12;
    // A price that the first doublings of a mosaic are worth.
    config.search = Some(BudgetSearch { growth: 1.0, least_gain: 0.1, ..BudgetSearch::default() });
    if let Some(densification) = &mut config.densification {
        densification.max_splats = 400;
    }
    config
}

/// The same with several densification steps in every trial, and growth over them.
pub(super) fn frequently_searching(steps: u32) -> TrainingConfig {
    let mut config = searching(steps);
    if let Some(densification) = &mut config.densification {
        densification.interval = steps / 112;
    }
    if let Some(search) = &mut config.search {
        search.gradual = true;
    }
    config
}

fn trials(events: &[Event]) -> Vec<Trial> {
    let trial = |event: &Event| match event {
        Event::Trial(trial) => Some(*trial),
        _ => None,
    };
    events.iter().filter_map(trial).collect()
}

#[test]
fn what_pays_is_kept_and_what_does_not_is_undone() {
    let place = Workplace::new();
    let mut trainer = place.start(searching(560), Mosaic::default());
    let events = finish(&mut trainer);
    let trials = trials(&events);
    assert!(trials.len() >= 4, "{trials:?}");
    for trial in &trials {
        let gain = trial.psnr_with - trial.psnr_without;
        assert_eq!(trial.kept, gain >= trial.required_gain, "{trial:?}");
        match trial.proposal {
            Proposal::Splats(splats) if splats < trial.splats => {
                assert!(trial.required_gain < 0.0, "{trial:?}");
            }
            Proposal::Splats(splats) => {
                assert!([2, 4].map(|n| n * trial.splats).contains(&splats) || splats == 400);
            }
            // Bands show nothing in a mosaic.
            Proposal::ShDegree(degree) => assert!(degree == 1 && gain == 0.0 && !trial.kept),
        }
    }
    let search = trainer.progress().search.clone().unwrap();
    assert_eq!(search.trials, trials);
    assert!(search.splats > 12 && search.sh_degree == 0, "{search:?}");
    assert_eq!((trainer.splat_count(), trainer.step()), (search.splats, 560));
    assert!(events.iter().any(|event| matches!(event, Event::SearchEnded { .. })));
    assert_eq!(trainer.summary().search, Some(search));
}

#[test]
fn a_branch_grows_by_a_little_at_a_time_and_is_whole_for_half_of_its_trial() {
    let place = Workplace::new();
    let mut trainer = place.start(frequently_searching(560), Mosaic::default());
    let mut grown = 0;
    while !trainer.is_finished() {
        let before = trainer.splat_count();
        trainer.advance(1, &mut |_| ()).unwrap();
        let Some(trial) = &trainer.trial else { continue };
        let Some(Proposal::Splats(proposed)) = trial.change() else { continue };
        let begin = trial.end - trainer.config.trial_steps();
        let (step, splats) = (trainer.step, trainer.splat_count());
        let present = trainer.progress.search.as_ref().unwrap().splats;
        if proposed < present || step <= begin {
            continue;
        }
        // At most a doubled stride, times four, in four parts.
        assert!(splats >= present && splats <= proposed && splats <= before * 3 / 2 + 1);
        assert!(2 * (step - begin) <= 40 || splats == proposed, "{splats} of {proposed}");
        grown += u32::from(step == begin + 40 - 1);
    }
    assert!(grown >= 3, "{grown}");
}

#[test]
fn the_first_branch_of_a_trial_is_on_disk_while_the_second_runs_and_a_killed_one_is_removed() {
    let place = Workplace::new();
    let is_on_disk = || place.checkpoints().load_branch().is_ok();
    let mut trainer = place.start(searching(280), Mosaic::default());
    let mut steps = 0;
    while !trainer.is_finished() {
        trainer.advance(1, &mut |_| ()).unwrap();
        let runs_second = trainer.trial.as_ref().is_some_and(|trial| trial.change().is_some());
        assert_eq!(is_on_disk(), runs_second);
        steps += u32::from(runs_second);
    }
    assert!(steps >= 60, "{steps}");
    place.checkpoints().remove().unwrap();
    let mut killed = place.start(searching(280), Mosaic::default());
    killed.advance(45, &mut |_| ()).unwrap();
    // A process that is killed drops nothing.
    std::mem::forget(killed);
    assert!(is_on_disk());
    drop(place.resume(&searching(280), Mosaic::default()));
    assert!(!is_on_disk());
}

#[test]
fn a_search_without_a_folder_finds_the_same() {
    let place = Workplace::new();
    let mut with = place.start(searching(280), Mosaic::default());
    finish(&mut with);
    let options = TrainerOptions { checkpoints: None, ..place.options() };
    let mut without =
        Trainer::start(&place.dataset, searching(280), Mosaic::default(), options).unwrap();
    finish(&mut without);
    assert_eq!(with.scene().unwrap(), without.scene().unwrap());
    // The good state and the branch are in memory then.
    assert_eq!(without.memory().copies, 3 * with.memory().copies);
}

#[test]
fn validation_views_are_trained_on_only_when_nothing_is_to_be_added_any_more() {
    let place = Workplace::new();
    let mut trainer = place.start(searching(560), Mosaic::default());
    // Of 15 training views with every eighth from the fifth: 4 and 12.
    let validation = [4, 12];
    let search = |trainer: &Trainer<Mosaic>| trainer.progress().search.clone().unwrap();
    while search(&trainer).all_views_from.is_none() {
        assert!(!trainer.backend().shown.iter().any(|id| validation.contains(id)));
        trainer.backend().shown.clear();
        trainer.advance(1, &mut |_| ()).unwrap();
    }
    let grown = search(&trainer).splats;
    finish(&mut trainer);
    let shown = &trainer.backend().shown;
    assert!(validation.iter().all(|id| shown.contains(id)));
    let search = search(&trainer);
    assert!(search.all_views_from < search.ended_at && search.splats <= grown);
    let from = search.all_views_from.unwrap();
    let thins = |trial: &Trial| matches!(trial.proposal, Proposal::Splats(n) if n < trial.splats);
    let mut later = search.trials.iter().filter(|trial| trial.step >= from).peekable();
    assert!(later.peek().is_some() && later.all(thins), "{search:?}");
}

#[test]
fn the_photographs_bound_what_is_tried_and_the_estimate_of_the_memory() {
    let place = Workplace::new();
    let mut config = search_for_training(&place.dataset, 560, 1 << 34, ShDegree::Three);
    // 15 training views of 16 × 12 pixels with 3 values each, less an eighth.
    assert_eq!(config.search.unwrap().most_numbers, Some(5_040));
    let estimate =
        |config: &TrainingConfig| place.start(config.clone(), Mosaic::default()).memory();
    config.initial.random_count = 40;
    let state = 12 * 5_040;
    assert_eq!(estimate(&config).parameters, state + state / 3);
    // More than they are worth from the beginning on: these stay, and get no bands.
    config.initial.random_count = 1_000;
    let state = 12 * 14 * 1_000;
    assert_eq!(estimate(&config).parameters, state + state / 3);
}

#[test]
fn too_few_views_cannot_be_searched() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = capture(folder.path(), 4);
    let result =
        Trainer::start(&dataset, searching(100), Mosaic::default(), TrainerOptions::default());
    let message = result.err().unwrap().to_string();
    assert!(message.contains("expected at least 4 for a search, found 3"), "{message}");
}
