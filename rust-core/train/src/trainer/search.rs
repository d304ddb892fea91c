//! The search for what a scene needs: how many splats, which SH degree.
//!
//! # How it decides
//!
//! Some of the *training* views are set aside to validate (held-out views are never read). From a
//! state of the run two branches go on over the same steps and the same views: one as it is, one
//! with more splats, with fewer, or with one more SH band. The difference of their PSNR on the
//! validation views is what the change brought; nothing else differs, so the gain of merely training
//! longer cancels. A change is kept when it brought at least `least_gain` dB per doubling of the
//! scene's numbers, or cost less than that per halving.
//!
//! First the set grows, in a stride twice as long where growth brought far more than it had to, until
//! it was refused twice in a row, or four times where the scene moves. There a branch takes its stride
//! over the first half of its trial, by a little in every densification step, as a run without a search
//! grows. Then come bands; growth leaves time for one, or two where the scene moves.
//!
//! Growth duplicates what is opaque, not what will be good for something: in the last trial that leaves as
//! much time again, those splats leave that the image would miss least
//! ([`RemovalCosts`](crate::densify::RemovalCosts)), as many as the same price says, unless hardly any
//! are to go. Not before: until growth has to stop, splats that are good for nothing are moved to where
//! more are needed, and no trial is long enough to see what that is worth (docs/negative-results.md).
//!
//! When neither splats nor bands are to be added any more, the validation views are trained on, too. They
//! go on to judge the thinning: a set that only gets smaller does not learn them by heart.
//!
//! Nothing is tried that takes more numbers than [`BudgetSearch::most_numbers`], for splats and bands
//! alike: photographs say only so much, and what is tried is what the memory has to hold.
//!
//! The branch that is kept is the run: no step of it is lost. Decisions depend on steps, never on
//! the clock, and every one is kept with its evidence.

use serde::{Deserialize, Serialize};
use trapeze_scene::ShDegree;

use super::proposal::{Proposal, Trial};
use crate::config::{BudgetSearch, TrainingConfig};
use crate::densify::grown_count;
use crate::numbers_of_splat;

/// Refusals in a row after which the set grows no more: of a large stride, and of the smallest.
const REFUSALS_OF_GROWTH: usize = 2;
/// The same in a scene that moves. There two branches that differ in nothing of consequence still end
/// 0.2 dB apart, since each is a network that went its own way: a refusal says little, and thinning
/// takes back what growth was wrong about.
const REFUSALS_IN_MOTION: usize = 4;
/// Growth that brought this many times what it had to is tried in a stride twice as long.
const GENEROUS: f64 = 2.0;
/// Trials that growth leaves time for before it has to stop: a band, and as long again for what grew last
/// to be good for something.
const TRIALS_AFTER_GROWTH: u32 = 3;
/// The same in a scene that moves, which has time for two bands.
const TRIALS_AFTER_GROWTH_IN_MOTION: u32 = 4;

/// Where a search goes next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction {
    /// To a trial of this.
    Change(Proposal),
    /// To fewer splats; how many depends on what they are worth.
    FewerSplats,
    /// Nowhere yet: nothing is to be added any more, and it is too early to thin the set.
    Wait,
}

/// The choices so far. Part of the checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Search {
    /// Number of splats.
    pub splats: u32,
    /// SH degree.
    pub sh_degree: u32,
    /// Whether no splats are left that are not worth keeping.
    #[serde(default)]
    pub is_thin: bool,
    /// Every trial, in order.
    pub trials: Vec<Trial>,
    /// The step from which on all training views are trained on, those that validate too.
    #[serde(default)]
    pub all_views_from: Option<u32>,
    /// The step at which the search ended.
    pub ended_at: Option<u32>,
}

impl Search {
    /// Before the first trial.
    #[must_use]
    pub fn new(splats: u32) -> Self {
        Self {
            splats,
            sh_degree: 0,
            is_thin: false,
            trials: Vec::new(),
            all_views_from: None,
            ended_at: None,
        }
    }

    /// What the next trial changes, after `step` steps; `None` when nothing is left to try or no time
    /// is left to try it in.
    #[must_use]
    pub fn next(&self, config: &TrainingConfig, step: u32) -> Option<Direction> {
        let is_to_be_thinned =
            config.search?.thinning && !self.is_thin && config.has_time_to_thin(step);
        if is_to_be_thinned && !config.has_time_to_thin(step.saturating_add(config.trial_steps())) {
            return Some(Direction::FewerSplats);
        }
        let change = self.more_splats(config, step).or_else(|| self.more_bands(config, step));
        change.map(Direction::Change).or(is_to_be_thinned.then_some(Direction::Wait))
    }

    fn more_splats(&self, config: &TrainingConfig, step: u32) -> Option<Proposal> {
        let (settings, densification) = (config.search?, config.densification?);
        let most = settings.most_splats().min(densification.max_splats);
        let grown = self.grown(&settings, most);
        let (most_refusals, trials_after_growth) = match config.deformation {
            Some(_) => (REFUSALS_IN_MOTION, TRIALS_AFTER_GROWTH_IN_MOTION),
            None => (REFUSALS_OF_GROWTH, TRIALS_AFTER_GROWTH),
        };
        let has_time = config.has_time_for_trials(step, 1 + trials_after_growth);
        let is_due = has_time && grown > self.splats && !self.has_grown(most_refusals);
        is_due.then_some(Proposal::Splats(grown))
    }

    fn more_bands(&self, config: &TrainingConfig, step: u32) -> Option<Proposal> {
        let most_numbers = config.search?.most_numbers;
        let degree = self.sh_degree + 1;
        let is_due = self.sets_views_aside()
            && config.has_time_for_trials(step, 1)
            && degree <= config.sh_degree
            && most_numbers.is_none_or(|most| numbers(self.splats, degree) <= most)
            && !self.trials.iter().any(|trial| trial.is_band() && !trial.kept);
        is_due.then_some(Proposal::ShDegree(degree))
    }

    /// Whether the views that validate are not trained on: as long as splats or bands may be added.
    #[must_use]
    pub fn sets_views_aside(&self) -> bool {
        self.all_views_from.is_none() && self.ended_at.is_none()
    }

    /// Whether growth is over: refused in its long stride and in its short one, or already followed
    /// by something else.
    fn has_grown(&self, most_refusals: usize) -> bool {
        let refused = self.trials.iter().rev().take_while(|trial| !trial.kept);
        self.is_thin
            || self.trials.iter().any(|trial| !trial.is_growth())
            || refused.count() >= most_refusals
    }

    /// The number of splats that growth tries next: twice what the settings say, after that brought far
    /// more than it had to.
    fn grown(&self, settings: &BudgetSearch, most: u32) -> u32 {
        let grown = |splats| grown_count(splats, settings.growth, most);
        let is_generous = |trial: &Trial| trial.gain() >= GENEROUS * trial.required_gain;
        let once = grown(self.splats);
        if self.trials.last().is_some_and(is_generous) { grown(once) } else { once }
    }

    /// What a proposal has to bring, dB: `least_gain` per doubling of the scene's numbers. Negative
    /// where they become fewer: what it may cost.
    #[must_use]
    pub fn required_gain(&self, proposal: Proposal, settings: &BudgetSearch) -> f64 {
        let (splats, degree) = match proposal {
            Proposal::Splats(splats) => (splats, self.sh_degree),
            Proposal::ShDegree(degree) => (self.splats, degree),
        };
        let [changed, present] = [(splats, degree), (self.splats, self.sh_degree)]
            .map(|(splats, degree)| numbers(splats, degree) as f64);
        settings.least_gain * (changed / present).log2()
    }

    /// Adopts the proposal of a trial, or not, and keeps the evidence.
    pub fn record(&mut self, trial: Trial) {
        if trial.kept {
            match trial.proposal {
                Proposal::Splats(splats) => self.splats = splats,
                Proposal::ShDegree(degree) => self.sh_degree = degree,
            }
        }
        self.is_thin |= trial.is_thinning() && !trial.kept;
        self.trials.push(trial);
    }
}

/// Numbers that describe a scene.
fn numbers(splats: u32, sh_degree: u32) -> u64 {
    let degree = ShDegree::try_from(sh_degree).unwrap_or(ShDegree::Three);
    u64::from(splats) * numbers_of_splat(degree)
}

impl BudgetSearch {
    /// The most splats that are tried: none of them has an SH band.
    pub(super) fn most_splats(&self) -> u32 {
        let most = self.most_numbers.map(|most| most / numbers_of_splat(ShDegree::Zero));
        most.map_or(u32::MAX, |most| most.min(u32::MAX.into()) as u32)
    }
}

impl TrainingConfig {
    /// Steps of each branch of a trial.
    #[must_use]
    pub fn trial_steps(&self) -> u32 {
        let share = self.search.map_or(1.0, |search| search.trial);
        ((f64::from(self.steps) * share).round() as u32).max(1)
    }

    /// Whether `count` trials one after the other, from `step` on, end before growth has to stop.
    fn has_time_for_trials(&self, step: u32, count: u32) -> bool {
        let stop = self.densification.map_or(0, |densification| densification.stop);
        step.saturating_add(count.saturating_mul(self.trial_steps())) <= stop.min(self.steps)
    }

    /// Whether a trial from `step` on leaves as much time again until the end of the run, in which
    /// those that stay make up for those that left.
    fn has_time_to_thin(&self, step: u32) -> bool {
        self.densification.is_some()
            && step.saturating_add(self.trial_steps().saturating_mul(2)) <= self.steps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::DeformationTraining;

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
            psnr_with: if kept { 21.0 } else { 20.0 },
            required_gain: 0.1,
            kept,
        }
    }

    /// Runs the search from the first densification step on, with a rule that says what pays; what is
    /// worth keeping is half the splats, until that is fewer than 6 000.
    fn run(pays: impl Fn(&Search, Proposal) -> bool) -> Search {
        run_with(&config(), pays)
    }

    fn run_with(config: &TrainingConfig, pays: impl Fn(&Search, Proposal) -> bool) -> Search {
        let mut search = Search::new(10_000);
        let undisturbed = config.deformation.map_or(1, |motion| motion.undisturbed);
        let mut step = undisturbed.next_multiple_of(config.trial_steps());
        while let Some(direction) = search.next(config, step) {
            if !matches!(direction, Direction::Change(_)) {
                search.all_views_from.get_or_insert(step);
            }
            let proposal = match direction {
                Direction::Change(proposal) => Some(proposal),
                Direction::FewerSplats if search.splats / 2 >= 6_000 => {
                    Some(Proposal::Splats(search.splats / 2))
                }
                Direction::FewerSplats => {
                    search.is_thin = true;
                    continue;
                }
                Direction::Wait => None,
            };
            if let Some(proposal) = proposal {
                let kept = pays(&search, proposal);
                search.record(Trial { step, ..trial(&search, proposal, kept) });
            }
            step += config.trial_steps();
        }
        search
    }

    #[test]
    fn what_never_pays_changes_nothing() {
        let search = run(|_, _| false);
        assert_eq!((search.splats, search.sh_degree, search.trials.len()), (10_000, 0, 3));
        assert!(search.is_thin);
    }

    #[test]
    fn where_the_scene_moves_growth_is_tried_four_times_and_leaves_time_for_two_bands() {
        let motion = DeformationTraining { undisturbed: 210, ..DeformationTraining::default() };
        let config = TrainingConfig { deformation: Some(motion), ..config() };
        let tried = |pays: bool| -> Vec<(u32, bool, bool)> {
            let search = run_with(&config, |_, _| pays);
            let what = |trial: &Trial| (trial.step, trial.is_growth(), trial.is_band());
            search.trials.iter().map(what).collect()
        };
        let growths = [300, 400, 500, 600].map(|step| (step, true, false));
        // 40 000 splats are the most.
        let bands = [600, 700, 800].map(|step| (step, false, true));
        let thinning = [(1_200, false, false)];
        assert_eq!(tried(true), [&growths[..3], &bands, &thinning].concat());
        assert_eq!(tried(false), [&growths[..], &bands[1..2]].concat());
    }

    #[test]
    fn what_always_pays_grows_to_the_ceiling_gets_all_bands_and_is_thinned() {
        let search = run(|_, _| true);
        assert_eq!((search.splats, search.sh_degree), (20_000, 3));
        let tried: Vec<Proposal> = search.trials.iter().map(|trial| trial.proposal).collect();
        // Every trial brings far more than it has to: the second stride is the square of the first.
        let grown = [14_000, 27_440, 40_000].map(Proposal::Splats);
        let bands = [1, 2, 3].map(Proposal::ShDegree);
        let thinned = [Proposal::Splats(20_000)];
        assert_eq!(tried, [&grown[..], &bands, &thinned].concat());
    }

    #[test]
    fn thinning_waits_for_the_last_trial_that_leaves_as_much_time_again() {
        // Growth ends at once, or has ended with 40 000 splats.
        for grows in [true, false] {
            let search = run(|search, proposal| match proposal {
                Proposal::Splats(splats) => grows && splats > search.splats,
                Proposal::ShDegree(_) => false,
            });
            let thinnings = search.trials.iter().filter(|trial| trial.is_thinning());
            let steps: Vec<u32> = thinnings.map(|trial| trial.step).collect();
            assert_eq!(steps, if grows { &[1_200][..] } else { &[] }, "10 000 are thin");
            assert_eq!(search.all_views_from, Some(if grows { 500 } else { 400 }));
        }
    }

    #[test]
    fn a_refused_stride_is_followed_by_a_shorter_one() {
        let search = run(|search, proposal| match proposal {
            Proposal::Splats(splats) => splats > search.splats && splats < 20_000,
            Proposal::ShDegree(_) => false,
        });
        let tried: Vec<Proposal> = search.trials.iter().map(|trial| trial.proposal).collect();
        let [first, second, third, fourth, fifth] =
            [14_000, 27_440, 19_600, 38_416, 27_440].map(Proposal::Splats);
        let thinned = Proposal::Splats(9_800);
        assert_eq!(tried, [first, second, third, fourth, fifth, Proposal::ShDegree(1), thinned]);
        assert_eq!((search.splats, search.is_thin), (19_600, true));
    }

    #[test]
    fn nothing_is_tried_that_takes_more_numbers_than_allowed() {
        // As many as 30 000 splats have without bands.
        let allowed = BudgetSearch { most_numbers: Some(420_000), ..BudgetSearch::default() };
        let config = TrainingConfig { search: Some(allowed), ..config() };
        let search = run_with(&config, |_, _| true);
        let tried: Vec<Proposal> = search.trials.iter().map(|trial| trial.proposal).collect();
        // There is no room for bands before the set is thin, and then all views are trained on.
        assert_eq!(tried, [14_000, 27_440, 30_000, 15_000].map(Proposal::Splats));
        // 10 000 splats of degree 2 have 380 000 numbers, of degree 3 590 000.
        let search = run_with(&config, |_, proposal| matches!(proposal, Proposal::ShDegree(_)));
        assert_eq!((search.splats, search.sh_degree), (10_000, 2));
        let none = BudgetSearch { most_numbers: Some(0), ..BudgetSearch::default() };
        let config = TrainingConfig { search: Some(none), ..config };
        assert_eq!(Search::new(10_000).next(&config, 500), Some(Direction::Wait));
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
        assert_eq!(search.next(&TrainingConfig::growing(1000, 10_000), 100), None);
        let fixed =
            TrainingConfig { search: Some(BudgetSearch::default()), ..TrainingConfig::fixed(9) };
        assert_eq!(search.next(&fixed, 100), None);
    }

    #[test]
    fn what_is_added_is_added_before_growth_has_to_stop_and_then_the_set_is_thinned() {
        let config = config();
        assert_eq!(config.trial_steps(), 100);
        // The set may grow in the first five sixths, 1167 of 1400 steps.
        let search = Search::new(10_000);
        let next = |step| search.next(&config, step);
        let band = Some(Direction::Change(Proposal::ShDegree(1)));
        assert!(matches!(next(767), Some(Direction::Change(Proposal::Splats(_)))));
        assert_eq!((next(768), next(1067)), (band, band));
        assert_eq!((next(1068), next(1100)), (Some(Direction::Wait), Some(Direction::Wait)));
        let thin = Some(Direction::FewerSplats);
        assert_eq!((next(1101), next(1200), next(1201)), (thin, thin, None));
    }

    #[test]
    fn where_trials_are_long_the_last_one_thins() {
        // It begins at step 700, where there were also time for another band.
        let search = BudgetSearch { trial: 0.25, ..BudgetSearch::default() };
        let config = TrainingConfig { search: Some(search), ..config() };
        let next = |step| Search::new(10_000).next(&config, step);
        let band = Some(Direction::Change(Proposal::ShDegree(1)));
        assert_eq!((next(350), next(700)), (band, Some(Direction::FewerSplats)));
    }
}
