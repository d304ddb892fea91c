//! Why a command failed.

use std::path::PathBuf;

use thiserror::Error;
use trapeze_formats::{ReadError, WriteError};
use trapeze_query::SearchError;
use trapeze_query::cluster::ClusterError;
use trapeze_scene::SceneError;
use trapeze_scene::edit::EditError;
use trapeze_train::TrainError;

/// Everything that ends a command. Each message is one line that names what was wrong.
#[derive(Debug, Error)]
pub(crate) enum CliError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Gpu(#[from] trapeze_gpu::GpuError),
    #[error(transparent)]
    Edit(#[from] EditError),
    #[error(transparent)]
    Train(#[from] TrainError),
    #[error(transparent)]
    Search(#[from] SearchError),
    #[error(transparent)]
    Cluster(#[from] ClusterError),
    #[error("{argument}: expected {expected}, found {found}")]
    Argument { argument: &'static str, expected: String, found: String },
    #[error("{}: {source}", path.display())]
    File { path: PathBuf, source: std::io::Error },
    #[error("{}: image could not be encoded: {reason}", path.display())]
    Encode { path: PathBuf, reason: String },
    #[error("standard output: {0}")]
    Output(std::io::Error),
    #[error(
        "GPU {gpu}: expected images of the reference, found others; no kernel can be relied on"
    )]
    NoWorkingKernel { gpu: String },
    #[error("cancelled")]
    Cancelled,
    #[error("interrupted after {step} of {steps} steps; the same command with --resume goes on")]
    Interrupted { step: u32, steps: u32 },
}

impl CliError {
    pub(crate) fn argument(
        argument: &'static str,
        expected: impl Into<String>,
        found: impl std::fmt::Display,
    ) -> Self {
        Self::Argument { argument, expected: expected.into(), found: found.to_string() }
    }

    pub(crate) fn file(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::File { path: path.into(), source }
    }
}
