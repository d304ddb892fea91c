//! Relocation and growth against the CPU's.

use trapeze_gpu::Gpu;
use trapeze_scene::ShDegree;

use super::super::densify_stage::DensifyStage;
use super::super::kernels::TrainingKernels;
use super::super::splats::ResidentSplats;
use super::device;
use crate::TrainingState;
use crate::densify::densify;
use crate::parameters::ParameterGroup;
use crate::parameters::tests::random_splats;
use crate::schedule::DensifyPlan;

fn densified(gpu: &Gpu, state: &TrainingState, plan: &DensifyPlan, halted: u32) -> TrainingState {
    let mut kernels = TrainingKernels::new(gpu);
    let mut splats = ResidentSplats::upload(gpu, state, plan.count).unwrap();
    let counts = gpu.storage_of("counts", &[0u32, 0, 0, 0, 0, halted, 0, 0]).unwrap();
    let stage = DensifyStage::new(gpu, &mut kernels, &splats, &counts).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    stage.record(gpu, &kernels, &mut encoder, plan, (splats.count(), state.step));
    gpu.queue().submit([encoder.finish()]);
    splats.set_count(plan.count.max(splats.count()));
    splats.read(gpu, state.step).unwrap()
}

fn densified_on_cpu(state: &TrainingState, plan: &DensifyPlan) -> TrainingState {
    let mut state = state.clone();
    densify(&mut state, plan);
    state
}

/// `n` splats with moments everywhere; every tenth is dead, some are not finite.
fn state(n: usize, degree: ShDegree) -> TrainingState {
    let mut state = TrainingState::new(random_splats(1, n, degree));
    for i in (10..n).step_by(10) {
        state.splats.opacity_logits[i] = -8.0;
    }
    if n > 60 {
        state.splats.positions[3][1] = f32::NAN;
        state.splats.rotations[33][3] = f32::INFINITY;
        state.splats.opacity_logits[55] = f32::NAN;
        if let Some(c) = state.splats.sh_rest.last_mut() {
            *c = f32::NEG_INFINITY;
        }
    }
    state.first_moments = random_splats(2, n, degree);
    state.second_moments = random_splats(3, n, degree);
    state.step = 700;
    state
}

/// Everything that is copied is the same to the last bit; only corrected opacities and scales, which
/// the CPU computes in double precision, differ: by a few roundings of a logit of up to 20, and of
/// the integral's 53 positive terms.
fn assert_same(found: &TrainingState, expected: &TrainingState) {
    assert_eq!(found.splats.len(), expected.splats.len());
    assert!(found.first_moments == expected.first_moments, "first moments");
    assert!(found.second_moments == expected.second_moments, "second moments");
    for group in ParameterGroup::ALL {
        let is_corrected =
            matches!(group, ParameterGroup::OpacityLogits | ParameterGroup::LogScales);
        let bound = if is_corrected { 20.0 * f32::EPSILON * 8.0 } else { 0.0 };
        let pairs = group.of(&found.splats).iter().zip(group.of(&expected.splats));
        for (i, (f, e)) in pairs.enumerate() {
            let same = f.to_bits() == e.to_bits() || (f - e).abs() <= bound;
            assert!(same, "{} {i}: {f} {e}", group.name());
        }
    }
}

#[test]
fn the_dead_go_where_the_cpu_sends_them_and_the_set_grows_as_there() {
    let Some(gpu) = device() else { return };
    for (n, count, degree) in [
        (200, 200, ShDegree::One),
        (200, 260, ShDegree::Zero),
        (255, 256, ShDegree::Zero),
        (3000, 3150, ShDegree::Three),
        (70_000, 73_500, ShDegree::Zero),
    ] {
        for seed in [5, 0xfedc_ba98_7654_3210] {
            // Growth starts from what relocation has left, corrected opacities included, so each is
            // compared by itself, on one state.
            let state = state(n, degree);
            let plan = DensifyPlan { seed, dead_opacity: 0.005, count: n as u32 };
            let relocated = densified(&gpu, &state, &plan, 0);
            assert_same(&relocated, &densified_on_cpu(&state, &plan));
            let plan = DensifyPlan { count, ..plan };
            let grown = densified(&gpu, &relocated, &plan, 0);
            assert_same(&grown, &densified_on_cpu(&relocated, &plan));
        }
    }
}

#[test]
fn a_splat_that_many_join_gets_the_correction_of_all_its_copies() {
    let Some(gpu) = device() else { return };
    // One living splat takes 99 dead ones, more than the correction is made for; then growth
    // brings a few to each.
    for logit in [-5.2f32, -2.0, 0.0, 3.0, 14.0, 30.0] {
        let mut state = state(40, ShDegree::Zero);
        state.splats.opacity_logits.fill(-9.0);
        state.splats.opacity_logits[17] = logit;
        state.splats.opacity_logits[23] = 1.0;
        let plan = DensifyPlan { seed: 2, dead_opacity: 0.005, count: 300 };
        let found = densified(&gpu, &state, &plan, 0);
        assert_same(&found, &densified_on_cpu(&state, &plan));
    }
}

#[test]
fn with_nothing_alive_nothing_moves_and_growth_still_reaches_its_count() {
    let Some(gpu) = device() else { return };
    let mut state = state(40, ShDegree::One);
    state.splats.opacity_logits.fill(f32::NEG_INFINITY);
    let plan = DensifyPlan { seed: 2, dead_opacity: 0.005, count: 60 };
    let found = densified(&gpu, &state, &plan, 0);
    let expected = densified_on_cpu(&state, &plan);
    assert_eq!(found.splats.positions, expected.splats.positions);
    assert_eq!(found.splats.len(), 60);
}

#[test]
fn no_splat_moves_while_frames_are_not_drawn() {
    let Some(gpu) = device() else { return };
    let state = state(300, ShDegree::One);
    let plan = DensifyPlan { seed: 2, dead_opacity: 0.005, count: 300 };
    let found = densified(&gpu, &state, &plan, 1);
    assert_eq!(found.splats.opacity_logits[10], state.splats.opacity_logits[10]);
    assert_eq!(found.first_moments, state.first_moments);
}
