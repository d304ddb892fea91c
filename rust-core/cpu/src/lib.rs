//! The renderer on the CPU, stage by stage, and the f64 reference that specifies it.

pub mod bin;
pub mod deform;
mod gradient;
pub mod motion;
pub mod project;
pub mod rasterize;
pub mod reference;
mod renderer;
pub mod sort;

pub use gradient::{ImageGradient, PoseGradients};
pub use renderer::{Pick, Renderer, RendererOptions, StageTimes};
