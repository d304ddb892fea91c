//! Why a search cannot be made.

use std::error::Error;

use thiserror::Error as ThisError;

use crate::models::ModelError;

/// A scene, a text or a backend that cannot be searched with. Each message is one line.
#[derive(Debug, ThisError)]
pub enum SearchError {
    /// The scene has no clusters.
    #[error("scene: expected clusters (clusters.bin), found none; `trapeze cluster` makes them")]
    NoClusters,
    /// There is nothing to look for.
    #[error("text: expected a word or more, found none")]
    EmptyText,
    /// The model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The renderer.
    #[error("crops: {0}")]
    Render(#[source] Box<dyn Error + Send + Sync>),
    /// Whoever watched the progress broke it off.
    #[error("cancelled")]
    Cancelled,
    /// Clusters that have no features yet.
    #[error(
        "features: expected those of every cluster, found {missing} clusters without; encode first"
    )]
    NotEncoded {
        /// How many.
        missing: usize,
    },
}
