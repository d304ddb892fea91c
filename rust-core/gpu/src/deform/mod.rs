//! Stage 1 on the host: the network's weights as the kernels read them, and one frame's work.

mod stage;
mod weights;

pub(crate) use stage::{DeformStage, NETWORK_ARGUMENTS};
