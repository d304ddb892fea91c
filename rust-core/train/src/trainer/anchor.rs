//! The state that a run can return to.

use std::path::PathBuf;

use super::TrainError;
use crate::checkpoint::{Checkpoint, CheckpointFolder};

/// The last state that was known to be good: on disk where there is a folder for it (a second copy
/// in memory would be the largest thing of the run), else in memory.
pub(super) enum Anchor {
    /// The newest checkpoint of the folder, of this step.
    Folder(CheckpointFolder, u32),
    /// The checkpoint itself.
    Memory(Box<Checkpoint>),
}

impl Anchor {
    /// Saves the first good state of a run.
    pub(super) fn first(
        folder: Option<CheckpointFolder>,
        checkpoint: &Checkpoint,
    ) -> Result<Self, TrainError> {
        let Some(folder) = folder else { return Ok(Self::Memory(Box::new(checkpoint.clone()))) };
        folder.save(checkpoint)?;
        Ok(Self::Folder(folder, checkpoint.state.step))
    }

    /// Replaces the good state by a newer one.
    pub(super) fn set(&mut self, checkpoint: &Checkpoint) -> Result<Option<PathBuf>, TrainError> {
        match self {
            Self::Folder(folder, step) => {
                let path = folder.save(checkpoint)?;
                *step = checkpoint.state.step;
                Ok(Some(path))
            }
            Self::Memory(kept) => {
                **kept = checkpoint.clone();
                Ok(None)
            }
        }
    }

    /// The good state.
    pub(super) fn get(&self) -> Result<Checkpoint, TrainError> {
        match self {
            Self::Folder(folder, step) => Ok(folder.load(*step)?),
            Self::Memory(kept) => Ok((**kept).clone()),
        }
    }

    /// Steps of the good state.
    pub(super) fn step(&self) -> u32 {
        match self {
            Self::Folder(_, step) => *step,
            Self::Memory(kept) => kept.state.step,
        }
    }
}
