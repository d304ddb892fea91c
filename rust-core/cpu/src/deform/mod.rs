//! Stage 1: splats at the time of the frame.
//!
//! The network is evaluated for small groups of splats that are neighbours in space
//! ([`order`]), in three steps: the positions' part of the input sums (kept between frames), the
//! hidden layers over the features that are not zero ([`layer`]), and what the outputs do to the
//! splats ([`apply`]). The specification is [`crate::reference::deform`].

mod apply;
mod deformed;
mod encoding;
mod group;
mod layer;
mod network;
mod order;
mod stage;

pub(crate) use encoding::encode_positions;

pub use deformed::{Deformed, MAX_SCALE, SplatPose};
pub use stage::{DeformationOptions, DeformationStage};
