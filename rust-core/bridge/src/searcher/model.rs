//! The models, shared by the searchers of several scenes.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard};

use image::RgbImage;
use trapeze_query::models::{Embedder, ModelDescription, ModelError, OnnxModel};

use crate::failure::{Contained, Failure, guarded};
use crate::ffi::Stage;
use crate::work::Work;

/// The image and text towers of one release.
#[derive(Clone)]
pub(crate) struct SearchModel {
    description: ModelDescription,
    image_key: u32,
    /// Held for one batch at a time: texts get in between while a scene is encoded.
    model: Arc<Mutex<Contained<OnnxModel>>>,
}

/// Opens a model folder.
pub(crate) fn open_search_model(path: String, work: &Work) -> Result<SearchModel, Failure> {
    guarded(|| {
        work.step(Stage::Reading, None)?;
        let model = OnnxModel::open(Path::new(&path))?;
        work.check()?;
        Ok(SearchModel {
            description: model.description().clone(),
            image_key: model.image_key(),
            model: Arc::new(Mutex::new(Contained::new(model))),
        })
    })
}

impl SearchModel {
    pub(crate) fn name(&self) -> String {
        self.description.name.clone()
    }

    /// The least score of a match, as whoever made the model has measured it, 0–1.
    pub(crate) fn threshold(&self) -> f64 {
        f64::from(self.description.search.threshold)
    }

    /// A call that panicked poisons the model. Whoever asks it next panics too, which the border
    /// turns into a failure.
    fn locked(&self) -> MutexGuard<'_, Contained<OnnxModel>> {
        self.model.lock().unwrap_or_else(|_| {
            panic!("model: expected one in order, found one whose last call ended with a fault")
        })
    }
}

impl Embedder for SearchModel {
    fn description(&self) -> &ModelDescription {
        &self.description
    }

    fn image_key(&self) -> u32 {
        self.image_key
    }

    fn embed_images(&mut self, images: &[&RgbImage]) -> Result<Vec<Vec<f32>>, ModelError> {
        self.locked().get_mut().embed_images(images)
    }

    fn embed_texts(&mut self, texts: &[String]) -> Result<Vec<Vec<f32>>, ModelError> {
        self.locked().get_mut().embed_texts(texts)
    }
}

impl std::fmt::Debug for SearchModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SearchModel").field("name", &self.description.name).finish_non_exhaustive()
    }
}
