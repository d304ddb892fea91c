// Exploration: positions wander in the shape of their splat where it is nearly transparent
// (Kheradmand et al. 2024, eq. 8). The twin is rust-core/train/src/densify/noise.rs.
//
// Needs: common/dispatch, common/counters, common/numbers, common/exponential, common/random,
// common/training.

@group(0) @binding(0) var<uniform> training: TrainingStep;
@group(0) @binding(1) var<storage, read_write> positions: array<f32>;
@group(0) @binding(2) var<storage, read> log_scales: array<f32>;
@group(0) @binding(3) var<storage, read> rotations: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> opacity_logits: array<f32>;
@group(0) @binding(5) var<storage, read> counts: array<u32>;

const MIN_NORMAL: f32 = 1.1754944e-38;

/// `v` turned by a quaternion (w, x, y, z) of any length; by none where the length is zero.
fn turned(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    let largest = max(max(abs(q.x), abs(q.y)), max(abs(q.z), abs(q.w)));
    // Divided by the largest component first: the square of 1e-20 is not a normal number.
    let scaled = q / max(largest, MIN_NORMAL);
    let factor = 2.0 / max(dot(scaled, scaled), MIN_NORMAL);
    let once = cross(scaled.yzw, v);
    return v + factor * (scaled.x * once + cross(scaled.yzw, once));
}

@compute @workgroup_size(256)
fn noise(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let i = flat_group(group, groups) * 256u + thread;
    if (i >= training.splats || counts[HALTED] != 0u) {
        return;
    }
    let logit = opacity_logits[i];
    let q = rotations[i];
    let scale = vec3<f32>(log_scales[3u * i], log_scales[3u * i + 1u], log_scales[3u * i + 2u]);
    let known = !is_nan(logit) && !(is_nan(scale.x) || is_nan(scale.y) || is_nan(scale.z))
        && is_finite(q.x) && is_finite(q.y) && is_finite(q.z) && is_finite(q.w);
    let open = logistic(training.gate_steepness * (training.gate_opacity - logistic(logit)));
    let amplitude = training.noise_amplitude * open;
    let words = random_words(training.seed, PURPOSE_NOISE, training.step, i);
    let along_axes = amplitude * vec3<f32>(
        exponential(2.0 * scale.x) * normal_number(words.x),
        exponential(2.0 * scale.y) * normal_number(words.y),
        exponential(2.0 * scale.z) * normal_number(words.z),
    );
    let position = vec3<f32>(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]);
    let moved = position + turned(q, along_axes);
    if (known && is_finite(moved.x) && is_finite(moved.y) && is_finite(moved.z)) {
        positions[3u * i] = moved.x;
        positions[3u * i + 1u] = moved.y;
        positions[3u * i + 2u] = moved.z;
    }
}
