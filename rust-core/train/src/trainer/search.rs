//! The search for what a scene needs: how many splats, which SH degree.
//!
//! # How it decides
//!
//! Some of the *training* views are set aside to validate (held-out views are never read). From a
//! state of the run two branches go on over the same steps and the same views: one as it is, one
//! with more splats or with one more SH band. The difference of their PSNR on the validation views
//! is what the change brought; nothing else differs, so the gain of merely training longer cancels.
//! A change is kept when it brought at least `least_gain` dB per doubling of the scene's numbers.
//! More splats and more bands are tried in turn; what failed twice in a row is settled, and when
//! both are, or when growth has to stop, the search ends and the validation views are trained on.
//!
//! The branch that is kept is the run: no step of it is lost. Decisions depend on steps, never on
//! the clock, and every one is kept with its evidence.

use serde::{Deserialize, Serialize};
use trapeze_scene::ShDegree;

use crate::config::{BudgetSearch, TrainingConfig};
use crate::densify::grown_count;

/// Failures in a row after which something is not tried again.
const FAILURES: usize = 2;

/// What a trial changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Proposal {
    /// To this many splats.
    Splats(u32),
    /// To this SH degree.
    ShDegree(u32),
}

/// A trial and its evidence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The step from which both branches went.
    pub step: u32,
    /// Steps of each branch.
    pub steps: u32,
    /// Splats at the start.
    pub splats: u32,
    /// SH degree at the start.
    pub sh_degree: u32,
    /// What was tried.
    pub proposal: Proposal,
    /// PSNR of the validation views, dB, of the branch that stayed as it was.
    pub psnr_without: f64,
    /// PSNR of the validation views, dB, of the branch with the change.
    pub psnr_with: f64,
    /// What the change had to bring, dB.
    pub required_gain: f64,
    /// Whether it was kept.
    pub kept: bool,
}

/// The choices so far. Part of the checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Search {
    /// Number of splats.
    pub splats: u32,
    /// SH degree.
    pub sh_degree: u32,
    /// Every trial, in order.
    pub trials: Vec<Trial>,
    /// The step at which the search ended.
    pub ended_at: Option<u32>,
}

impl Search {
    /// Before the first trial.
    #[must_use]
    pub fn new(splats: u32) -> Self {
        Self { splats, sh_degree: 0, trials: Vec::new(), ended_at: None }
    }

    /// What the next trial changes; `None` when nothing is left to try.
    #[must_use]
    pub fn next_proposal(&self, config: &TrainingConfig) -> Option<Proposal> {
        let (settings, densification) = (config.search?, config.densification?);
        let count = grown_count(self.splats, settings.growth, densification.max_splats);
        let more_splats =
            (count > self.splats && !self.is_settled(is_splats)).then_some(Proposal::Splats(count));
        let more_bands = (self.sh_degree < config.sh_degree && !self.is_settled(|p| !is_splats(p)))
            .then_some(Proposal::ShDegree(self.sh_degree + 1));
        let last_was_splats = self.trials.last().is_some_and(|trial| is_splats(&trial.proposal));
        if last_was_splats { more_bands.or(more_splats) } else { more_splats.or(more_bands) }
    }

    /// What a proposal has to bring, dB: `least_gain` per doubling of the scene's numbers.
    #[must_use]
    pub fn required_gain(&self, proposal: Proposal, settings: &BudgetSearch) -> f64 {
        let (splats, degree) = match proposal {
            Proposal::Splats(splats) => (splats, self.sh_degree),
            Proposal::ShDegree(degree) => (self.splats, degree),
        };
        let ratio = numbers(splats, degree) / numbers(self.splats, self.sh_degree);
        settings.least_gain * ratio.log2()
    }

    /// Adopts the proposal of a trial, or not, and keeps the evidence.
    pub fn record(&mut self, trial: Trial) {
        if trial.kept {
            match trial.proposal {
                Proposal::Splats(splats) => self.splats = splats,
                Proposal::ShDegree(degree) => self.sh_degree = degree,
            }
        }
        self.trials.push(trial);
    }

    fn is_settled(&self, kind: impl Fn(&Proposal) -> bool) -> bool {
        let mut of_kind = self.trials.iter().rev().filter(|trial| kind(&trial.proposal));
        let failures = of_kind.by_ref().take_while(|trial| !trial.kept).count();
        failures >= FAILURES
    }
}

fn is_splats(proposal: &Proposal) -> bool {
    matches!(proposal, Proposal::Splats(_))
}

/// Numbers that describe a scene.
fn numbers(splats: u32, sh_degree: u32) -> f64 {
    let degree = ShDegree::try_from(sh_degree).unwrap_or(ShDegree::Three);
    f64::from(splats) * (14 + 3 * degree.rest_coefficients()) as f64
}

impl TrainingConfig {
    /// Steps of each branch of a trial.
    #[must_use]
    pub fn trial_steps(&self) -> u32 {
        let share = self.search.map_or(1.0, |search| search.trial);
        ((f64::from(self.steps) * share).round() as u32).max(1)
    }

    /// Whether a trial that starts after `step` steps ends before growth has to stop.
    #[must_use]
    pub fn has_time_for_trial(&self, step: u32) -> bool {
        let stop = self.densification.map_or(0, |densification| densification.stop);
        step.saturating_add(self.trial_steps()) <= stop.min(self.steps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config() -> TrainingConfig {
        TrainingConfig::automatic(1400, 40_000)
    }

    fn trial(search: &Search, proposal: Proposal, kept: bool) -> Trial {
        Trial {
            step: 100,
            steps: 100,
            splats: search.splats,
            sh_degree: search.sh_degree,
            proposal,
            psnr_without: 20.0,
            psnr_with: 21.0,
            required_gain: 0.1,
            kept,
        }
    }

    /// Runs the search with a rule that says what pays.
    fn run(pays: impl Fn(Proposal) -> bool) -> Search {
        let mut search = Search::new(10_000);
        while let Some(proposal) = search.next_proposal(&config()) {
            search.record(trial(&search, proposal, pays(proposal)));
            assert!(search.trials.len() < 20);
        }
        search
    }

    #[test]
    fn what_never_pays_is_tried_twice_each_and_changes_nothing() {
        let search = run(|_| false);
        assert_eq!((search.splats, search.sh_degree, search.trials.len()), (10_000, 0, 4));
    }

    #[test]
    fn what_always_pays_reaches_the_ceilings() {
        let search = run(|_| true);
        assert_eq!((search.splats, search.sh_degree), (40_000, 3));
        assert!(search.next_proposal(&config()).is_none());
    }

    #[test]
    fn splats_and_bands_are_settled_one_by_one() {
        let search = run(|p| matches!(p, Proposal::ShDegree(degree) if degree <= 2));
        assert_eq!((search.splats, search.sh_degree), (10_000, 2));
        let search = run(|p| matches!(p, Proposal::Splats(splats) if splats < 20_000));
        assert_eq!((search.splats, search.sh_degree), (19_600, 0));
    }

    #[test]
    fn a_doubling_costs_the_stated_gain_whatever_doubles() {
        let search = Search::new(10_000);
        let settings = config().search.unwrap();
        let gain = |proposal| search.required_gain(proposal, &settings);
        assert!((gain(Proposal::Splats(20_000)) - settings.least_gain).abs() < 1e-12);
        // 14 numbers become 23.
        let expected = settings.least_gain * (23.0f64 / 14.0).log2();
        assert!((gain(Proposal::ShDegree(1)) - expected).abs() < 1e-12);
    }

    #[test]
    fn without_a_search_or_densification_nothing_is_proposed() {
        let search = Search::new(100);
        assert_eq!(search.next_proposal(&TrainingConfig::growing(1000, 10_000)), None);
        let fixed =
            TrainingConfig { search: Some(BudgetSearch::default()), ..TrainingConfig::fixed(9) };
        assert_eq!(search.next_proposal(&fixed), None);
    }

    #[test]
    fn the_last_trial_ends_before_growth_does() {
        let config = config();
        assert_eq!(config.trial_steps(), 100);
        // Growth stops after five sixths, 1167 of 1400 steps.
        assert!(config.has_time_for_trial(1067) && !config.has_time_for_trial(1068));
    }
}
