//! From a scene and phrases to a report.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde::Serialize;
use trapeze_formats::write_atomically;
use trapeze_query::crops::CropOptions;
use trapeze_query::features::{FeatureStore, features_path};
use trapeze_query::models::{Embedder, OnnxModel};
use trapeze_query::ranking::{Answer, Excluded, Match, MergeLimits, QueryOptions};
use trapeze_query::{SearchError, Searcher, expect_words};
use trapeze_scene::Scene;

use super::{CpuCropRenderer, contact_sheet};
use crate::error::CliError;
use crate::output::{progress_bar, write_png};

/// What to look for, where, and with what.
#[derive(Debug)]
pub(crate) struct SearchArguments<'a> {
    /// Where the scene was read from: its features are kept beside it.
    pub(crate) path: &'a Path,
    pub(crate) phrases: &'a [String],
    pub(crate) models: &'a Path,
    /// Where features are kept, if not beside the scene.
    pub(crate) features: Option<&'a Path>,
    pub(crate) crops: CropOptions,
    pub(crate) query: QueryOptions,
    /// Where the contact sheet goes.
    pub(crate) sheet: Option<&'a Path>,
}

/// A match, and the phrase that it is one of.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Found {
    pub(crate) text: String,
    pub(crate) cluster: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    pub(crate) score: f32,
    pub(crate) cosine: f32,
}

/// What was found and how long it took.
#[derive(Debug, Serialize)]
pub(crate) struct SearchReport {
    /// Phrases in their order, and of each the best first.
    pub(crate) results: Vec<Found>,
    /// The best cluster of phrases without a match.
    pub(crate) nearest: Vec<Found>,
    pub(crate) left_out: Vec<Excluded>,
    /// Clusters that may be parts of one instance.
    pub(crate) merge_suggestions: Vec<Merge>,
    pub(crate) threshold: f32,
    pub(crate) model: String,
    pub(crate) encoded_clusters: usize,
    pub(crate) crops: usize,
    pub(crate) encode_ms: f64,
    pub(crate) query_ms: f64,
}

/// Two clusters that look alike and touch.
#[derive(Debug, Serialize)]
pub(crate) struct Merge {
    pub(crate) clusters: [u32; 2],
    pub(crate) similarity: f32,
    pub(crate) overlap: f32,
}

/// Searches a scene; clusters that were not encoded, or changed since, are encoded first.
pub(crate) fn search(
    scene: &Arc<Scene>,
    arguments: &SearchArguments<'_>,
) -> Result<SearchReport, CliError> {
    if scene.clusters.is_none() {
        return Err(SearchError::NoClusters.into());
    }
    let phrases: Vec<&str> = arguments.phrases.iter().map(String::as_str).collect();
    expect_words(&phrases)?;
    let model = OnnxModel::open(arguments.models).map_err(SearchError::from)?;
    let name = model.description().name.clone();
    let mut searcher = Searcher::new(Arc::clone(scene), Box::new(model), arguments.crops.clone())?;
    let mut renderer = CpuCropRenderer::new(Arc::clone(scene));

    let start = Instant::now();
    let encoded = encode(&mut searcher, &phrases, &mut renderer, arguments)?;
    let encode_time = start.elapsed();
    let start = Instant::now();
    let answer = searcher.query(&phrases, &arguments.query)?;
    let query_time = start.elapsed();

    if let Some(path) = arguments.sheet {
        let rows: Vec<Vec<Found>> =
            answer.phrases.iter().map(|p| found(&p.text, &p.matches)).collect();
        let rows: Vec<&[Found]> = rows.iter().map(|row| &row[..]).collect();
        write_png(path, &contact_sheet(&searcher, &mut renderer, &rows)?)?;
    }
    let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
    Ok(SearchReport {
        results: answer.phrases.iter().flat_map(|p| found(&p.text, &p.matches)).collect(),
        nearest: nearest(&answer),
        merge_suggestions: merges(&searcher),
        left_out: answer.left_out,
        threshold: answer.threshold,
        model: name,
        encoded_clusters: encoded.clusters,
        crops: encoded.crops,
        encode_ms: milliseconds(encode_time),
        query_ms: milliseconds(query_time),
    })
}

/// Takes what is kept, encodes the rest, and keeps it. A file that cannot be used is made anew.
fn encode(
    searcher: &mut Searcher,
    phrases: &[&str],
    renderer: &mut CpuCropRenderer,
    arguments: &SearchArguments<'_>,
) -> Result<trapeze_query::Encoded, CliError> {
    let path: PathBuf =
        arguments.features.map_or_else(|| features_path(arguments.path), Path::to_owned);
    match FeatureStore::read(&path) {
        Ok(Some(store)) => {
            searcher.restore(store);
        }
        Ok(None) => {}
        Err(error) => tracing::warn!("{error}; the clusters are encoded again"),
    }
    if searcher.outdated() > 0 {
        // What is wrong with them is told before the long work, not after it.
        searcher.check(phrases)?;
    }
    let progress = progress_bar(0, "encoding");
    let encoded = searcher.encode(renderer, |done, all| {
        progress.set_length(all as u64);
        progress.set_position(done as u64);
        ControlFlow::Continue(())
    })?;
    progress.finish_and_clear();
    if encoded.clusters > 0 {
        let bytes = searcher.store().to_bytes();
        // A scene that cannot be written to can still be searched.
        if let Err(error) = write_atomically(&path, |file| file.write_all(&bytes)) {
            tracing::warn!("features are not kept: {error}");
        }
    }
    Ok(encoded)
}

fn found(text: &str, matches: &[Match]) -> Vec<Found> {
    let of = |found: &Match| Found {
        text: text.to_owned(),
        cluster: found.cluster,
        name: found.name.clone(),
        score: found.score,
        cosine: found.cosine,
    };
    matches.iter().map(of).collect()
}

fn nearest(answer: &Answer) -> Vec<Found> {
    let of = |phrase: &trapeze_query::ranking::PhraseAnswer| {
        found(&phrase.text, phrase.nearest.as_slice())
    };
    answer.phrases.iter().flat_map(of).collect()
}

fn merges(searcher: &Searcher) -> Vec<Merge> {
    let Some(clusters) = &searcher.scene().clusters else { return Vec::new() };
    let id = |label: u32| clusters.table[label as usize].id;
    let suggestions = searcher.suggest_merges(MergeLimits::default());
    suggestions
        .iter()
        .map(|pair| Merge {
            clusters: [id(pair.labels.0), id(pair.labels.1)],
            similarity: pair.similarity,
            overlap: pair.overlap,
        })
        .collect()
}
