//! From features to answers: which clusters a phrase means.

mod merge;
mod score;

use serde::Serialize;

use crate::models::{Embedder, ModelError, normalised};

pub use merge::{MergeLimits, MergeSuggestion, suggest_merges};
pub use score::{Score, score};

/// How many answers, and how good.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QueryOptions {
    /// Most matches of a phrase.
    pub top_k: usize,
    /// The least score of a match; the model's own where there is none.
    pub threshold: Option<f32>,
}

impl Default for QueryOptions {
    fn default() -> Self {
        Self { top_k: 3, threshold: None }
    }
}

/// A cluster and how well a phrase fits it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Match {
    /// The cluster's id.
    pub cluster: u32,
    /// Its name, when it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The phrase's share against the background texts, 0–1.
    pub score: f32,
    /// Cosine between the phrase's feature and the cluster's.
    pub cosine: f32,
}

/// What was found for one phrase.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhraseAnswer {
    /// The phrase.
    pub text: String,
    /// Clusters whose score reaches the threshold, the best first, at most `top_k`.
    pub matches: Vec<Match>,
    /// The best cluster when none reaches the threshold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest: Option<Match>,
}

/// A cluster that takes no part, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Excluded {
    /// The cluster's id.
    pub cluster: u32,
    /// Its name, when it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The reason in words.
    pub reason: &'static str,
}

/// The answer to one or more phrases.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// One per phrase, in their order.
    pub phrases: Vec<PhraseAnswer>,
    /// Clusters that took no part.
    pub left_out: Vec<Excluded>,
    /// The threshold that was used.
    pub threshold: f32,
}

/// The feature of a phrase: the mean of the features of all templates with it (the prompt ensemble of
/// Radford et al. 2021), of unit length.
///
/// # Errors
/// [`ModelError`] as the model says.
pub fn phrase_feature(embedder: &mut dyn Embedder, phrase: &str) -> Result<Vec<f32>, ModelError> {
    let prompts: Vec<String> = embedder
        .description()
        .search
        .templates
        .iter()
        .map(|template| template.replacen("{}", phrase.trim(), 1))
        .collect();
    let features = embedder.embed_texts(&prompts)?;
    let mut mean = vec![0.0; embedder.description().dimension];
    for feature in &features {
        mean.iter_mut().zip(feature).for_each(|(sum, value)| *sum += value);
    }
    // Templates that cancel each other say nothing together; the first one then speaks alone.
    Ok(normalised(&mean).or_else(|| features.into_iter().next()).unwrap_or(mean))
}
