//! Features of earlier encodings.

use std::io::{Error, Write};
use std::path::{Path, PathBuf};

use trapeze_formats::write_atomically;
use trapeze_query::Searcher;
use trapeze_query::features::{FeatureStore, features_path};

use crate::scene::Scene;

/// Where the features of a scene are found. Whatever cannot be read or written costs time, never the
/// search.
pub(super) struct KeptFeatures {
    /// Where the command line keeps them. Only read: the scene may lie where nothing can be written.
    beside: Option<PathBuf>,
    /// [`Scene::key`].
    scene: u32,
    /// [`Embedder::image_key`](trapeze_query::models::Embedder::image_key).
    model: u32,
}

impl KeptFeatures {
    pub(super) fn of(scene: &Scene, model: u32) -> Self {
        Self { beside: scene.location().map(features_path), scene: scene.key(), model }
    }

    /// Takes over what is kept of clusters that are as they were.
    pub(super) fn restore(&self, searcher: &mut Searcher, cache: Option<&Path>) {
        let in_cache = cache.map(|folder| self.file(folder));
        for file in self.beside.iter().chain(&in_cache) {
            match FeatureStore::read(file) {
                Ok(Some(store)) => {
                    searcher.restore(store);
                }
                Ok(None) => {}
                Err(error) => tracing::warn!("{error}; the clusters are encoded again"),
            }
        }
    }

    /// Keeps what is known in the folder `cache`, which is made where it is missing.
    pub(super) fn save(&self, searcher: &Searcher, cache: &Path) {
        let bytes = searcher.store().to_bytes();
        let write = || {
            std::fs::create_dir_all(cache)?;
            write_atomically(&self.file(cache), |file| file.write_all(&bytes)).map_err(Error::other)
        };
        if let Err(error) = write() {
            tracing::warn!("{}: {error}; features are not kept", cache.display());
        }
    }

    /// One file per scene and model: the folder is that of all scenes. After an edit it is that of
    /// the scene before, most of whose clusters are the same.
    fn file(&self, cache: &Path) -> PathBuf {
        cache.join(format!("{:08x}-{:08x}.features.bin", self.scene, self.model))
    }
}
