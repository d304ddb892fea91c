//! The renderer on the CPU, stage by stage, and the f64 reference that specifies it.

pub mod deform;
pub mod motion;
pub mod reference;
