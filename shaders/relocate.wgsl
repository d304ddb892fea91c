// Where dead and new splats go, and what becomes of the splats that they join (Kheradmand et al. 2024,
// §4.3, §4.4, eq. 9). The twins are rust-core/train/src/densify/relocation.rs and correction.rs.
//
// Needs: common/dispatch, common/counters, common/numbers, common/scan, common/exponential,
// common/random, common/densification.
//
// Runs after weigh.wgsl: `sum_blocks` (one workgroup) turns the sums of blocks into what lies before
// each, `draw` chooses a host for every dead or new splat, `correct` gives the hosts the opacity and
// the scale of one of the copies that will stand there.

@group(0) @binding(0) var<uniform> densification: Densification;
@group(0) @binding(1) var<storage, read> sums: array<u32>;
/// Sums of the weights before each block of 256 splats; behind the last block, of all.
@group(0) @binding(2) var<storage, read_write> block_sums: array<u32>;
@group(0) @binding(3) var<storage, read_write> hosts: array<u32>;
/// How often each splat was drawn.
@group(0) @binding(4) var<storage, read_write> copies: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> opacity_logits: array<f32>;
@group(0) @binding(6) var<storage, read_write> log_scales: array<f32>;
/// Counts of the last frame.
@group(0) @binding(7) var<storage, read> counts: array<u32>;

@compute @workgroup_size(256)
fn sum_blocks(@builtin(local_invocation_index) thread: u32) {
    let blocks = divide_up(densification.splats, 256u);
    var before = 0u;
    for (var first = 0u; first < blocks; first += SCAN_WIDTH) {
        let block = first + thread;
        var own = 0u;
        if (block < blocks) {
            own = block_sums[block];
        }
        let sum = inclusive_scan(thread, own);
        if (block < blocks) {
            block_sums[block] = before + sum - own;
        }
        before += scan_values[255];
        scan_barrier();
    }
    if (thread == 0u) {
        block_sums[blocks] = before;
    }
}

/// The first splat whose sum is above `below`.
fn first_above(below: u32) -> u32 {
    var first = 0u;
    var end = densification.splats;
    while (first < end) {
        let middle = first + (end - first) / 2u;
        if (block_sums[middle / 256u] + sums[middle] <= below) {
            first = middle + 1u;
        } else {
            end = middle;
        }
    }
    return first;
}

@compute @workgroup_size(256)
fn draw(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let i = flat_group(group, groups) * 256u + thread;
    if (i >= densification.count) {
        return;
    }
    var wants_host = i >= densification.splats;
    if (densification.purpose == PURPOSE_RELOCATION) {
        wants_host = hosts[i] == DEAD;
    }
    var host = NO_HOST;
    if (wants_host && counts[HALTED] == 0u) {
        let word = random_words(densification.seed, densification.purpose, densification.step, i).x;
        let total = block_sums[divide_up(densification.splats, 256u)];
        if (total > 0u) {
            host = first_above(multiply_high(word, total));
        } else if (densification.even_weight > 0u) {
            let even = densification.even_weight;
            host = multiply_high(word, densification.splats * even) / even;
        }
        if (host != NO_HOST) {
            atomicAdd(&copies[host], 1u);
        }
    }
    hosts[i] = host;
}

/// Most copies that the correction is made for.
const MAX_COPIES: u32 = 51u;
/// Logit of the largest opacity of the correction, 1 − 2⁻²³.
const MAX_LOGIT: f32 = 15.942385;
/// Its exponential is a normal number, and so is a 51st of it.
const MIN_LOGIT: f32 = -80.0;
const SQRT_TAU: f32 = 2.5066283;

/// ln(1 + u) for u in [0, 1], relatively accurate: 2 atanh(u / (2 + u)).
fn log_one_plus(u: f32) -> f32 {
    let s = u / (2.0 + u);
    let s2 = s * s;
    var series = 1.0 / 15.0;
    series = series * s2 + 1.0 / 13.0;
    series = series * s2 + 1.0 / 11.0;
    series = series * s2 + 1.0 / 9.0;
    series = series * s2 + 1.0 / 7.0;
    series = series * s2 + 1.0 / 5.0;
    series = series * s2 + 1.0 / 3.0;
    return 2.0 * s * (1.0 + series * s2);
}

/// 1 − e⁻ᵗ for t > 0, relatively accurate.
fn one_minus_exponential(t: f32) -> f32 {
    if (t > 0.5) {
        return 1.0 - exponential(-t);
    }
    var series = 1.0 - t / 9.0;
    series = 1.0 - t / 8.0 * series;
    series = 1.0 - t / 7.0 * series;
    series = 1.0 - t / 6.0 * series;
    series = 1.0 - t / 5.0 * series;
    series = 1.0 - t / 4.0 * series;
    series = 1.0 - t / 3.0 * series;
    return t * (1.0 - t / 2.0 * series);
}

/// 1 − (1 − a)ⁿ by doubling: every term is positive, so nothing cancels.
fn share_of_copies(a: f32, n: u32) -> f32 {
    var share = 0.0;
    for (var bit = 32u; bit > 0u; bit /= 2u) {
        share = share * (2.0 - share);
        if ((n & bit) != 0u) {
            share += a * (1.0 - share);
        }
    }
    return share;
}

/// ∫ 1 − (1 − o e^(−x²/2))ⁿ dx by the trapezoidal rule, whose error at this step is below 1e-10.
fn profile_of_copies(opacity: f32, n: u32) -> f32 {
    const STEP: f32 = 0.125;
    var sum = 0.0;
    for (var k = 52u; k > 0u; k--) {
        let x = f32(k) * STEP;
        sum += share_of_copies(opacity * exponential(-0.5 * x * x), n);
    }
    return STEP * (share_of_copies(opacity, n) + 2.0 * sum);
}

@compute @workgroup_size(256)
fn correct(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let i = flat_group(group, groups) * 256u + thread;
    if (i >= densification.splats) {
        return;
    }
    let drawn = atomicLoad(&copies[i]);
    if (drawn == 0u) {
        return;
    }
    let n = min(drawn + 1u, MAX_COPIES);
    let logit = opacity_logits[i];
    if (is_nan(logit)) {
        opacity_logits[i] = densification.lowest_logit;
        return;
    }
    let x = clamp(logit, MIN_LOGIT, MAX_LOGIT);
    // −ln(1 − o) / n; then o′ = 1 − e⁻ᵗ, and its logit is ln(eᵗ − 1).
    let t = (max(x, 0.0) + log_one_plus(exponential(-abs(x)))) / f32(n);
    let opacity = one_minus_exponential(t);
    let scale = logistic(x) * SQRT_TAU / profile_of_copies(opacity, n);
    opacity_logits[i] = max(t + natural_log(opacity), densification.lowest_logit);
    let log_scale = natural_log(scale);
    for (var axis = 0u; axis < 3u; axis++) {
        log_scales[3u * i + axis] += log_scale;
    }
}
