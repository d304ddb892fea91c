// The mirror of deform_hold.wgsl: gradients by the deformed parameters of resting splats → gradients by
// the canonical ones, in place. Nothing goes to the network.
//
// Needs: common/dispatch, common/numbers, common/rotation, common/exponential, common/network,
// common/deformed_parameters, common/deformed_splat.
//
// One thread per resting splat. Positions and displacements are added: their gradients are one.

@group(0) @binding(0) var<uniform> chunk: NetworkChunk;
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> log_scales: array<f32>;
@group(0) @binding(3) var<storage, read> rotations: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> deformed_log_scales: array<f32>;
@group(0) @binding(5) var<storage, read_write> by_log_scales: array<f32>;
@group(0) @binding(6) var<storage, read_write> by_rotations: array<vec4<f32>>;

@compute @workgroup_size(64)
fn deform_hold_backward(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let rank = flat_group(group, groups) * 64u + thread;
    if (rank >= chunk.splats) {
        return;
    }
    let splat = order[chunk.first + rank];
    for (var c = 0u; c < 3u; c++) {
        let at = 3u * splat + c;
        let gradient = by_scale(by_log_scales[at], deformed_log_scales[at]);
        by_log_scales[at] = gradient * exponential(log_scales[at]);
    }
    by_rotations[splat] = unit_backward(unit_rotation(rotations[splat]), by_rotations[splat]);
}
