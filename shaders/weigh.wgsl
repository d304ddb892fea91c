// What each splat weighs when places are drawn by opacity, and which are dead. The twin is
// rust-core/train/src/densify/sampling.rs.
//
// Needs: common/dispatch, common/numbers, common/scan, common/densification.
//
// One thread per splat. Weights are integers that depend on the bits of the logit alone, so both
// the weights and their sums are the CPU's.

@group(0) @binding(0) var<uniform> densification: Densification;
/// Opacity in units of 2⁻²³ at logits −16 … 16 in steps of 1/64, four to a vector.
@group(0) @binding(1) var<uniform> opacity_units: array<vec4<u32>, 513>;
@group(0) @binding(2) var<storage, read> positions: array<f32>;
@group(0) @binding(3) var<storage, read> log_scales: array<f32>;
@group(0) @binding(4) var<storage, read> rotations: array<f32>;
@group(0) @binding(5) var<storage, read> opacity_logits: array<f32>;
@group(0) @binding(6) var<storage, read> sh_dc: array<f32>;
@group(0) @binding(7) var<storage, read> sh_rest: array<f32>;
/// Sums of the weights over a block of 256 splats up to and including each.
@group(0) @binding(8) var<storage, read_write> sums: array<u32>;
/// Sums of whole blocks.
@group(0) @binding(9) var<storage, read_write> block_sums: array<u32>;
/// DEAD or NO_HOST.
@group(0) @binding(10) var<storage, read_write> hosts: array<u32>;

/// Numbers per splat in `sh_rest`.
override REST_WIDTH: u32 = 0u;

fn all_finite(splat: u32) -> bool {
    var finite = is_finite(opacity_logits[splat]);
    for (var c = 0u; c < 3u; c++) {
        let i = 3u * splat + c;
        finite = finite && is_finite(positions[i]) && is_finite(log_scales[i]) && is_finite(sh_dc[i]);
    }
    for (var c = 0u; c < 4u; c++) {
        finite = finite && is_finite(rotations[4u * splat + c]);
    }
    for (var c = 0u; c < REST_WIDTH; c++) {
        finite = finite && is_finite(sh_rest[REST_WIDTH * splat + c]);
    }
    return finite;
}

fn table_entry(i: u32) -> u32 {
    return opacity_units[i / 4u][i % 4u];
}

/// Opacity in units of 2⁻²³, interpolated; `logit` is finite.
fn units_of(logit: f32) -> u32 {
    let fixed = u32(i32(clamp(logit, -16.0, 16.0) * 16384.0) + 262144);
    let low = table_entry(fixed >> 8u);
    let high = table_entry((fixed >> 8u) + 1u);
    return low + (((high - low) * (fixed & 255u)) >> 8u);
}

@compute @workgroup_size(256)
fn weigh(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let block = flat_group(group, groups);
    let splat = block * 256u + thread;
    var weight = 0u;
    if (splat < densification.splats) {
        let logit = opacity_logits[splat];
        let alive = all_finite(splat) && logit > densification.dead_logit;
        hosts[splat] = select(DEAD, NO_HOST, alive);
        if (alive) {
            weight = units_of(logit) >> densification.shift;
        }
    }
    let sum = inclusive_scan(thread, weight);
    if (splat < densification.splats) {
        sums[splat] = sum;
    }
    if (thread == 255u && block * 256u < densification.splats) {
        block_sums[block] = sum;
    }
}
