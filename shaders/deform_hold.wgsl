// Splats that rest: stored parameters → those of the splat with the outputs that it holds. No network.
//
// Needs: common/dispatch, common/numbers, common/rotation, common/exponential, common/network,
// common/deformed_parameters, common/deformed_splat.
//
// One thread per resting splat; the mirror is deform_hold_backward.wgsl.

/// The resting splats: their places in `order`.
@group(0) @binding(0) var<uniform> chunk: NetworkChunk;
@group(0) @binding(1) var<storage, read> order: array<u32>;
/// Ten outputs per resting splat: displacement, addition to the rotation, to the scales.
@group(0) @binding(2) var<storage, read> held: array<f32>;
@group(0) @binding(3) var<storage, read> positions: array<f32>;
@group(0) @binding(4) var<storage, read> log_scales: array<f32>;
@group(0) @binding(5) var<storage, read> rotations: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read_write> deformed_positions: array<f32>;
@group(0) @binding(7) var<storage, read_write> deformed_log_scales: array<f32>;
@group(0) @binding(8) var<storage, read_write> deformed_rotations: array<vec4<f32>>;

@compute @workgroup_size(64)
fn deform_hold(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let rank = flat_group(group, groups) * 64u + thread;
    if (rank >= chunk.splats) {
        return;
    }
    let splat = order[chunk.first + rank];
    let output = 10u * rank;
    for (var c = 0u; c < 3u; c++) {
        let at = 3u * splat + c;
        deformed_positions[at] = positions[at] + held[output + c];
        deformed_log_scales[at] = deformed_log_scale(log_scales[at], held[output + 7u + c]);
    }
    let d = vec4<f32>(held[output + 3u], held[output + 4u], held[output + 5u], held[output + 6u]);
    deformed_rotations[splat] = deformed_rotation(rotations[splat], d);
}
