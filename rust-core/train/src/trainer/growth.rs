//! How the branch of a trial grows.
//!
//! Many copies at once set a run back: those of what moves have to part in time as well as in place,
//! and until they have, the photographs of other moments are worse off. So there a branch grows as a run
//! without a search does, by a little in every densification step, and stays as it is for the second
//! half of its trial, in which what has grown shows what it is good for. What rests grows at once
//! ([`BudgetSearch::gradual`](crate::config::BudgetSearch::gradual)).

use crate::config::TrainingConfig;

/// The growth of a branch, as a function of the settings, the trial and its proposal.
pub(super) struct Growth {
    /// Step and number of splats of every change, in order.
    changes: Vec<(u32, u32)>,
}

impl Growth {
    /// From `from` splats to `to`, in equal ratios, over the densification steps in the first half of
    /// the trial that begins at step `begin`; at once at its beginning, where the search is not gradual
    /// or these are fewer than two.
    pub(super) fn new(config: &TrainingConfig, begin: u32, (from, to): (u32, u32)) -> Self {
        let middle = begin.saturating_add(config.trial_steps().div_ceil(2));
        let is_due = |step: &u32| config.densification.is_some_and(|set| set.is_due(*step));
        let mut steps: Vec<u32> = (begin..middle).filter(is_due).collect();
        let is_gradual = config.search.is_some_and(|search| search.gradual);
        if !is_gradual || steps.len() < 2 {
            steps = vec![begin];
        }
        let changes = steps.len() as f64;
        let ratio = f64::from(to) / f64::from(from.max(1));
        let count = |change: u32| f64::from(from) * ratio.powf(f64::from(change) / changes);
        let mut changes: Vec<(u32, u32)> =
            (1..).zip(steps).map(|(change, step)| (step, count(change).floor() as u32)).collect();
        if let Some((_, last)) = changes.last_mut() {
            // A power of a root need not be the number again.
            *last = to;
        }
        Self { changes }
    }

    /// The number of splats from `step` on, if it changes there.
    pub(super) fn at(&self, step: u32) -> Option<u32> {
        self.changes.iter().find(|change| change.0 == step).map(|change| change.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::BudgetSearch;

    fn growth(steps: u32, begin: u32, to: u32) -> Vec<(u32, u32)> {
        let mut config = TrainingConfig::automatic(steps, 1_000_000);
        config.search = Some(BudgetSearch { gradual: true, ..BudgetSearch::default() });
        Growth::new(&config, begin, (10_000, to)).changes
    }

    #[test]
    fn a_branch_grows_in_equal_ratios_over_the_densification_steps_of_its_first_half() {
        // A trial has 1 429 steps of 20 000.
        let changes = growth(20_000, 4_287, 19_600);
        let steps: Vec<u32> = changes.iter().map(|change| change.0).collect();
        assert_eq!(steps, [4_300, 4_400, 4_500, 4_600, 4_700, 4_800, 4_900, 5_000]);
        let mut before = 10_000.0;
        for &(_, count) in &changes {
            // Each number is rounded down by less than one splat of ten thousand.
            assert!((f64::from(count) / before / 1.96f64.powf(0.125) - 1.0).abs() < 1e-4);
            before = f64::from(count);
        }
        assert_eq!(growth(7_000, 500, 14_000), [(500, 11_186), (600, 12_514), (700, 14_000)]);
    }

    #[test]
    fn growth_starts_at_the_present_number_never_falls_and_is_over_by_half_of_the_trial() {
        for steps in [70, 1_400, 2_000, 7_000, 20_000, 30_000] {
            let trial = TrainingConfig::automatic(steps, 1).trial_steps();
            for begin in (1..12).map(|k| k * trial) {
                for to in [10_000, 10_001, 14_000, 19_600, 571_428] {
                    let changes = growth(steps, begin, to);
                    let counts = changes.iter().map(|change| change.1);
                    assert!(counts.clone().is_sorted() && counts.min() >= Some(10_000));
                    assert!(changes.iter().map(|change| change.0).is_sorted_by(|a, b| a < b));
                    assert!(changes[0].0 >= begin);
                    assert!(changes.last().is_some_and(|&(step, count)| {
                        count == to && 2 * (step - begin) < trial + 1
                    }));
                }
            }
        }
    }

    #[test]
    fn what_rests_grows_at_once() {
        let config = TrainingConfig::automatic(7_000, 1_000_000);
        assert_eq!(Growth::new(&config, 500, (10_000, 14_000)).changes, [(500, 14_000)]);
    }

    #[test]
    fn a_trial_too_short_for_two_changes_grows_at_once_at_its_beginning() {
        // Trials of 143 steps; the first begins before the set may change at all.
        for begin in [143, 572, 1_144] {
            assert_eq!(growth(2_000, begin, 14_000), [(begin, 14_000)]);
        }
    }
}
