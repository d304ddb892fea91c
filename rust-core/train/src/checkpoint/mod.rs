//! Checkpoints: a run that was killed at any moment goes on as if nothing had happened.
//!
//! Everything that the next step depends on is in one file; random numbers need no state
//! ([`random`](crate::random)). A file is written beside its place, synced and renamed, so that it
//! is there whole or not at all, and its checksum is verified before anything of it is used. The
//! two newest are kept: if the newest cannot be read, the one before it can.

mod folder;
mod format;

use serde::{Deserialize, Serialize};

use crate::TrainingState;
use crate::config::TrainingConfig;
use crate::rest::RestRecord;
use crate::trainer::{Health, Search};

pub use folder::CheckpointFolder;
pub use format::{read_checkpoint, write_checkpoint};

/// What the trainer has decided so far, beyond the parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Progress {
    /// All learning rates are multiplied by this; below 1 after a roll-back.
    pub rate_factor: f64,
    /// How often the run has been rolled back.
    pub rollbacks: u32,
    /// Size of the scene in world units, as measured from the cameras at the start.
    pub extent: f64,
    /// World position of the coordinate zero of the splats.
    pub origin: [f64; 3],
    /// What the run was trained on, to be compared with the dataset that a resumed run is given.
    pub dataset: String,
    /// Seconds of work so far. Told to the user, never a ground for a decision.
    pub seconds: f64,
    /// What the reports said so far.
    pub health: Health,
    /// How much was made of splats that rest.
    pub rest: RestRecord,
    /// What the search for the budget has chosen so far, in a run that has one.
    pub search: Option<Search>,
}

impl Default for Progress {
    fn default() -> Self {
        Self {
            rate_factor: 1.0,
            rollbacks: 0,
            extent: 1.0,
            origin: [0.0; 3],
            dataset: String::new(),
            seconds: 0.0,
            health: Health::default(),
            rest: RestRecord::default(),
            search: None,
        }
    }
}

/// A run, stopped between two steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// The settings, the seed of all random numbers among them.
    pub config: TrainingConfig,
    /// What the trainer has decided so far.
    pub progress: Progress,
    /// Parameters, optimiser and step.
    pub state: TrainingState,
}
