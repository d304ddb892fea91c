//! The training loss, (1 − λ)·L1 + λ·(1 − SSIM) (Kerbl et al. 2023, λ = 0.2), and the metrics.
//!
//! [`mod@reference`] states in double precision what is computed. [`ImageLoss`] computes it in single
//! precision, forward and backward in one pass over bands of rows: a band's planes stay in the
//! second-level cache from the composite to the gradient, and the SSIM statistics of a pixel never
//! leave the first. [`metrics`] is what `eval` reports.

mod band;
mod composite;
mod image_loss;
mod kernels;
pub mod metrics;
mod plane;
pub mod reference;
mod target;
#[cfg(test)]
mod tests;
mod window;

pub use image_loss::{ImageLoss, LossValue};
pub use target::{Channels, TargetError, TargetImage};
