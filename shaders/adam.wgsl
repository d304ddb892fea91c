// One step of Adam (Kingma and Ba 2015) on one group of parameters, the regularisers' gradient
// included. The twin is rust-core/train/src/optimizer.
//
// Needs: common/dispatch, common/counters, common/numbers, common/exponential, common/training.
//
// One thread per number. A number whose gradient or new value is not finite, or whose squared
// gradient overflows, keeps its value and its moments, and is counted.

@group(0) @binding(0) var<uniform> training: TrainingStep;
@group(0) @binding(1) var<storage, read_write> parameters: array<f32>;
@group(0) @binding(2) var<storage, read> gradients: array<f32>;
@group(0) @binding(3) var<storage, read_write> first_moments: array<f32>;
@group(0) @binding(4) var<storage, read_write> second_moments: array<f32>;
@group(0) @binding(5) var<storage, read_write> reports: array<atomic<u32>>;
/// Counts of the frame.
@group(0) @binding(6) var<storage, read> counts: array<u32>;

/// Which group, in the order of the arrays.
override GROUP: u32 = 0u;
/// Numbers per splat.
override WIDTH: u32 = 1u;

const LOG_SCALES: u32 = 1u;
const OPACITY_LOGITS: u32 = 3u;
/// Root of the largest float.
const MAX_ROOT: f32 = 1.8446743e19;

fn pressure(parameter: f32) -> f32 {
    if (GROUP == OPACITY_LOGITS) {
        // σ(x)·σ(−x) has no cancellation near σ = 1.
        return training.opacity_pressure * (logistic(parameter) * logistic(-parameter));
    }
    if (GROUP == LOG_SCALES) {
        return training.scale_pressure * exponential(parameter);
    }
    return 0.0;
}

@compute @workgroup_size(256)
fn adam(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let i = flat_group(group, groups) * 256u + thread;
    if (i >= training.splats * WIDTH || counts[HALTED] != 0u) {
        return;
    }
    let parameter = parameters[i];
    let stored = gradients[i];
    let gradient = stored + pressure(parameter);
    let mean = training.beta1 * first_moments[i] + training.one_minus_beta1 * gradient;
    let square =
        training.beta2 * second_moments[i] + training.one_minus_beta2 * (gradient * gradient);
    let rate = training.rates[GROUP / 4u][GROUP % 4u];
    let moved = parameter
        - rate * mean / (sqrt(square) * training.second_correction + training.epsilon);
    let usable = is_finite(parameter) && is_finite(stored) && abs(gradient) <= MAX_ROOT
        && is_finite(square) && is_finite(moved);
    if (usable) {
        parameters[i] = moved;
        first_moments[i] = mean;
        second_moments[i] = square;
    } else {
        atomicAdd(&reports[report_word(training.slot, REPORT_NOT_FINITE)], 1u);
    }
}
