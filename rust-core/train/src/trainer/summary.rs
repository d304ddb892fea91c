//! What is kept of a run beside its scene.

use serde::{Deserialize, Serialize};
use trapeze_scene::Scene;

use super::{Search, Trainer, TrainingMemory};
use crate::MotionSummary;
use crate::backend::TrainingBackend;
use crate::config::TrainingConfig;
use crate::evaluation::Evaluation;
use crate::rest::RestRecord;

/// A run in figures: what it was given, what it decided, what came out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrainingSummary {
    /// Steps of the run.
    pub steps: u32,
    /// Seconds of work, of all processes of the run.
    pub seconds: f64,
    /// Steps by seconds: trials whose steps were not kept lower it.
    pub steps_per_second: f64,
    /// Number of splats; of a finished run, those of its scene.
    pub splats: u32,
    /// Splats that were trained and left out of the scene, since no pixel can show them.
    #[serde(default)]
    pub left_out: u32,
    /// SH degree that was trained.
    pub sh_degree: u32,
    /// How often the run went back to a good state because of a fault.
    pub rollbacks: u32,
    /// What all learning rates were multiplied by at the end.
    pub rate_factor: f64,
    /// The dataset, in numbers.
    pub dataset: String,
    /// The estimate that was checked before the start.
    pub memory: TrainingMemory,
    /// The settings.
    pub config: TrainingConfig,
    /// The choice of the budget, and its evidence.
    pub search: Option<Search>,
    /// What of a scene that moves may rest; `None` in a static one.
    #[serde(default)]
    pub motion: Option<MotionSummary>,
    /// How much training made of splats that rest; `None` in a static scene.
    #[serde(default)]
    pub rest: Option<RestRecord>,
    /// Figures of the held-out views, if there are any.
    pub test: Option<Evaluation>,
}

impl<B: TrainingBackend> Trainer<B> {
    /// The run so far in figures, without those of the scene that came out.
    #[must_use]
    pub fn summary(&self) -> TrainingSummary {
        let seconds = self.progress.seconds;
        TrainingSummary {
            steps: self.step,
            seconds,
            steps_per_second: f64::from(self.step) / seconds.max(f64::MIN_POSITIVE),
            splats: self.backend.splat_count(),
            left_out: 0,
            sh_degree: self.sh_degree() as u32,
            rollbacks: self.progress.rollbacks,
            rate_factor: self.progress.rate_factor,
            dataset: self.progress.dataset.clone(),
            memory: self.memory,
            config: self.config.clone(),
            search: self.progress.search.clone(),
            motion: None,
            rest: self.config.deformation.map(|_| self.progress.rest),
            test: None,
        }
    }
}

impl TrainingSummary {
    /// Counts the splats of the scene that came out.
    pub fn count(&mut self, scene: &Scene) {
        let splats = scene.len() as u32;
        self.left_out = self.splats.saturating_sub(splats);
        self.splats = splats;
    }
}
