//! The renderer on the CPU, stage by stage, and the f64 reference that specifies it.

pub mod bin;
pub mod deform;
mod deform_backward;
mod differentiable;
mod gradient;
pub mod motion;
pub mod project;
mod project_backward;
pub mod rasterize;
pub mod rasterize_backward;
pub mod reference;
mod renderer;
pub mod sort;

pub use differentiable::{DifferentiableRenderer, PassTimes};
pub use gradient::{ImageGradient, PoseGradients};
pub use renderer::{Pick, Renderer, RendererOptions, StageTimes};
