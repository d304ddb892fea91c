//! The trainer: one loop over any backend.
//!
//! # Use
//!
//! [`Trainer::start`] reads what a dataset and a configuration ask for, [`Trainer::advance`] takes
//! some steps and returns, so that whoever drives it decides between calls: go on, pause (do not
//! call), save ([`Trainer::save`]), stop, show the splats ([`Trainer::render`]).
//! [`Trainer::resume`] goes on from a folder of checkpoints. What happens in between is told to an
//! observer as [`Event`]s.
//!
//! # What a run is
//!
//! A run is a function of (dataset, configuration, backend): how many steps `advance` is given at a
//! time, pauses, kills and resumes change nothing of its result. It has one *good state* at any
//! time, the one that it returns to: the start, then every `checkpoint_interval` steps, and the
//! beginning of every trial of a search. A state becomes the good one only after every report up
//! to it was waited for and found sound.
//!
//! * A fault ([`Fault`]) takes the run back to the good state with a fifth of its learning rates; after
//!   [`MOST_ROLLBACKS`] of them it ends with an error, and the good state is kept. It does not
//!   matter when exactly the fault is noticed (reports come late, and a pause waits for them): the
//!   state that is returned to is the same.
//! * A lost device is loaded with the good state again, with unchanged rates.
//! * [`Trainer::save`] between two good states writes a checkpoint beside the good one and does not
//!   replace it. During a trial it writes nothing: a killed trial is repeated from its beginning, and
//!   what it had on disk of its first branch is removed.

mod anchor;
mod branch;
mod error;
mod event;
mod growth;
mod health;
mod initial;
mod lifecycle;
mod memory;
mod photographs;
mod proposal;
mod rest;
mod run;
pub mod search;
mod summary;
#[cfg(test)]
mod tests;
mod trial;
mod views;

use std::time::Instant;

use trapeze_scene::{Camera, Frame, FrameSettings, Scene};

use crate::TrainingState;
use crate::backend::{TrainingBackend, TrainingView};
use crate::checkpoint::{CheckpointFolder, Progress};
use crate::config::TrainingConfig;

use anchor::Anchor;
pub use error::TrainError;
pub use event::{Event, Report};
pub use health::{Fault, Health};
pub use memory::TrainingMemory;
use photographs::Photographs;
pub(crate) use photographs::target_image;
pub use proposal::{Proposal, Trial};
pub use run::MOST_ROLLBACKS;
pub use search::Search;
pub use summary::TrainingSummary;
use trial::RunningTrial;
use views::Views;

/// What a run may use, beyond what decides its result.
#[derive(Clone, Debug)]
pub struct TrainerOptions {
    /// Where checkpoints are kept; `None` keeps the good state in memory.
    pub checkpoints: Option<CheckpointFolder>,
    /// Bytes for photographs that were decoded ahead.
    pub photograph_budget: usize,
    /// Bytes that the run may take at its largest; `None` does not check.
    pub memory_limit: Option<u64>,
    /// Steps between two [`Event::Report`]s.
    pub report_interval: u32,
}

impl Default for TrainerOptions {
    fn default() -> Self {
        Self {
            checkpoints: None,
            photograph_budget: 32 << 20,
            memory_limit: None,
            report_interval: 100,
        }
    }
}

/// A run of training, between two steps.
pub struct Trainer<B> {
    backend: B,
    config: TrainingConfig,
    options: TrainerOptions,
    memory: TrainingMemory,
    views: Views,
    photographs: Photographs,
    /// Steps taken.
    step: u32,
    progress: Progress,
    anchor: Anchor,
    trial: Option<RunningTrial>,
    figures: Figures,
    /// Times that the device was lost since the good state.
    losses: u32,
}

/// What the next report is made of. Not part of a checkpoint: nothing depends on it.
struct Figures {
    loss: f64,
    steps: u32,
    since: Instant,
    /// Steps that were taken since then, kept or not.
    taken: u32,
    /// Since when seconds have not been added to the progress.
    counted: Instant,
    steps_per_second: f64,
    psnr: f64,
}

impl<B: TrainingBackend> Trainer<B> {
    /// Steps taken.
    #[must_use]
    pub fn step(&self) -> u32 {
        self.step
    }

    /// Whether every step was taken.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.step >= self.config.steps && self.trial.is_none()
    }

    /// The settings of the run.
    #[must_use]
    pub fn config(&self) -> &TrainingConfig {
        &self.config
    }

    /// What was decided so far.
    #[must_use]
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// The estimate that was checked before the start.
    #[must_use]
    pub fn memory(&self) -> TrainingMemory {
        self.memory
    }

    /// Number of splats now.
    #[must_use]
    pub fn splat_count(&self) -> u32 {
        self.backend.splat_count()
    }

    /// Number of training views.
    #[must_use]
    pub fn view_count(&self) -> usize {
        self.views.len()
    }

    /// A training view, with its camera relative to the origin of the splats.
    ///
    /// # Panics
    /// When there is no training view of this number.
    #[must_use]
    pub fn view(&self, id: u32) -> &TrainingView {
        self.views.view(id)
    }

    /// What it trains on; a live view of the splats is the backend's own affair.
    pub fn backend(&mut self) -> &mut B {
        &mut self.backend
    }

    /// Renders the splats as they are now, from a camera relative to their origin. Waits.
    ///
    /// # Errors
    /// [`TrainError::Backend`] when the camera cannot project or the device fails.
    pub fn render(&mut self, camera: &Camera, time: f32) -> Result<Frame, TrainError> {
        let settings = FrameSettings { time, ..FrameSettings::default() };
        Ok(self.backend.render(camera, &settings)?)
    }

    /// The scene as it is now. SH bands that are zero are left out, and so are splats that no pixel can
    /// show and a network that has not moved anything yet. Waits.
    ///
    /// # Errors
    /// [`TrainError::Backend`] when the device fails.
    pub fn scene(&mut self) -> Result<Scene, TrainError> {
        let TrainingState { mut splats, network, .. } = self.backend.state()?;
        let drawable = splats.drawable();
        // A scene of nothing would show the same, but helps nobody.
        if !drawable.is_empty() && drawable.len() < splats.len() {
            splats = splats.gather(&drawable);
        }
        let degree = splats.used_sh_degree();
        Ok(Scene {
            origin: self.progress.origin.into(),
            deformation: network.filter(|trained| !trained.is_at_rest()).map(|t| t.network),
            ..Scene::from_splats(splats.with_sh_degree(degree))
        })
    }
}
