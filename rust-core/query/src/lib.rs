//! Text search over the clusters of a scene.
//!
//! A text becomes tokens ([`tokenizer`]), exactly those that the models were trained with: a wrong
//! token is not an error that anything reports, it is a search that finds the wrong thing.

pub mod tokenizer;
