//! Trials of a search: two branches from one state.

use super::branch::Branch;
use super::growth::Growth;
use super::proposal::{Proposal, Trial};
use super::search::Direction;
use super::{Event, TrainError, Trainer};
use crate::backend::TrainingBackend;
use crate::config::Background;
use crate::densify::{RemovalCosts, random_signs, thin};
use crate::evaluation::psnr_of;

/// Backward passes that tell what splats are worth.
const PROBES: u32 = 32;
/// What 8-bit photographs cannot tell from equality, dB.
const HIGHEST_PSNR: f64 = 100.0;

/// A trial that is going on, from the good state.
pub(super) struct RunningTrial {
    pub(super) proposal: Proposal,
    /// The step at which both branches end.
    pub(super) end: u32,
    /// The splats that go on in the branch with the change, if not all.
    kept: Option<Vec<u32>>,
    /// How the branch with the change comes to its number of splats, where that is the change.
    growth: Option<Growth>,
    /// The end of the branch that stayed as it was; from then on the branch with the change runs.
    without: Option<Branch>,
}

impl RunningTrial {
    /// The change that the present branch makes.
    pub(super) fn change(&self) -> Option<Proposal> {
        self.without.as_ref().map(|_| self.proposal)
    }

    /// The number of splats of the present branch from `step` on, if the trial changes it there.
    pub(super) fn count_at(&self, step: u32) -> Option<u32> {
        self.without.as_ref()?;
        self.growth.as_ref()?.at(step)
    }
}

impl<B: TrainingBackend> Trainer<B> {
    /// Begins the trial that is due, or ends the search. Called where no trial is going on.
    pub(super) fn begin_trial(
        &mut self,
        observer: &mut dyn FnMut(Event),
    ) -> Result<(), TrainError> {
        // What steps look at may change here: reports that are on their way are of the views before.
        if !self.is_trial_due() || !self.settle(observer)? {
            return Ok(());
        }
        let proposed = match self.next_direction() {
            Some(Direction::Change(proposal)) => Some((proposal, None)),
            Some(Direction::FewerSplats) => match self.worth_keeping()? {
                Some(kept) => Some((Proposal::Splats(kept.len() as u32), Some(kept))),
                None => return self.leave_thinned(observer),
            },
            Some(Direction::Wait) => None,
            None => {
                self.end_search(observer);
                None
            }
        };
        // A pause is taken up by a run whose good state has made the same choices.
        if !self.make_good(observer)? {
            return Ok(());
        }
        let end = self.step + self.config.trial_steps();
        self.trial = proposed.map(|(proposal, kept)| {
            let growth = self.growth(proposal);
            RunningTrial { proposal, end, kept, growth, without: None }
        });
        Ok(())
    }

    fn is_trial_due(&self) -> bool {
        let is_searching =
            self.progress.search.as_ref().is_some_and(|search| search.ended_at.is_none());
        let undisturbed = self.config.deformation.map_or(0, |motion| motion.undisturbed);
        is_searching
            && self.step > 0
            && self.step.is_multiple_of(self.config.trial_steps())
            && self.step >= undisturbed
    }

    /// Where the search goes from here. When nothing is to be added any more, all views are trained on from
    /// here on.
    fn next_direction(&mut self) -> Option<Direction> {
        let search = self.progress.search.as_mut()?;
        let direction = search.next(&self.config, self.step);
        if !matches!(direction, Some(Direction::Change(_))) && search.sets_views_aside() {
            search.all_views_from = Some(self.step);
            self.views.set_validation_aside(false);
        }
        direction
    }

    /// How a trial that begins here comes to more splats, if it proposes that. One that thins has left
    /// some behind before its first step.
    fn growth(&self, proposal: Proposal) -> Option<Growth> {
        let Proposal::Splats(splats) = proposal else { return None };
        let present = self.backend.splat_count();
        (splats > present).then(|| Growth::new(&self.config, self.step, (present, splats)))
    }

    /// Goes on to what comes after thinning.
    fn leave_thinned(&mut self, observer: &mut dyn FnMut(Event)) -> Result<(), TrainError> {
        if let Some(search) = &mut self.progress.search {
            search.is_thin = true;
        }
        self.begin_trial(observer)
    }

    fn end_search(&mut self, observer: &mut dyn FnMut(Event)) {
        let step = self.step;
        if let Some(search) = &mut self.progress.search {
            search.ended_at = Some(step);
            let (splats, sh_degree) = (search.splats, search.sh_degree);
            observer(Event::SearchEnded { step, splats, sh_degree });
        }
    }

    /// Goes from one branch to the other, or decides, where the present branch is at its end.
    pub(super) fn continue_trial(
        &mut self,
        observer: &mut dyn FnMut(Event),
    ) -> Result<(), TrainError> {
        if self.trial.as_ref().is_none_or(|trial| self.step < trial.end) {
            return Ok(());
        }
        if !self.settle(observer)? {
            return Ok(());
        }
        let validation = self.views.validation().to_vec();
        let psnr = self.mean_psnr(&validation)?;
        let Some(mut trial) = self.trial.take() else { return Ok(()) };
        match trial.without.take() {
            None => {
                let end = self.take_checkpoint()?;
                let folder = self.options.checkpoints.as_ref();
                trial.without = Some(Branch::keep(folder, end, psnr)?);
                let mut start = self.anchor.get()?;
                if let Some(kept) = trial.kept.take() {
                    thin(&mut start.state, &kept);
                }
                self.trial = Some(trial);
                self.enter(start)
            }
            Some(without) => self.decide(&trial, without, psnr, observer),
        }
    }

    fn decide(
        &mut self,
        trial: &RunningTrial,
        without: Branch,
        psnr_with: f64,
        observer: &mut dyn FnMut(Event),
    ) -> Result<(), TrainError> {
        let (Some(search), Some(settings)) = (&self.progress.search, &self.config.search) else {
            return Ok(());
        };
        let required_gain = search.required_gain(trial.proposal, settings);
        let steps = self.config.trial_steps();
        let outcome = Trial {
            step: trial.end - steps,
            steps,
            splats: search.splats,
            sh_degree: search.sh_degree,
            proposal: trial.proposal,
            psnr_without: without.psnr,
            psnr_with,
            required_gain,
            kept: psnr_with - without.psnr >= required_gain,
        };
        if !outcome.kept {
            self.backend.release();
            self.enter(without.into_checkpoint()?)?;
        }
        if let Some(search) = &mut self.progress.search {
            search.record(outcome);
        }
        observer(Event::Trial(outcome));
        Ok(())
    }

    /// The splats that are worth their price, if not nearly all are.
    fn worth_keeping(&mut self) -> Result<Option<Vec<u32>>, TrainError> {
        let Some(settings) = self.config.search else { return Ok(None) };
        let state = self.backend.take_state()?;
        let logits = state.splats.opacity_logits.clone();
        self.backend.put_back(state);
        let mut costs = RemovalCosts::new(logits.len());
        let shown = self.views.shown().to_vec();
        for (probe, &id) in (0..PROBES).zip(shown.iter().cycle()) {
            let target = self.photographs.target(id)?;
            let background = self.config.background_at(self.step.wrapping_add(probe));
            let address = (self.config.seed, self.step, probe);
            let signs = random_signs(address, target.len(), background, target.mask());
            let view = self.views.view(id).clone();
            let by_logits = self.backend.opacity_gradient(&view, self.sh_degree(), &signs)?;
            costs.add(&signs, &logits, &by_logits);
        }
        let probed = &shown[..shown.len().min(PROBES as usize)];
        Ok(costs.worth_keeping(self.mean_psnr(probed)?, settings.least_gain))
    }

    /// Mean PSNR of some training views, dB.
    fn mean_psnr(&mut self, ids: &[u32]) -> Result<f64, TrainError> {
        let background = match self.config.background {
            Background::Fixed(color) => color,
            Background::Random => [1.0; 3],
        };
        let mut sum = 0.0;
        for &id in ids {
            let target = self.photographs.target(id)?;
            let view = self.views.view(id).clone();
            let frame = self.render(&view.camera, view.time)?;
            sum += psnr_of(&frame.color, &target, background);
        }
        // Finite, so that it survives JSON: equal images, and masks that leave nothing.
        Ok((sum / ids.len().max(1) as f64).max(0.0).min(HIGHEST_PSNR))
    }
}
