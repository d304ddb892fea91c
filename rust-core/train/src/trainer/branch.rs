//! The end of the branch of a trial that stayed as it was.

use super::TrainError;
use crate::checkpoint::{Checkpoint, CheckpointFolder};

/// What the other branch is compared with, and goes on if that one is refused: its state is on disk
/// where there is a folder for it, like the good state, else in memory.
pub(super) struct Branch {
    /// PSNR of the validation views, dB.
    pub(super) psnr: f64,
    end: End,
}

enum End {
    File(BranchFile),
    Memory(Box<Checkpoint>),
}

impl Branch {
    /// Keeps the end of a branch.
    pub(super) fn keep(
        folder: Option<&CheckpointFolder>,
        checkpoint: Checkpoint,
        psnr: f64,
    ) -> Result<Self, TrainError> {
        let end = match folder {
            Some(folder) => {
                folder.save_branch(&checkpoint)?;
                End::File(BranchFile(folder.clone()))
            }
            None => End::Memory(Box::new(checkpoint)),
        };
        Ok(Self { psnr, end })
    }

    /// The state at the end.
    pub(super) fn into_checkpoint(self) -> Result<Checkpoint, TrainError> {
        match self.end {
            End::File(file) => Ok(file.0.load_branch()?),
            End::Memory(checkpoint) => Ok(*checkpoint),
        }
    }
}

/// The file of a branch; it is gone when nobody waits for it any more, however the trial ends.
struct BranchFile(CheckpointFolder);

impl Drop for BranchFile {
    fn drop(&mut self) {
        self.0.remove_branch();
    }
}
