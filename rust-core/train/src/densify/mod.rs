//! How the set of splats changes: Kheradmand et al. 2024, "3D Gaussian Splatting as Markov Chain
//! Monte Carlo" (arXiv 2404.09591).
//!
//! Splats that have become invisible move to where they are needed, the set grows by a fixed share
//! up to a hard cap, and nearly transparent splats explore. Nothing here depends on the image, and
//! every choice is a function of (parameters, seed, step), so that the CPU and the GPU make the same.

mod correction;
mod noise;
mod relocation;
mod removal;
mod sampling;

pub use correction::{MAX_COPIES, logit, relocation_correction};
pub use noise::PositionNoise;
pub(crate) use relocation::{dead_logit, lowest_logit};
pub use relocation::{grow, grown_count, relocate_dead};
pub use removal::{RemovalCosts, random_signs, thin};
pub(crate) use sampling::{OpacityUnits, weight_bits, weight_shift};

use crate::TrainingState;
use crate::schedule::DensifyPlan;

/// Carries out a plan: the dead move, then the set grows to the plan's count. No splat rests after it,
/// since places changed hands.
pub fn densify(state: &mut TrainingState, plan: &DensifyPlan) {
    state.resting = None;
    relocate_dead(state, plan.dead_opacity, plan.seed);
    grow(state, plan.count, plan.dead_opacity, plan.seed);
}
