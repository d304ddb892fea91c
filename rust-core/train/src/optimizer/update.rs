//! One whole update of the state on the CPU.

use fearless_simd::Level;
use trapeze_scene::Splats;

use super::{adam_step, adam_step_of_network};
use crate::TrainingState;
use crate::schedule::StepPlan;

/// Takes the step of `plan`: adds the regularisers to `gradients`, updates every parameter, moves
/// positions by their noise, counts the step. Returns how many parameters were skipped because
/// something was not finite, see [`adam_step`].
///
/// `by_network` is read where the plan trains a network and the state has one.
pub fn apply_update(
    level: Level,
    state: &mut TrainingState,
    gradients: &mut Splats,
    by_network: &[f32],
    plan: &StepPlan,
) -> u32 {
    plan.regularisers.add_gradient(level, &state.splats, gradients);
    let mut skipped = adam_step(level, state, gradients, &plan.rates, &plan.adam);
    if let (Some(step), Some(trained)) = (&plan.network, &mut state.network) {
        skipped += adam_step_of_network(level, trained, by_network, step);
    }
    if let Some(noise) = &plan.noise {
        noise.add(level, &mut state.splats, plan.rates.positions, plan.seed, plan.step);
    }
    state.step = plan.step + 1;
    skipped
}
