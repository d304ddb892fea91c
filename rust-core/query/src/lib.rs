//! Text search over the clusters of a scene, without a network connection.
//!
//! A [`Searcher`] looks at every cluster once: it renders [`crops`] of it from where it is seen well,
//! has a model ([`models`]) turn them into features, and keeps their mean ([`features`]). A phrase
//! becomes [`tokenizer`] tokens and a feature of its own, and the nearest clusters answer it
//! ([`ranking`]). Scenes that come without clusters get them from [`cluster`].
//!
//! The crate renders nothing and depends on no renderer: whoever uses it supplies a
//! [`CropRenderer`](crops::CropRenderer).

pub mod cluster;
pub mod crops;
mod error;
pub mod features;
pub mod models;
pub mod ranking;
mod searcher;
#[cfg(test)]
mod test_scene;
pub mod tokenizer;

pub use error::SearchError;
pub use searcher::{Encoded, Searcher, expect_words};
