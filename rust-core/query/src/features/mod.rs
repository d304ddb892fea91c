//! One feature per cluster, kept beside the scene.

mod file;
mod keys;

use std::path::{Path, PathBuf};

pub use file::{FeatureFileError, MAX_FEATURE_FILE_BYTES};
pub(crate) use keys::cluster_keys;

/// What is known of a cluster.
#[derive(Clone, Debug, PartialEq)]
pub enum ClusterState {
    /// Its feature, of unit length.
    Encoded {
        /// The weighted mean of its crops' features.
        feature: Vec<f32>,
        /// Sum of the crops' weights: how well it was seen.
        quality: f32,
    },
    /// It takes no part in a search.
    LeftOut(LeftOut),
}

/// Why a cluster takes no part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOut {
    /// So few splats that they are no object.
    TooSmall,
    /// No view shows it: others hide it, or it is transparent.
    NeverVisible,
    /// The splats that clustering could not assign.
    Unassigned,
}

impl LeftOut {
    /// The reason in words.
    #[must_use]
    pub fn reason(self) -> &'static str {
        match self {
            Self::TooSmall => "too small",
            Self::NeverVisible => "never visible",
            Self::Unassigned => "not assigned to an object",
        }
    }
}

/// A cluster's record.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The cluster's id.
    pub id: u32,
    /// Checksum of everything that it is made of.
    pub key: u32,
    /// What is known of it.
    pub state: ClusterState,
}

/// The features of a scene's clusters under one model.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureStore {
    /// The model's release, for people.
    pub release: String,
    /// Numbers in a feature.
    pub dimension: usize,
    /// [`Embedder::image_key`](crate::models::Embedder::image_key) of the model.
    pub image_key: u32,
    /// [`CropOptions::key`](crate::crops::CropOptions::key).
    pub crop_key: u32,
    /// By id, ascending.
    pub records: Vec<Record>,
}

impl FeatureStore {
    /// Checksum of all clusters: equal when nothing of the scene changed.
    #[must_use]
    pub fn scene_key(&self) -> u32 {
        let mut hasher = crc32fast::Hasher::new();
        for record in &self.records {
            hasher.update(&record.id.to_le_bytes());
            hasher.update(&record.key.to_le_bytes());
        }
        hasher.finalize()
    }
}

/// Where the features of a scene are kept: in its folder, or beside its file.
#[must_use]
pub fn features_path(scene: &Path) -> PathBuf {
    if scene.is_dir() {
        return scene.join("features.bin");
    }
    let mut name = scene.file_name().unwrap_or_default().to_owned();
    name.push(".features.bin");
    scene.with_file_name(name)
}
