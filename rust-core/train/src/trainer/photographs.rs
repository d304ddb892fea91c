//! Photographs on their way from the disk to the backend.

use std::sync::Arc;

use trapeze_formats::dataset::{Dataset, Image, ImageCache};

use super::TrainError;
use crate::backend::{BackendError, TrainingBackend};
use crate::loss::{Channels, TargetError, TargetImage};

/// Views that are decoded ahead of the one that is needed.
const AHEAD: usize = 4;

/// Loads photographs when a backend needs them. The backend keeps them; here only what was decoded
/// ahead waits.
pub(super) struct Photographs {
    cache: ImageCache,
    /// Index in the dataset, by training view.
    dataset_indices: Vec<usize>,
}

impl Photographs {
    /// Keeps at most `budget` bytes that no backend has yet.
    pub(super) fn new(dataset: &Dataset, dataset_indices: &[usize], budget: usize) -> Self {
        Self { cache: ImageCache::new(dataset, budget), dataset_indices: dataset_indices.to_vec() }
    }

    /// The photograph of a training view.
    pub(super) fn target(&self, id: u32) -> Result<Arc<TargetImage>, TrainError> {
        let image = self.cache.get(self.dataset_indices[id as usize])?;
        target_image(&image).map(Arc::new).map_err(|error| {
            TrainError::Backend(BackendError::View { id, reason: error.to_string() })
        })
    }

    /// Makes the photograph of view `id` resident, and decodes those that come after it.
    pub(super) fn admit(
        &self,
        backend: &mut impl TrainingBackend,
        id: u32,
        upcoming: impl Iterator<Item = u32>,
    ) -> Result<(), TrainError> {
        if backend.has_target(id) {
            return Ok(());
        }
        let target = self.target(id)?;
        let missing = upcoming.filter(|&next| next != id && !backend.has_target(next));
        let order: Vec<usize> =
            missing.take(AHEAD).map(|next| self.dataset_indices[next as usize]).collect();
        self.cache.prefetch(&order);
        Ok(backend.admit_target(id, target)?)
    }
}

/// A dataset's image as something to be matched.
///
/// # Errors
/// [`TargetError`] for an image without pixels or with other bytes than its size asks for.
pub(crate) fn target_image(image: &Image) -> Result<TargetImage, TargetError> {
    let channels = if image.has_alpha() { Channels::Rgba } else { Channels::Rgb };
    let target = TargetImage::new(image.width, image.height, channels, image.values.clone())?;
    match &image.weights {
        Some(weights) => target.with_mask(weights.clone()),
        None => Ok(target),
    }
}
