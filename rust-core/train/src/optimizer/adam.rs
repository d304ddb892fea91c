//! Adam (Kingma and Ba 2015) over the arrays of all parameters.

use fearless_simd::{Level, Simd, dispatch};
use fearless_simd_macros::simd;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use trapeze_scene::Splats;

use super::Rates;
use crate::parameters::ParameterGroup;
use crate::schedule::NetworkStep;
use crate::{TrainedNetwork, TrainingState};

/// Adam's constants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdamConstants {
    /// Decay of the running mean of the gradient.
    pub beta1: f64,
    /// Decay of the running mean of its square.
    pub beta2: f64,
    /// Added to the root of the second moment. Gradients here are of a mean over all pixels, so
    /// they are tiny, and Adam's customary 1e-8 would drown them (Kerbl et al. 2023 use 1e-15).
    pub epsilon: f64,
}

impl Default for AdamConstants {
    fn default() -> Self {
        Self { beta1: 0.9, beta2: 0.999, epsilon: 1e-15 }
    }
}

/// The constants of one step, in the form that the update uses; the same eight numbers are the
/// uniform of a kernel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdamStep {
    /// β₁.
    pub beta1: f32,
    /// 1 − β₁, not the rounded difference of the rounded β₁.
    pub one_minus_beta1: f32,
    /// β₂.
    pub beta2: f32,
    /// 1 − β₂.
    pub one_minus_beta2: f32,
    /// 1 / √(1 − β₂ᵗ).
    pub second_correction: f32,
    /// ε.
    pub epsilon: f32,
    /// 1 / (1 − β₁ᵗ), by which the rate is multiplied.
    pub first_correction: f64,
}

impl AdamConstants {
    /// The constants of step `t`, counted from 1.
    #[must_use]
    pub fn at_step(&self, t: u32) -> AdamStep {
        let t = f64::from(t.max(1));
        AdamStep {
            beta1: self.beta1 as f32,
            one_minus_beta1: (1.0 - self.beta1) as f32,
            beta2: self.beta2 as f32,
            one_minus_beta2: (1.0 - self.beta2) as f32,
            second_correction: (1.0 - self.beta2.powf(t)).sqrt().recip() as f32,
            epsilon: self.epsilon as f32,
            first_correction: (1.0 - self.beta1.powf(t)).recip(),
        }
    }
}

/// Numbers per task: enough to hide the cost of a task, and to spread 10 000 splats over 8 cores.
const CHUNK: usize = 8192;

/// One step of Adam on every parameter. Returns how many parameters kept their value because
/// the gradient or the result was not finite, or the square of the gradient overflowed.
///
/// What is kept is kept with its moments, so no NaN enters the state; it is for the caller to see
/// the count and roll back. Every number is updated by itself, so the result does not depend on
/// threads or vector width.
///
/// # Panics
/// When the gradients belong to other splats: a fault of the program, not of its input.
pub fn adam_step(
    level: Level,
    state: &mut TrainingState,
    gradients: &Splats,
    rates: &Rates,
    step: &AdamStep,
) -> u32 {
    let mut skipped = 0;
    for group in ParameterGroup::ALL {
        let parameters = group.of_mut(&mut state.splats);
        let first = group.of_mut(&mut state.first_moments);
        let second = group.of_mut(&mut state.second_moments);
        let gradients = group.of(gradients);
        assert_eq!(parameters.len(), gradients.len(), "gradients of {}", group.name());
        let rate = (rates.of(group) * step.first_correction) as f32;
        skipped += update_all(level, parameters, first, second, gradients, rate, step);
    }
    skipped
}

/// The same for the weights and biases of a deformation network; `gradients` are in the order of
/// [`network_parameters`](crate::network_parameters).
///
/// # Panics
/// When the gradients or the moments belong to another network.
pub fn adam_step_of_network(
    level: Level,
    trained: &mut TrainedNetwork,
    gradients: &[f32],
    step: &NetworkStep,
) -> u32 {
    assert_eq!(gradients.len(), trained.network.parameter_count(), "gradients of the network");
    let rate = (step.rate * step.adam.first_correction) as f32;
    let (mut first, mut second) = (&mut trained.first_moments[..], &mut trained.second_moments[..]);
    let mut gradients = gradients;
    let mut skipped = 0;
    for layer in trained.network.layers_mut() {
        for array in [&mut layer.weight, &mut layer.bias] {
            let n = array.len();
            let (m, v, g);
            (m, first) = std::mem::take(&mut first).split_at_mut(n);
            (v, second) = std::mem::take(&mut second).split_at_mut(n);
            (g, gradients) = gradients.split_at(n);
            skipped += update_all(level, array, m, v, g, rate, &step.adam);
        }
    }
    skipped
}

/// One step on one array and its moments.
fn update_all(
    level: Level,
    parameters: &mut [f32],
    first: &mut [f32],
    second: &mut [f32],
    gradients: &[f32],
    rate: f32,
    step: &AdamStep,
) -> u32 {
    parameters
        .par_chunks_mut(CHUNK)
        .zip(first.par_chunks_mut(CHUNK))
        .zip(second.par_chunks_mut(CHUNK))
        .zip(gradients.par_chunks(CHUNK))
        .map(|(((p, m), v), g)| dispatch!(level, simd => update(simd, p, m, v, g, rate, step)))
        .sum()
}

#[simd]
fn update<S: Simd>(
    _: S,
    parameters: &mut [f32],
    first: &mut [f32],
    second: &mut [f32],
    gradients: &[f32],
    rate: f32,
    step: &AdamStep,
) -> u32 {
    let mut skipped = 0;
    for (((p, m), v), &g) in parameters.iter_mut().zip(first).zip(second).zip(gradients) {
        let mean = step.beta1 * *m + step.one_minus_beta1 * g;
        let square = step.beta2 * *v + step.one_minus_beta2 * (g * g);
        let moved = *p - rate * mean / (square.sqrt() * step.second_correction + step.epsilon);
        let usable = square.is_finite() & moved.is_finite();
        *p = if usable { moved } else { *p };
        *m = if usable { mean } else { *m };
        *v = if usable { square } else { *v };
        skipped += u32::from(!usable);
    }
    skipped
}

#[cfg(test)]
mod tests {
    use trapeze_scene::ShDegree;

    use super::*;
    use crate::network_parameters;
    use crate::parameters::tests::random_splats;

    fn rates() -> Rates {
        Rates {
            positions: 1e-3,
            log_scales: 5e-3,
            rotations: 1e-3,
            opacity_logits: 5e-2,
            sh_dc: 2.5e-3,
            sh_rest: 1.25e-4,
        }
    }

    fn state() -> TrainingState {
        TrainingState::new(random_splats(1, 3000, ShDegree::One))
    }

    #[test]
    fn twenty_steps_follow_adam_in_double_precision() {
        let (mut state, constants) = (state(), AdamConstants::default());
        let start = state.clone();
        let gradients: Vec<Splats> =
            (0..20).map(|i| random_splats(100 + i, 3000, ShDegree::One)).collect();
        for (t, gradients) in (1..).zip(&gradients) {
            let step = constants.at_step(t);
            assert_eq!(adam_step(Level::new(), &mut state, gradients, &rates(), &step), 0);
        }
        for group in ParameterGroup::ALL {
            let rate = rates().of(group);
            for i in (0..group.of(&start.splats).len()).step_by(97) {
                let mut p = f64::from(group.of(&start.splats)[i]);
                let (mut m, mut v) = (0.0, 0.0);
                for (t, gradients) in (1..).zip(&gradients) {
                    let g = f64::from(group.of(gradients)[i]);
                    m = 0.9 * m + 0.1 * g;
                    v = 0.999 * v + 0.001 * g * g;
                    let (mh, vh) = (m / (1.0 - 0.9f64.powi(t)), v / (1.0 - 0.999f64.powi(t)));
                    p -= rate * mh / (vh.sqrt() + 1e-15);
                }
                // Each of 20 steps rounds the parameter (half an ulp of up to 4) and the update
                // (about 10 operations on a value of at most ~2 rates).
                let ulp = f64::from(f32::EPSILON);
                let bound = 20.0 * (0.5 * ulp * p.abs().max(1.0) + 20.0 * ulp * rate);
                let found = f64::from(group.of(&state.splats)[i]);
                assert!((found - p).abs() <= bound, "{} {i}: {found} {p}", group.name());
            }
        }
    }

    #[test]
    fn tiny_gradients_still_move_by_the_rate() {
        let mut state = state();
        let before = state.splats.positions[0][0];
        let mut gradients = crate::parameters::zeros_like(&state.splats);
        gradients.positions[0][0] = 1e-11;
        let step = AdamConstants::default().at_step(1);
        adam_step(Level::new(), &mut state, &gradients, &rates(), &step);
        // The first step of Adam is rate·g/(|g| + ε) = 1e-3·(1 − 1e-4).
        assert!((before - state.splats.positions[0][0] - 1e-3).abs() < 2e-7);
        assert_eq!(
            state.splats.positions[1][0],
            random_splats(1, 3000, ShDegree::One).positions[1][0]
        );
    }

    #[test]
    fn what_is_not_finite_is_counted_and_changes_nothing() {
        for poison in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
            let mut state = state();
            let before = state.clone();
            let mut gradients = crate::parameters::zeros_like(&state.splats);
            gradients.log_scales[7][2] = poison;
            gradients.sh_rest[11] = poison;
            let step = AdamConstants::default().at_step(1);
            assert_eq!(adam_step(Level::new(), &mut state, &gradients, &rates(), &step), 2);
            assert_eq!(state, before);
        }
    }

    #[test]
    fn an_exploding_rate_never_writes_a_value_that_is_not_finite() {
        let mut state = state();
        let gradients = random_splats(9, 3000, ShDegree::One);
        let rates = Rates { positions: 3e38, sh_dc: f64::INFINITY, ..rates() };
        let mut skipped = 0;
        for t in 1..10 {
            let step = AdamConstants::default().at_step(t);
            skipped += adam_step(Level::new(), &mut state, &gradients, &rates, &step);
        }
        assert!(skipped >= 9 * 3 * 3000, "{skipped}");
        for part in [&state.splats, &state.first_moments, &state.second_moments] {
            assert!(ParameterGroup::ALL.iter().all(|g| g.of(part).iter().all(|v| v.is_finite())));
        }
    }

    #[test]
    fn threads_and_vector_width_change_no_bit() {
        let run = |threads: usize, level: Level| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut state = state();
            for t in 1..4 {
                let gradients = random_splats(u64::from(t), 3000, ShDegree::One);
                let step = AdamConstants::default().at_step(t);
                pool.install(|| adam_step(level, &mut state, &gradients, &rates(), &step));
            }
            state
        };
        let expected = run(1, Level::baseline());
        assert_eq!(run(3, Level::new()), expected);
        assert_eq!(run(2, Level::baseline()), expected);
    }

    #[test]
    fn a_network_is_updated_number_by_number_in_the_order_of_its_gradient() {
        let constants = AdamConstants::default();
        let step = NetworkStep { time_offset: 0.0, rate: 1e-3, adam: constants.at_step(1) };
        let mut trained = TrainedNetwork::standard(2);
        let before = network_parameters(&trained.network);
        let n = before.len();
        let mut gradients: Vec<f32> = (0..n).map(|i| 1e-6 * ((i % 7) as f32 - 3.0)).collect();
        (gradients[5], gradients[n - 1]) = (f32::NAN, f32::INFINITY);
        assert_eq!(adam_step_of_network(Level::new(), &mut trained, &gradients, &step), 2);
        let after = network_parameters(&trained.network);
        for i in 0..n {
            let (g, moment) = (gradients[i], trained.first_moments[i]);
            // The first step of Adam is the rate, against the sign of the gradient.
            let moved = if g.is_finite() && g != 0.0 { -1e-3 * g.signum() } else { 0.0 };
            assert!((after[i] - before[i] - moved).abs() < 1e-7, "{i}");
            let expected = if g.is_finite() { 0.1 * g } else { 0.0 };
            assert!((moment - expected).abs() < 1e-12, "{i}: {moment}");
        }
    }
}
