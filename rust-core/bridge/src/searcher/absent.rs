//! Text search in a core for iOS that was built where there was no ONNX Runtime to link with: it opens
//! no model, and says so as the app expects it. The other functions have no value that they could be
//! called with.

use crate::failure::{Code, Failure};
use crate::ffi::HitFigures;
use crate::image::Image;
use crate::renderer::Renderer;
use crate::scene::Scene;
use crate::work::Work;

/// No model can be opened.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SearchModel {}

/// No searcher can be made.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Searcher {}

/// Nothing is found.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Hits {}

/// Always refused.
pub(crate) fn open_search_model(_: String, _: &Work) -> Result<SearchModel, Failure> {
    let message = "text search: expected a core with ONNX Runtime (TRAPEZE_ONNXRUNTIME of \
                   scripts/build-xcframework), found one without";
    Err(Failure::new(Code::ModelsMissing, message))
}

/// Not reached without a model.
pub(crate) fn make_searcher(model: &SearchModel, _: &Scene) -> Result<Searcher, Failure> {
    match *model {}
}

impl SearchModel {
    pub(crate) fn name(&self) -> String {
        match *self {}
    }

    pub(crate) fn threshold(&self) -> f64 {
        match *self {}
    }
}

impl Searcher {
    pub(crate) fn encode(&self, _: &Renderer, _: String, _: &Work) -> Result<(), Failure> {
        match *self {}
    }

    pub(crate) fn encoded_clusters(&self) -> Vec<u32> {
        match *self {}
    }

    pub(crate) fn search(&self, _: String) -> Result<Hits, Failure> {
        match *self {}
    }

    pub(crate) fn take_picture(&self, _: u32) -> Result<Image, Failure> {
        match *self {}
    }
}

impl Hits {
    pub(crate) fn count(&self) -> usize {
        match *self {}
    }

    pub(crate) fn hit(&self, _: usize) -> HitFigures {
        match *self {}
    }
}
