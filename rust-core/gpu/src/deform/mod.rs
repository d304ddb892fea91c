//! Stage 1 on the host: the network's weights as the kernels read them, and one frame's work.

mod half;
mod stage;
mod weights;

pub use stage::NetworkPrecision;
pub(crate) use stage::{DeformStage, DeformWork};
pub(crate) use weights::PackedWeights;

#[cfg(test)]
mod tests;
