//! Why a run cannot start or go on.

use thiserror::Error;
use trapeze_formats::{ReadError, WriteError};

use crate::backend::BackendError;
use crate::config::ConfigError;

/// Why a run cannot start or go on. The newest checkpoint is valid whatever happened.
#[derive(Debug, Error)]
pub enum TrainError {
    /// A setting outside its range.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The dataset cannot be trained on.
    #[error("dataset: {field}: expected {expected}, found {found}")]
    Dataset {
        /// What part of it.
        field: &'static str,
        /// What training needs.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A photograph or a checkpoint that cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A checkpoint that cannot be written; a full disk is the usual reason.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The run would need more memory than it may have.
    #[error("memory: {needed} MB are needed ({detail}), {limit} MB are available")]
    Memory {
        /// Megabytes (2²⁰ bytes), rounded up.
        needed: u64,
        /// What they are for.
        detail: String,
        /// Megabytes that may be used.
        limit: u64,
    },
    /// A checkpoint of another run.
    #[error("resume: {field}: expected {expected} as in the checkpoint, found {found}")]
    OtherRun {
        /// What differs.
        field: &'static str,
        /// The checkpoint's.
        expected: String,
        /// The run's.
        found: String,
    },
    /// The run diverged, and lower rates did not help.
    #[error(
        "step {step}: {fault}, {times} times in spite of lower rates; the last good state, of step \
         {good_step}, is kept"
    )]
    Diverged {
        /// Steps taken when it was noticed for the last time.
        step: u32,
        /// What was noticed.
        fault: String,
        /// How often.
        times: u32,
        /// The step of the state that was kept.
        good_step: u32,
    },
    /// The backend failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
}

impl TrainError {
    pub(super) fn dataset(
        field: &'static str,
        expected: impl Into<String>,
        found: impl std::fmt::Display,
    ) -> Self {
        Self::Dataset { field, expected: expected.into(), found: found.to_string() }
    }
}
