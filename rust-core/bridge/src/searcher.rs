//! Text search over the clusters of a scene.

mod crops;
mod kept_features;
mod model;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex};

use image::RgbImage;
use image::imageops::{self, FilterType};
use trapeze_query::crops::CropOptions;
use trapeze_query::features::ClusterState;
use trapeze_query::models::Embedder;
use trapeze_query::ranking::{Match, QueryOptions};
use trapeze_scene::Rgba8;

use crate::failure::{Contained, Failure, guarded, guarded_or, poisoned};
use crate::ffi::{HitFigures, Stage};
use crate::image::Image;
use crate::renderer::Renderer;
use crate::scene::Scene;
use crate::work::Work;
use crops::OffscreenCrops;
use kept_features::KeptFeatures;
pub(crate) use model::{SearchModel, open_search_model};

/// Longer side of a cluster's picture, pixels: three times what a list shows of it in points.
const PICTURE_SIDE: u32 = 144;

/// A scene and a model put together.
pub(crate) struct Searcher(Mutex<Contained<State>>);

struct State {
    searcher: trapeze_query::Searcher,
    kept: KeptFeatures,
    /// By id, until somebody takes them.
    pictures: BTreeMap<u32, RgbImage>,
}

/// What a text means, the best first.
#[derive(Debug)]
pub(crate) struct Hits(Vec<Match>);

/// A search in the clusters of a scene.
pub(crate) fn make_searcher(model: &SearchModel, scene: &Scene) -> Result<Searcher, Failure> {
    guarded(|| {
        let (splats, embedder) = (Arc::clone(scene.shared()), Box::new(model.clone()));
        let searcher = trapeze_query::Searcher::new(splats, embedder, CropOptions::default())?;
        let kept = KeptFeatures::of(scene, model.image_key());
        let state = State { searcher, kept, pictures: BTreeMap::new() };
        Ok(Searcher(Mutex::new(Contained::new(state))))
    })
}

impl Searcher {
    /// Looks at every cluster whose features are neither beside the scene nor in the folder `cache`,
    /// keeps them there, and makes a picture of each. Clusters that were finished when it is
    /// cancelled are kept, too.
    ///
    /// The crops are drawn on the renderer's device, from a copy of the scene of their own: neither
    /// what is on the screen nor how it is drawn plays a part.
    pub(crate) fn encode(
        &self,
        renderer: &Renderer,
        cache: String,
        work: &Work,
    ) -> Result<(), Failure> {
        self.with(|state| {
            work.step(Stage::Uploading, None)?;
            let cache = (!cache.is_empty()).then(|| Path::new(&cache));
            state.kept.restore(&mut state.searcher, cache);
            let mut crops = OffscreenCrops::new(renderer, state.searcher.scene(), work)?;
            work.step(Stage::Encoding, Some(0.0))?;
            let is_outdated = state.searcher.outdated() > 0;
            let encoded = state.searcher.encode(&mut crops, |done, all| {
                work.flow(Stage::Encoding, Some(done as f64 / all.max(1) as f64))
            });
            if let Some(cache) = cache.filter(|_| is_outdated) {
                state.kept.save(&state.searcher, cache);
            }
            encoded?;
            state.pictures = pictures(&state.searcher, &mut crops, work)?;
            Ok(())
        })
    }

    /// Ids of the clusters that could be seen well enough.
    pub(crate) fn encoded_clusters(&self) -> Vec<u32> {
        guarded_or(Vec::new(), || {
            self.with(|state| Ok(encoded_clusters(&state.searcher))).unwrap_or_default()
        })
    }

    /// The clearest picture of a cluster; it is handed over once after each encoding.
    pub(crate) fn take_picture(&self, cluster: u32) -> Result<Image, Failure> {
        self.with(|state| {
            let Some(picture) = state.pictures.remove(&cluster) else {
                return Err(Failure::argument("cluster", "one with a picture", cluster));
            };
            let (width, height) = picture.dimensions();
            let pixels = picture.pixels().flat_map(|p| [p[0], p[1], p[2], 255]).collect();
            Ok(Image::new(Rgba8 { width, height, pixels }))
        })
    }

    /// Every encoded cluster and how well the text fits it.
    pub(crate) fn search(&self, text: String) -> Result<Hits, Failure> {
        self.with(|state| {
            let options = QueryOptions { top_k: usize::MAX, threshold: Some(0.0) };
            let answer = state.searcher.query(&[&text], &options)?;
            Ok(Hits(answer.phrases.into_iter().flat_map(|phrase| phrase.matches).collect()))
        })
    }

    fn with<T>(&self, body: impl FnOnce(&mut State) -> Result<T, Failure>) -> Result<T, Failure> {
        guarded(|| body(self.0.lock().map_err(poisoned)?.get_mut()))
    }
}

fn encoded_clusters(searcher: &trapeze_query::Searcher) -> Vec<u32> {
    let records = searcher.store().records.into_iter();
    records
        .filter(|record| matches!(record.state, ClusterState::Encoded { .. }))
        .map(|record| record.id)
        .collect()
}

/// A small picture of each encoded cluster that can be seen.
fn pictures(
    searcher: &trapeze_query::Searcher,
    crops: &mut OffscreenCrops<'_>,
    work: &Work,
) -> Result<BTreeMap<u32, RgbImage>, Failure> {
    let clusters = encoded_clusters(searcher);
    let mut pictures = BTreeMap::new();
    for (done, &cluster) in clusters.iter().enumerate() {
        work.step(Stage::Rendering, Some(done as f64 / clusters.len() as f64))?;
        if let Some(picture) = searcher.picture(crops, cluster)? {
            let picture =
                imageops::resize(&picture, PICTURE_SIDE, PICTURE_SIDE, FilterType::Triangle);
            pictures.insert(cluster, picture);
        }
    }
    Ok(pictures)
}

impl Hits {
    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// All zero and NaN beyond the last.
    pub(crate) fn hit(&self, index: usize) -> HitFigures {
        let hit = self.0.get(index);
        HitFigures {
            cluster: hit.map_or(0, |hit| hit.cluster),
            score: hit.map_or(f64::NAN, |hit| f64::from(hit.score)),
        }
    }
}

impl std::fmt::Debug for Searcher {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Searcher").finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
