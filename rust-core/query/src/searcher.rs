//! A scene and a model put together: encode its clusters once, then ask.

use std::ops::ControlFlow;
use std::sync::Arc;

use image::RgbImage;
use trapeze_scene::{Bounds, Clusters, Scene};

use crate::SearchError;
use crate::cluster::is_unassigned;
use crate::crops::{
    Crop, CropKind, CropOptions, CropRenderer, Member, choose, crops_from, extent, moves,
};
use crate::features::{ClusterState, FeatureStore, LeftOut, Record, cluster_keys};
use crate::models::{Embedder, normalised};
use crate::ranking::{
    Answer, Excluded, Match, MergeLimits, MergeSuggestion, PhraseAnswer, QueryOptions,
    phrase_feature, score, suggest_merges,
};

/// Clusters with fewer splats are specks.
const LEAST_SPLATS: usize = 8;

/// Text search in one scene with one model.
///
/// ```text
/// let mut searcher = Searcher::new(scene, Box::new(OnnxModel::open(folder)?), options)?;
/// if let Some(store) = FeatureStore::read(&features_path(path))? { searcher.restore(store); }
/// searcher.encode(&mut renderer, |done, all| ControlFlow::Continue(()))?;
/// let answer = searcher.query(&["red ball"], &QueryOptions::default())?;
/// ```
pub struct Searcher {
    scene: Arc<Scene>,
    embedder: Box<dyn Embedder>,
    options: CropOptions,
    /// Features of the background texts.
    background: Vec<Vec<f32>>,
    /// Per label.
    keys: Vec<u32>,
    /// Per label; `None` has to be encoded.
    states: Vec<Option<ClusterState>>,
    /// Per label: its splats.
    members: Vec<Vec<u32>>,
}

/// What came of [`Searcher::encode`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Encoded {
    /// Clusters that were looked at.
    pub clusters: usize,
    /// Crops that went through the image tower.
    pub crops: usize,
}

/// A cluster on its way through [`Searcher::encode`].
struct Pending {
    label: u32,
    /// Seen at every time, or at the first alone.
    moving: bool,
    sum: Vec<f32>,
    quality: f32,
}

impl Searcher {
    /// A search in the scene's clusters.
    ///
    /// # Errors
    /// [`SearchError::NoClusters`], or [`SearchError::Model`] when the background texts cannot be
    /// embedded.
    pub fn new(
        scene: Arc<Scene>,
        mut embedder: Box<dyn Embedder>,
        options: CropOptions,
    ) -> Result<Self, SearchError> {
        let clusters = clusters_of(&scene)?;
        let texts = embedder.description().search.background.clone();
        let background = embedder.embed_texts(&texts)?;
        let keys = cluster_keys(&scene, clusters);
        let mut members = vec![Vec::new(); clusters.table.len()];
        for (splat, &label) in (0..).zip(&clusters.labels) {
            members[label as usize].push(splat);
        }
        let states = vec![None; clusters.table.len()];
        Ok(Self { scene, embedder, options, background, keys, states, members })
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Takes over the features of clusters that are as they were, and returns how many. Features of
    /// another model or of other views are of no use.
    pub fn restore(&mut self, store: FeatureStore) -> usize {
        let Some(clusters) = &self.scene.clusters else { return 0 };
        if store.image_key != self.embedder.image_key()
            || store.crop_key != self.options.key()
            || store.dimension != self.embedder.description().dimension
        {
            return 0;
        }
        let mut kept = 0;
        for record in store.records {
            let Some(label) = clusters.label_of(record.id) else { continue };
            if self.keys[label as usize] == record.key {
                self.states[label as usize] = Some(record.state);
                kept += 1;
            }
        }
        kept
    }

    /// Drops all features, so that [`Searcher::encode`] looks at every cluster again.
    pub fn forget(&mut self) {
        self.states.fill(None);
    }

    /// Clusters that have to be encoded.
    #[must_use]
    pub fn outdated(&self) -> usize {
        self.states.iter().filter(|state| state.is_none()).count()
    }

    /// The features, to be kept.
    #[must_use]
    pub fn store(&self) -> FeatureStore {
        let table = self.scene.clusters.as_ref().map_or(&[][..], |clusters| &clusters.table);
        let records = table.iter().zip(&self.keys).zip(&self.states);
        FeatureStore {
            release: self.embedder.description().release.clone(),
            dimension: self.embedder.description().dimension,
            image_key: self.embedder.image_key(),
            crop_key: self.options.key(),
            records: records
                .filter_map(|((cluster, &key), state)| {
                    Some(Record { id: cluster.id, key, state: state.clone()? })
                })
                .collect(),
        }
    }

    /// Looks at every cluster that has no feature yet. `progress` gets the views done and their
    /// number, and may break off; clusters that were finished by then keep their features.
    ///
    /// What is selected or hidden on a screen plays no part.
    ///
    /// # Errors
    /// [`SearchError::Cancelled`], or what the renderer or the model say.
    pub fn encode(
        &mut self,
        renderer: &mut dyn CropRenderer,
        mut progress: impl FnMut(usize, usize) -> ControlFlow<()>,
    ) -> Result<Encoded, SearchError> {
        self.leave_out_specks()?;
        let todo: Vec<u32> =
            (0..).zip(&self.states).filter(|(_, state)| state.is_none()).map(|(l, _)| l).collect();
        let mut encoded = Encoded { clusters: todo.len(), crops: 0 };
        if todo.is_empty() {
            return Ok(encoded);
        }
        let times = self.times();
        let positions: Vec<Vec<[f32; 3]>> =
            times.iter().map(|&time| renderer.positions(time)).collect();
        let mut pending: Vec<Pending> =
            todo.into_iter().map(|label| self.pending(label, &positions)).collect();
        let all = pending.iter().map(|p| if p.moving { times.len() } else { 1 }).sum();
        let mut done = 0;
        for (step, (&time, positions)) in times.iter().zip(&positions).enumerate() {
            for cluster in pending.iter_mut().filter(|cluster| step == 0 || cluster.moving) {
                let views = self.views_at(step, cluster.moving, times.len());
                let extent = extent(&self.scene, &self.members[cluster.label as usize], positions);
                if let Some(extent) = extent {
                    let crops = self.crops(renderer, cluster.label, &extent, time, views)?;
                    encoded.crops += crops.len();
                    self.add(cluster, &crops)?;
                }
                if step + 1 == times.len() || !cluster.moving {
                    self.states[cluster.label as usize] = Some(cluster.finish());
                }
                done += 1;
                if progress(done, all).is_break() {
                    return Err(SearchError::Cancelled);
                }
            }
        }
        Ok(encoded)
    }

    /// Checks phrases before the long work: that there are some, and that the model can read them.
    ///
    /// # Errors
    /// [`SearchError::EmptyText`], [`SearchError::Model`] for a text that is too long.
    pub fn check(&mut self, phrases: &[&str]) -> Result<(), SearchError> {
        expect_words(phrases)?;
        for phrase in phrases {
            phrase_feature(self.embedder.as_mut(), phrase)?;
        }
        Ok(())
    }

    /// Finds the clusters that each of the phrases means.
    ///
    /// # Errors
    /// [`SearchError::EmptyText`] for no phrase or one without words, [`SearchError::NotEncoded`]
    /// before [`Searcher::encode`], [`SearchError::Model`] for a text that is too long.
    pub fn query(
        &mut self,
        phrases: &[&str],
        options: &QueryOptions,
    ) -> Result<Answer, SearchError> {
        expect_words(phrases)?;
        if self.outdated() > 0 {
            return Err(SearchError::NotEncoded { missing: self.outdated() });
        }
        let threshold = options.threshold.unwrap_or(self.embedder.description().search.threshold);
        let phrases = phrases
            .iter()
            .map(|phrase| self.answer(phrase, options.top_k, threshold))
            .collect::<Result<_, _>>()?;
        Ok(Answer { phrases, left_out: self.left_out(), threshold })
    }

    /// Pairs of clusters that may be parts of one instance: alike by their features, and touching.
    #[must_use]
    pub fn suggest_merges(&self, limits: MergeLimits) -> Vec<MergeSuggestion> {
        let Some(clusters) = &self.scene.clusters else { return Vec::new() };
        let features: Vec<Option<&[f32]>> = self.states.iter().map(feature_of).collect();
        suggest_merges(&self.scene.splats.positions, &clusters.labels, &features, limits)
    }

    /// The clearest crop of a cluster, for a contact sheet; `None` when it is never seen.
    ///
    /// # Errors
    /// [`SearchError::Render`].
    pub fn picture(
        &self,
        renderer: &mut dyn CropRenderer,
        cluster: u32,
    ) -> Result<Option<RgbImage>, SearchError> {
        let Some(label) = clusters_of(&self.scene)?.label_of(cluster) else { return Ok(None) };
        let time = self.times()[0];
        let positions = renderer.positions(time);
        let Some(extent) = extent(&self.scene, &self.members[label as usize], &positions) else {
            return Ok(None);
        };
        let crops = self.crops(renderer, label, &extent, time, 1)?;
        let isolated = crops.into_iter().find(|crop| crop.kind == CropKind::Isolated);
        Ok(isolated.map(|crop| crop.image))
    }

    /// Times at which the scene is looked at: one where nothing moves.
    fn times(&self) -> Vec<f32> {
        let times = &self.options.times;
        match (&self.scene.deformation, times.first()) {
            (_, None) => vec![0.0],
            (None, Some(&first)) => vec![first],
            (Some(_), Some(_)) => times.clone(),
        }
    }

    /// Views of a cluster at the `step`th of `times` times; together they are the wanted number.
    fn views_at(&self, step: usize, moving: bool, times: usize) -> usize {
        if moving { (self.options.views + times - 1 - step) / times } else { self.options.views }
            .max(1)
    }

    fn leave_out_specks(&mut self) -> Result<(), SearchError> {
        let clusters = clusters_of(&self.scene)?;
        for (label, cluster) in clusters.table.iter().enumerate() {
            let state = if is_unassigned(cluster) {
                LeftOut::Unassigned
            } else if self.members[label].len() < LEAST_SPLATS {
                LeftOut::TooSmall
            } else {
                continue;
            };
            self.states[label] = Some(ClusterState::LeftOut(state));
        }
        Ok(())
    }

    fn pending(&self, label: u32, positions: &[Vec<[f32; 3]>]) -> Pending {
        let members = &self.members[label as usize];
        let moving = positions
            .first()
            .and_then(|first| extent(&self.scene, members, first))
            .is_some_and(|extent| moves(&extent, members, positions));
        let sum = vec![0.0; self.embedder.description().dimension];
        Pending { label, moving, sum, quality: 0.0 }
    }

    fn crops(
        &self,
        renderer: &mut dyn CropRenderer,
        label: u32,
        extent: &Bounds,
        time: f32,
        views: usize,
    ) -> Result<Vec<Crop>, SearchError> {
        let member = Member { clusters: clusters_of(&self.scene)?, label };
        let mut crops = Vec::new();
        for viewpoint in choose(renderer, member, extent, time, views, &self.options)? {
            crops.extend(crops_from(renderer, &self.scene, label, &viewpoint.camera, time)?);
        }
        Ok(crops)
    }

    /// Adds the features of crops, weighted.
    fn add(&mut self, cluster: &mut Pending, crops: &[Crop]) -> Result<(), SearchError> {
        let images: Vec<&RgbImage> = crops.iter().map(|crop| &crop.image).collect();
        for (crop, feature) in crops.iter().zip(self.embedder.embed_images(&images)?) {
            for (sum, value) in cluster.sum.iter_mut().zip(feature) {
                *sum += crop.weight * value;
            }
            cluster.quality += crop.weight;
        }
        Ok(())
    }

    fn answer(
        &mut self,
        phrase: &str,
        top_k: usize,
        threshold: f32,
    ) -> Result<PhraseAnswer, SearchError> {
        let feature = phrase_feature(self.embedder.as_mut(), phrase)?;
        let scale = self.embedder.description().logit_scale;
        let table = &clusters_of(&self.scene)?.table;
        let mut ranked: Vec<_> = table
            .iter()
            .zip(&self.states)
            .filter_map(|(cluster, state)| {
                Some((cluster, score(feature_of(state)?, &feature, &self.background, scale)))
            })
            .collect();
        ranked.sort_by(|(_, a), (_, b)| b.log_odds.total_cmp(&a.log_odds));
        let found = ranked.into_iter().map(|(cluster, score)| Match {
            cluster: cluster.id,
            name: cluster.name.clone(),
            score: score.share,
            cosine: score.cosine,
        });
        let mut found = found.peekable();
        let nearest = found.peek().filter(|best| best.score < threshold).cloned();
        let matches = found.take_while(|found| found.score >= threshold).take(top_k).collect();
        Ok(PhraseAnswer { text: phrase.to_owned(), matches, nearest })
    }

    fn left_out(&self) -> Vec<Excluded> {
        let table = self.scene.clusters.as_ref().map_or(&[][..], |clusters| &clusters.table);
        let states = table.iter().zip(&self.states);
        states
            .filter_map(|(cluster, state)| match state {
                Some(ClusterState::LeftOut(reason)) => Some(Excluded {
                    cluster: cluster.id,
                    name: cluster.name.clone(),
                    reason: reason.reason(),
                }),
                _ => None,
            })
            .collect()
    }
}

impl Pending {
    fn finish(&self) -> ClusterState {
        match normalised(&self.sum) {
            Some(feature) => ClusterState::Encoded { feature, quality: self.quality },
            None => ClusterState::LeftOut(LeftOut::NeverVisible),
        }
    }
}

fn clusters_of(scene: &Scene) -> Result<&Clusters, SearchError> {
    scene
        .clusters
        .as_ref()
        .filter(|clusters| !clusters.table.is_empty())
        .ok_or(SearchError::NoClusters)
}

/// Checks that there are phrases, and something in each of them: what can be said before a model is
/// opened.
///
/// # Errors
/// [`SearchError::EmptyText`].
pub fn expect_words(phrases: &[&str]) -> Result<(), SearchError> {
    if phrases.is_empty() || phrases.iter().any(|phrase| phrase.trim().is_empty()) {
        return Err(SearchError::EmptyText);
    }
    Ok(())
}

fn feature_of(state: &Option<ClusterState>) -> Option<&[f32]> {
    match state {
        Some(ClusterState::Encoded { feature, .. }) => Some(feature),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
