//! The backward pass: the f64 specification against differences of the forward pass, and the fast
//! path against the specification.

mod differences;
mod fast;
mod network;
mod scenes;
#[path = "../support/mod.rs"]
mod support;
