//! Adam, the regularisers and the noise against the CPU's.

use fearless_simd::Level;
use trapeze_gpu::{Gpu, ParameterBuffers};
use trapeze_scene::{ShDegree, Splats};

use super::super::kernels::TrainingKernels;
use super::super::layout::{TrainingStep, report};
use super::super::splats::ResidentSplats;
use super::super::update_stage::UpdateStage;
use super::{device, run};
use crate::config::TrainingConfig;
use crate::optimizer::apply_update;
use crate::parameters::ParameterGroup;
use crate::parameters::tests::random_splats;
use crate::schedule::StepPlan;
use crate::{TrainingState, zeros_like};

/// Updates a state with one gradient after the other; returns it and the numbers of parameters that
/// were skipped.
fn updated(
    gpu: &Gpu,
    state: &TrainingState,
    steps: &[(StepPlan, Splats)],
    halted: u32,
) -> (TrainingState, Vec<u32>) {
    let mut kernels = TrainingKernels::new(gpu);
    let mut splats = ResidentSplats::upload(gpu, state, 0).unwrap();
    let counts = gpu.storage_of("counts", &[0u32, 0, 0, 0, 0, halted, 0, 0]).unwrap();
    let reports = gpu.storage("reports", u64::from(4 * report::WORDS)).unwrap();
    let uniform = gpu.uniform_of("step", &[0; size_of::<TrainingStep>()]);
    let stage = UpdateStage::new(gpu, &mut kernels, &splats, &uniform, &counts, &reports);
    let mut skipped = Vec::new();
    for (plan, gradients) in steps {
        splats.gradients.write(gpu, gradients).unwrap();
        gpu.write(&reports, &[0u32; report::WORDS as usize]).unwrap();
        let numbers = TrainingStep::new(plan, splats.count(), [1, 1], false, 0);
        gpu.queue().write_buffer(&uniform, 0, bytemuck::bytes_of(&numbers));
        run(gpu, |pass| stage.record(&kernels, pass, splats.count(), plan.noise.is_some()));
        let words: Vec<u32> =
            trapeze_gpu::compute::read(gpu, &reports, u64::from(report::WORDS)).unwrap();
        skipped.push(words[report::NOT_FINITE]);
    }
    let step = steps.last().map_or(0, |(plan, _)| plan.step + 1);
    (splats.read(gpu, step).unwrap(), skipped)
}

fn updated_on_cpu(
    state: &TrainingState,
    steps: &[(StepPlan, Splats)],
) -> (TrainingState, Vec<u32>) {
    let mut state = state.clone();
    let update = |(plan, gradients): &(StepPlan, Splats)| {
        apply_update(Level::new(), &mut state, &mut gradients.clone(), &[], plan)
    };
    let skipped = steps.iter().map(update).collect();
    (state, skipped)
}

/// Gradients of the size that those of a mean over pixels have.
fn gradients(seed: u64, n: usize, degree: ShDegree) -> Splats {
    let mut gradients = random_splats(seed, n, degree);
    for group in ParameterGroup::ALL {
        group.of_mut(&mut gradients).iter_mut().for_each(|g| *g *= 1e-5);
    }
    gradients
}

fn largest(values: &[f32]) -> f32 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// `rounding` is in units of 2⁻²³ of a group's largest value, and of what a group's rate moves.
fn assert_close(found: &TrainingState, expected: &TrainingState, plan: &StepPlan, rounding: f32) {
    for group in ParameterGroup::ALL {
        let rate = (plan.rates.of(group) * plan.adam.first_correction) as f32;
        for (name, found, expected, scale) in [
            ("parameter", &found.splats, &expected.splats, rate),
            ("mean", &found.first_moments, &expected.first_moments, 0.0),
            ("square", &found.second_moments, &expected.second_moments, 0.0),
        ] {
            let (found, expected) = (group.of(found), group.of(expected));
            assert_eq!(found.len(), expected.len());
            let bound = rounding * f32::EPSILON * (largest(expected) + 8.0 * scale);
            for (i, (f, e)) in found.iter().zip(expected).enumerate() {
                let error = (f - e).abs();
                assert!(error <= bound, "{} {i} {name}: {f} {e}", group.name());
            }
        }
    }
}

#[test]
fn twenty_updates_are_those_of_the_cpu() {
    let Some(gpu) = device() else { return };
    let config = TrainingConfig::growing(100, 1000);
    for (degree, n) in [(ShDegree::Zero, 1), (ShDegree::One, 700), (ShDegree::Three, 300)] {
        let state = TrainingState::new(random_splats(1, n, degree));
        let steps: Vec<(StepPlan, Splats)> = (0..20)
            .map(|t| {
                let plan = StepPlan { noise: None, ..config.step_plan(t, 1.0, 1.0) };
                (plan, gradients(100 + u64::from(t), n, degree))
            })
            .collect();
        let (found, skipped) = updated(&gpu, &state, &steps, 0);
        let (expected, _) = updated_on_cpu(&state, &steps);
        assert_eq!(skipped, [0; 20]);
        assert_eq!(found.step, expected.step);
        // Each of 20 steps rounds the parameter once, and its update, of at most about one rate,
        // in a dozen operations, of which a device's division and root take 2.5 ulp each.
        assert_close(&found, &expected, &steps[0].0, 20.0);
    }
}

#[test]
fn what_is_not_finite_is_counted_and_changes_nothing() {
    let Some(gpu) = device() else { return };
    let n = 300;
    let config = TrainingConfig::fixed(100);
    let plan = config.step_plan(0, 1.0, 1.0);
    let state = TrainingState::new(random_splats(1, n, ShDegree::One));
    for poison in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
        let mut gradients = zeros_like(&state.splats);
        gradients.log_scales[7][2] = poison;
        gradients.sh_rest[11] = poison;
        gradients.positions[299][1] = poison;
        let (found, skipped) = updated(&gpu, &state, &[(plan.clone(), gradients)], 0);
        assert_eq!((skipped, found.splats), (vec![3], state.splats.clone()), "{poison}");
    }
}

#[test]
fn an_exploding_rate_and_poisoned_splats_never_write_what_is_not_finite() {
    let Some(gpu) = device() else { return };
    let n = 200;
    let mut config = TrainingConfig::growing(100, 1000);
    config.rates.sh_dc = 3e38;
    config.rates.rotations = 3e38;
    let mut state = TrainingState::new(random_splats(1, n, ShDegree::Zero));
    state.splats.opacity_logits[..4].copy_from_slice(&[f32::NAN, f32::INFINITY, 1e4, -1e4]);
    state.splats.log_scales[5] = [f32::NAN, 1e9, -1e9];
    state.splats.rotations[6] = [0.0; 4];
    state.splats.rotations[7] = [f32::NAN; 4];
    let steps: Vec<(StepPlan, Splats)> = (0..3)
        .map(|t| {
            (config.step_plan(t, 1.0, 1.0), random_splats(9 + u64::from(t), n, ShDegree::Zero))
        })
        .collect();
    let (found, skipped) = updated(&gpu, &state, &steps, 0);
    let (expected, cpu_skipped) = updated_on_cpu(&state, &steps);
    assert_eq!(skipped, cpu_skipped);
    for (group, i) in ParameterGroup::ALL
        .into_iter()
        .flat_map(|g| (0..g.of(&found.splats).len()).map(move |i| (g, i)))
    {
        let (before, after) = (group.of(&state.splats)[i], group.of(&found.splats)[i]);
        assert_eq!(after.is_finite(), before.is_finite(), "{} {i}: {after}", group.name());
        let expected = group.of(&expected.splats)[i];
        assert_eq!(after.is_finite(), expected.is_finite(), "{} {i}", group.name());
    }
}

#[test]
fn nothing_changes_while_frames_are_not_drawn() {
    let Some(gpu) = device() else { return };
    let state = TrainingState::new(random_splats(1, 300, ShDegree::One));
    let mut plan = TrainingConfig::growing(100, 1000).step_plan(0, 1.0, 1.0);
    plan.rates.positions = 1.0;
    let steps = [(plan, gradients(5, 300, ShDegree::One))];
    let (found, skipped) = updated(&gpu, &state, &steps, 1);
    assert_eq!((found.splats, skipped), (state.splats, vec![0]));
}

#[test]
fn the_noise_is_that_of_the_cpu() {
    let Some(gpu) = device() else { return };
    let n = 1000;
    let mut state = TrainingState::new(random_splats(4, n, ShDegree::Zero));
    // Transparent ones wander, by up to a few scales.
    for (i, logit) in state.splats.opacity_logits.iter_mut().enumerate() {
        *logit = -8.0 + 0.01 * i as f32;
    }
    let mut config = TrainingConfig::growing(100, 1000);
    config.seed = 0x0123_4567_89ab_cdef;
    let mut plan = config.step_plan(77, 1.0, 1.0);
    plan.rates = crate::optimizer::Rates { positions: 1e-3, ..Default::default() };
    let steps = [(plan, zeros_like(&state.splats))];
    let (found, _) = updated(&gpu, &state, &steps, 0);
    let (expected, _) = updated_on_cpu(&state, &steps);
    let mut moved = 0.0f32;
    for i in 0..n {
        let before = state.splats.positions[i];
        let (f, e) = (found.splats.positions[i], expected.splats.positions[i]);
        let step = (0..3).map(|c| (e[c] - before[c]).abs()).fold(0.0, f32::max);
        moved = moved.max(step);
        for c in 0..3 {
            // The sum is rounded once. The step is a product of two exponentials, a logistic function
            // of 100·(o − 0.005), whose argument a device rounds by up to 1e-6, and a normal number
            // whose root loses 3 ulp: about 60 ulp of the step in all.
            let bound = f32::EPSILON * (before[c].abs() + 60.0 * step);
            assert!((f[c] - e[c]).abs() <= bound, "{i} {c}: {} {} {}", f[c], e[c], before[c]);
        }
    }
    assert!(moved > 0.1, "{moved}");
}

#[test]
fn more_bands_leave_lower_ones_and_their_moments_where_they_were() {
    let Some(gpu) = device() else { return };
    let kernels = TrainingKernels::new(&gpu);
    let mut state = TrainingState::new(random_splats(1, 50, ShDegree::One));
    state.first_moments = random_splats(2, 50, ShDegree::One);
    state.second_moments = random_splats(3, 50, ShDegree::One);
    let mut splats = ResidentSplats::upload(&gpu, &state, 80).unwrap();
    for degree in [ShDegree::Two, ShDegree::Three] {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        splats.raise_degree(&gpu, &kernels, degree, &mut encoder).unwrap();
        gpu.queue().submit([encoder.finish()]);
        state.raise_sh_degree(degree);
        assert_eq!(splats.read(&gpu, 0).unwrap(), state);
        assert_eq!(splats.gradients.sh_degree, degree);
    }
    assert!(splats.parameters.capacity == 80 && splats.count() == 50);
    let bytes = ParameterBuffers::bytes(80, ShDegree::Three);
    assert_eq!(ResidentSplats::bytes(80, ShDegree::Three), 4 * bytes);
}
