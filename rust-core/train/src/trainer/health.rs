//! Whether a run is still a sound one.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::backend::StepReport;

/// An epoch whose mean loss is this many times the best epoch's has diverged: views differ less
/// than this from epoch to epoch, and neither growth nor another SH band raises the loss so far.
const WORST_RATIO: f64 = 3.0;
/// A view whose loss is this many times what it was before the first step has not been trained.
const NO_BETTER: f64 = 1.05;
/// Epochs in a row after which that is no chance.
const PATIENCE: u32 = 5;
/// Losses this small apart are never a divergence, whatever their ratio.
const LEAST_RISE: f64 = 0.05;

/// What is wrong with a run.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Fault {
    /// The loss is not finite.
    #[error("the loss of step {step} is not finite")]
    Loss {
        /// The step.
        step: u32,
    },
    /// Gradients or new values were not finite.
    #[error("{parameters} parameters of step {step} are not finite")]
    Parameters {
        /// The step.
        step: u32,
        /// How many.
        parameters: u32,
    },
    /// The loss exploded.
    #[error("the mean loss rose from {from:.4} to {to:.4}")]
    Rise {
        /// Mean over the best epoch.
        from: f64,
        /// Mean over the last epoch.
        to: f64,
    },
    /// A view looks worse than before the first step.
    #[error("the loss of a view rose from {from:.4} before the first step to {to:.4}")]
    WorseThanStart {
        /// Before the first step.
        from: f64,
        /// Now.
        to: f64,
    },
    /// No view shows any splat any more.
    #[error("no splat is visible any more")]
    Invisible,
}

/// Watches the reports of a run. Part of the checkpoint, so that a resumed run judges as the
/// uninterrupted one does.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Health {
    /// Steps of the epoch that is not complete yet.
    steps: u32,
    /// Of these, how many showed a splat.
    visible: u32,
    /// Sum of their losses.
    loss: f64,
    /// Lowest mean loss of an epoch.
    best: Option<f64>,
    /// Whether any step has shown a splat.
    was_visible: bool,
    /// The first view, and its loss before the first step: the one loss that no rate has touched.
    start: Option<(u32, f64)>,
    /// How often in a row that view has been worse.
    worse: u32,
}

impl Health {
    /// Takes the next report of a run that shows `views` views in an epoch. `view` is the one that
    /// was shown, where losses of one view can be compared: not over a random background.
    ///
    /// # Errors
    /// [`Fault`] when the run must not go on from here.
    pub fn take(
        &mut self,
        report: &StepReport,
        view: Option<u32>,
        views: u32,
    ) -> Result<(), Fault> {
        if !report.loss.total.is_finite() {
            return Err(Fault::Loss { step: report.step });
        }
        if report.not_finite > 0 {
            return Err(Fault::Parameters { step: report.step, parameters: report.not_finite });
        }
        if let Some(view) = view {
            self.compare_with_start(view, report.loss.total)?;
        }
        self.steps += 1;
        self.loss += report.loss.total;
        self.visible += u32::from(report.visible > 0);
        self.was_visible |= report.visible > 0;
        if self.steps < views.max(1) {
            return Ok(());
        }
        let mean = self.loss / f64::from(self.steps);
        let is_invisible = self.visible == 0 && self.was_visible;
        (self.steps, self.visible, self.loss) = (0, 0, 0.0);
        if is_invisible {
            return Err(Fault::Invisible);
        }
        match self.best {
            Some(best) if mean > WORST_RATIO * best && mean > best + LEAST_RISE => {
                Err(Fault::Rise { from: best, to: mean })
            }
            best => {
                self.best = Some(best.map_or(mean, |best| best.min(mean)));
                Ok(())
            }
        }
    }

    /// Whether the last report gave reason for doubt: such a state must not become the good one.
    #[must_use]
    pub fn is_doubtful(&self) -> bool {
        self.worse > 0
    }

    /// Rates that explode at once leave nothing to compare with but the loss before the first step,
    /// which is known of one view.
    fn compare_with_start(&mut self, view: u32, loss: f64) -> Result<(), Fault> {
        let (first, from) = *self.start.get_or_insert((view, loss));
        if view != first {
            return Ok(());
        }
        self.worse = if loss > NO_BETTER * from { self.worse + 1 } else { 0 };
        if self.worse >= PATIENCE {
            return Err(Fault::WorseThanStart { from, to: loss });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loss::LossValue;

    fn report(step: u32, total: f64, visible: u32) -> StepReport {
        let loss = LossValue { total, ..LossValue::default() };
        StepReport { step, loss, not_finite: 0, visible }
    }

    fn take_all(reports: impl Iterator<Item = StepReport>) -> Result<(), Fault> {
        let mut health = Health::default();
        reports.into_iter().try_for_each(|report| health.take(&report, Some(report.step % 10), 10))
    }

    #[test]
    fn a_falling_loss_with_differing_views_is_sound() {
        let loss = |step: u32| (0.1 + 0.2 * f64::from(step % 10)) * 0.999f64.powf(f64::from(step));
        take_all((0..1000).map(|step| report(step, loss(step), 5))).unwrap();
    }

    #[test]
    fn what_is_not_finite_is_a_fault_at_once() {
        for total in [f64::NAN, f64::INFINITY] {
            let reports = (0..5).map(|step| report(step, if step == 3 { total } else { 0.1 }, 1));
            assert_eq!(take_all(reports), Err(Fault::Loss { step: 3 }));
        }
        let mut health = Health::default();
        let poisoned = StepReport { not_finite: 7, ..report(2, 0.1, 1) };
        assert_eq!(
            health.take(&poisoned, None, 10),
            Err(Fault::Parameters { step: 2, parameters: 7 })
        );
    }

    #[test]
    fn an_epoch_far_above_the_best_one_is_a_fault_and_a_single_view_is_not() {
        // The first view's own loss stays what it was.
        let loss = |step: u32| if step < 35 || step.is_multiple_of(10) { 0.1 } else { 0.5 };
        let exploded = (0..60).map(|step| report(step, loss(step), 1));
        assert!(matches!(take_all(exploded), Err(Fault::Rise { .. })));
        take_all((0..60).map(|step| report(step, if step == 35 { 0.9 } else { 0.1 }, 1))).unwrap();
        // A loss near zero may well triple.
        take_all((0..60).map(|step| report(step, if step < 35 { 0.001 } else { 0.009 }, 1)))
            .unwrap();
    }

    #[test]
    fn a_run_that_is_worse_than_its_start_from_the_first_steps_on_is_a_fault() {
        let worse_until =
            |end: u32| move |step: u32| if (1..end).contains(&step) { 0.4 } else { 0.3 };
        let run =
            |loss: &dyn Fn(u32) -> f64| take_all((0..90).map(|step| report(step, loss(step), 1)));
        let expected = Fault::WorseThanStart { from: 0.3, to: 0.4 };
        assert_eq!(run(&worse_until(90)), Err(expected));
        // Some epochs may be chance, and a few percent are nothing.
        run(&worse_until(45)).unwrap();
        run(&|step| if step == 0 { 0.3 } else { 0.31 }).unwrap();
    }

    #[test]
    fn splats_that_are_all_gone_are_a_fault_and_splats_never_seen_are_not() {
        let gone = (0..60).map(|step| report(step, 0.1, u32::from(step < 25)));
        assert_eq!(take_all(gone), Err(Fault::Invisible));
        take_all((0..60).map(|step| report(step, 0.1, 0))).unwrap();
    }
}
