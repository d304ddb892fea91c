//! The executable specification: every stage in f64.

pub mod deform;
