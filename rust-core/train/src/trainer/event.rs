//! What a run tells while it goes on.

use std::path::PathBuf;

use super::proposal::Trial;

/// Something that a user may want to see. None of it steers the run.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// Figures, at regular steps.
    Report(Report),
    /// A state that a killed run goes on from was saved.
    Saved {
        /// Steps taken.
        step: u32,
        /// The checkpoint.
        path: PathBuf,
    },
    /// The run went back to its last good state.
    RolledBack {
        /// Steps that had been taken.
        step: u32,
        /// Steps of the state that was returned to.
        to: u32,
        /// What all learning rates are multiplied by from there on.
        rate_factor: f64,
        /// What had happened, in words.
        reason: String,
    },
    /// The search for the budget tried something.
    Trial(Trial),
    /// The search for the budget has ended.
    SearchEnded {
        /// Steps taken.
        step: u32,
        /// Splats that were chosen.
        splats: u32,
        /// SH degree that was chosen.
        sh_degree: u32,
    },
}

/// The state of a run in figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Steps taken.
    pub step: u32,
    /// Steps of the whole run.
    pub steps: u32,
    /// Seconds of work so far: those of earlier processes of the run count, pauses do not.
    pub seconds: f64,
    /// Speed since the report before.
    pub steps_per_second: f64,
    /// Mean loss of the steps since the report before.
    pub loss: f64,
    /// PSNR of the view that was trained on last, dB, after the step.
    pub psnr: f64,
    /// Number of splats.
    pub splats: u32,
    /// SH degree that is trained.
    pub sh_degree: u32,
    /// Whether this is a trial of the search, whose steps may not be kept.
    pub is_trial: bool,
}

impl Report {
    /// Seconds until the last step at the present speed.
    #[must_use]
    pub fn seconds_left(&self) -> f64 {
        f64::from(self.steps - self.step) / self.steps_per_second
    }
}
