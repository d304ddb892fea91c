//! The loop.

use std::time::Instant;

use trapeze_scene::ShDegree;

use super::health::Fault;
use super::proposal::Proposal;
use super::{Event, Report, TrainError, Trainer};
use crate::backend::{BackendError, REPORT_LAG, TrainingBackend};
use crate::config::Background;
use crate::evaluation::psnr_of;
use crate::schedule::{DensifyPlan, StepPlan};

/// Faults after which a run is given up. Its rates are then 1.3e-5 of what they were.
pub const MOST_ROLLBACKS: u32 = 7;
/// What a fault leaves of the learning rates.
const RATE_FACTOR: f64 = 0.2;
/// Times that a device may be lost between two good states.
const MOST_LOSSES: u32 = 3;

impl<B: TrainingBackend> Trainer<B> {
    /// Takes up to `steps` steps; returns how many were taken. Fewer only at the end of the run.
    ///
    /// Steps that are undone count: a call takes a bounded time whatever happens.
    ///
    /// # Errors
    /// [`TrainError`]; the last good state is kept, and a later [`resume`](Self::resume) goes on
    /// from there.
    pub fn advance(
        &mut self,
        steps: u32,
        observer: &mut dyn FnMut(Event),
    ) -> Result<u32, TrainError> {
        self.figures.restart_clocks();
        let mut taken = 0;
        while taken < steps && !self.is_finished() {
            match self.take_step(observer) {
                Err(TrainError::Backend(BackendError::DeviceLost(reason))) => {
                    self.recover_device(reason, observer)?;
                }
                result => result?,
            }
            taken += 1;
        }
        self.count_seconds();
        Ok(taken)
    }

    /// One step, and what is due before and after it.
    fn take_step(&mut self, observer: &mut dyn FnMut(Event)) -> Result<(), TrainError> {
        if self.trial.is_none() {
            self.begin_trial(observer)?;
        }
        let change = self.densify_plan();
        if let Some(change) = &change {
            self.backend.densify(change)?;
        }
        self.look_for_rest(change.is_some())?;
        let plan = self.step_plan();
        if plan.network.is_some() {
            self.progress.rest.count(self.backend.splat_count());
        }
        let id = self.views.at_step(self.step);
        self.make_resident(id)?;
        self.backend.step(&plan, self.views.view(id))?;
        self.step += 1;
        self.figures.taken += 1;
        if let Some(due) = self.step.checked_sub(REPORT_LAG + 1)
            && let Err(fault) = self.take_reports(due)?
        {
            return self.roll_back(fault, observer);
        }
        self.after_step(id, observer)
    }

    fn after_step(&mut self, id: u32, observer: &mut dyn FnMut(Event)) -> Result<(), TrainError> {
        let is_last = self.step == self.config.steps;
        if is_last || self.step.is_multiple_of(self.options.report_interval.max(1)) {
            if !self.settle(observer)? {
                return Ok(());
            }
            self.report(id, observer)?;
        }
        self.continue_trial(observer)?;
        let is_due = is_last || self.step.is_multiple_of(self.config.checkpoint_interval);
        if !is_due || self.trial.is_some() || self.step == self.anchor.step() {
            return Ok(());
        }
        // Doubt is judged on every report, so that a pause, which waits for them, changes nothing.
        if self.settle(observer)? && (is_last || !self.progress.health.is_doubtful()) {
            self.make_good(observer)?;
        }
        Ok(())
    }

    /// Makes the photograph of a view resident, and has the next ones decoded.
    fn make_resident(&mut self, id: u32) -> Result<(), TrainError> {
        if self.backend.has_target(id) {
            return Ok(());
        }
        let window = self.step + 1..self.config.steps.min(self.step.saturating_add(16));
        let upcoming: Vec<u32> = window.map(|step| self.views.at_step(step)).collect();
        self.photographs.admit(&mut self.backend, id, upcoming.into_iter())
    }

    fn step_plan(&self) -> StepPlan {
        let mut plan =
            self.config.step_plan(self.step, self.progress.extent, self.progress.rate_factor);
        plan.sh_degree = self.sh_degree();
        plan
    }

    /// The SH degree of the next step.
    pub(super) fn sh_degree(&self) -> ShDegree {
        match (&self.progress.search, self.change()) {
            (None, _) => self.config.sh_degree_at(self.step),
            (Some(_), Some(Proposal::ShDegree(degree))) => degree_or_highest(degree),
            (Some(search), _) => degree_or_highest(search.sh_degree),
        }
    }

    /// The change of the set before the next step. In a search the set grows only where a trial
    /// says so; the dead move as ever.
    fn densify_plan(&self) -> Option<DensifyPlan> {
        let count = self.backend.splat_count();
        let plan = self.config.densify_plan(self.step, count);
        if self.progress.search.is_none() {
            return plan;
        }
        match self.trial.as_ref().and_then(|trial| trial.count_at(self.step)) {
            Some(count) => Some(DensifyPlan {
                seed: self.config.seed,
                dead_opacity: self.config.densification?.dead_opacity,
                count,
            }),
            None => plan.map(|plan| DensifyPlan { count, ..plan }),
        }
    }

    fn change(&self) -> Option<Proposal> {
        self.trial.as_ref().and_then(super::trial::RunningTrial::change)
    }

    /// Looks at the reports up to and including those of `step`.
    fn take_reports(&mut self, step: u32) -> Result<Result<(), Fault>, TrainError> {
        let epoch = self.views.epoch();
        for report in self.backend.reports(step)? {
            let is_comparable = matches!(self.config.background, Background::Fixed(_));
            let view = is_comparable.then(|| self.views.at_step(report.step));
            if let Err(fault) = self.progress.health.take(&report, view, epoch) {
                return Ok(Err(fault));
            }
            self.figures.loss += report.loss.total;
            self.figures.steps += 1;
        }
        Ok(Ok(()))
    }

    /// Waits for every report. Rolls back and returns false when the run is not sound.
    pub(super) fn settle(&mut self, observer: &mut dyn FnMut(Event)) -> Result<bool, TrainError> {
        let Some(last) = self.step.checked_sub(1) else { return Ok(true) };
        match self.take_reports(last)? {
            Ok(()) => Ok(true),
            Err(fault) => self.roll_back(fault, observer).map(|()| false),
        }
    }

    /// Makes the present state the one that the run returns to. Rolls back and returns false when
    /// the run is not sound.
    pub(super) fn make_good(
        &mut self,
        observer: &mut dyn FnMut(Event),
    ) -> Result<bool, TrainError> {
        if !self.settle(observer)? {
            return Ok(false);
        }
        let checkpoint = self.take_checkpoint()?;
        let saved = self.anchor.set(&checkpoint);
        self.backend.put_back(checkpoint.state);
        if let Some(path) = saved? {
            observer(Event::Saved { step: self.step, path });
        }
        self.losses = 0;
        Ok(true)
    }

    /// Goes back to the good state with lower rates.
    fn roll_back(
        &mut self,
        fault: Fault,
        observer: &mut dyn FnMut(Event),
    ) -> Result<(), TrainError> {
        let mut good = self.anchor.get()?;
        good.progress.rollbacks += 1;
        good.progress.rate_factor *= RATE_FACTOR;
        let (step, to) = (self.step, good.state.step);
        if good.progress.rollbacks > MOST_ROLLBACKS {
            let times = good.progress.rollbacks;
            let fault = fault.to_string();
            return Err(TrainError::Diverged { step, fault, times, good_step: to });
        }
        let rate_factor = good.progress.rate_factor;
        self.anchor.set(&good)?;
        self.return_to(good)?;
        observer(Event::RolledBack { step, to, rate_factor, reason: fault.to_string() });
        Ok(())
    }

    /// Loads the good state into a device that was lost.
    fn recover_device(
        &mut self,
        reason: String,
        observer: &mut dyn FnMut(Event),
    ) -> Result<(), TrainError> {
        self.losses += 1;
        if self.losses > MOST_LOSSES {
            return Err(BackendError::DeviceLost(reason).into());
        }
        let good = self.anchor.get()?;
        let (step, to) = (self.step, good.state.step);
        let rate_factor = good.progress.rate_factor;
        self.return_to(good)?;
        let reason = BackendError::DeviceLost(reason).to_string();
        observer(Event::RolledBack { step, to, rate_factor, reason });
        Ok(())
    }

    fn return_to(&mut self, good: crate::checkpoint::Checkpoint) -> Result<(), TrainError> {
        self.trial = None;
        (self.figures.loss, self.figures.steps) = (0.0, 0);
        self.enter(good)
    }

    /// Tells the figures since the last report. The reports up to here have been waited for.
    fn report(&mut self, id: u32, observer: &mut dyn FnMut(Event)) -> Result<(), TrainError> {
        let view = self.views.view(id).clone();
        let frame = self.render(&view.camera, view.time)?;
        let target = self.photographs.target(id)?;
        let background = self.config.background_at(self.step - 1);
        self.figures.psnr = psnr_of(&frame.color, &target, background);
        self.count_seconds();
        self.figures.measure_speed();
        let report = Report {
            step: self.step,
            steps: self.config.steps,
            seconds: self.progress.seconds,
            steps_per_second: self.figures.steps_per_second,
            loss: self.figures.loss / f64::from(self.figures.steps),
            psnr: self.figures.psnr,
            splats: self.backend.splat_count(),
            sh_degree: self.sh_degree() as u32,
            is_trial: self.trial.is_some(),
        };
        (self.figures.loss, self.figures.steps) = (0.0, 0);
        observer(Event::Report(report));
        Ok(())
    }
}

/// Validated settings have no other degree.
fn degree_or_highest(degree: u32) -> ShDegree {
    ShDegree::try_from(degree).unwrap_or(ShDegree::Three)
}

impl super::Figures {
    /// Pauses are not counted.
    fn restart_clocks(&mut self) {
        let now = Instant::now();
        self.since += now - self.counted;
        self.counted = now;
    }

    fn measure_speed(&mut self) {
        let now = Instant::now();
        let seconds = (now - self.since).as_secs_f64();
        self.steps_per_second = f64::from(self.taken) / seconds.max(1e-9);
        self.since = now;
        self.taken = 0;
    }
}
