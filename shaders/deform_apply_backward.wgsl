// The mirror of deform_apply.wgsl: gradients by the deformed parameters of a chunk's splats →
// gradients by the canonical ones, in place, and by the network's outputs.
//
// Needs: common/dispatch, common/numbers, common/rotation, common/exponential, common/network,
// common/deformed_parameters, common/deformed_splat.
//
// One thread per column. Positions and displacements are added: their gradients are one. The way
// through γ is not followed (Deformable 3D Gaussians stops the gradient there).

@group(0) @binding(0) var<uniform> chunk: NetworkChunk;
/// The heads.
@group(0) @binding(1) var<uniform> layer: NetworkLayer;
@group(0) @binding(2) var<storage, read> log_scales: array<f32>;
@group(0) @binding(3) var<storage, read> rotations: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> deformed_log_scales: array<f32>;
@group(0) @binding(5) var<storage, read> by_positions: array<f32>;
@group(0) @binding(6) var<storage, read_write> by_log_scales: array<f32>;
@group(0) @binding(7) var<storage, read_write> by_rotations: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> activations: array<f32>;
@group(0) @binding(9) var<storage, read> order: array<u32>;

fn store_output(output: u32, column: u32, gradient: f32) {
    activations[(layer.output_row + output) * 4u * layer.row_vectors + column] = gradient;
}

@compute @workgroup_size(64)
fn deform_apply_backward(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let column = flat_group(group, groups) * 64u + thread;
    if (column >= 16u * chunk.steps) {
        return;
    }
    if (column >= chunk.splats) {
        for (var output = 0u; output < layer.outputs; output++) {
            store_output(output, column, 0.0);
        }
        return;
    }
    let splat = order[chunk.first + column];
    let by_rotation = by_rotations[splat];
    for (var c = 0u; c < 3u; c++) {
        let at = 3u * splat + c;
        store_output(c, column, by_positions[at]);
        let gradient = by_scale(by_log_scales[at], deformed_log_scales[at]);
        store_output(7u + c, column, gradient);
        by_log_scales[at] = gradient * exponential(log_scales[at]);
    }
    for (var c = 0u; c < 4u; c++) {
        store_output(3u + c, column, by_rotation[c]);
    }
    for (var output = 10u; output < layer.outputs; output++) {
        store_output(output, column, 0.0);
    }
    by_rotations[splat] = unit_backward(unit_rotation(rotations[splat]), by_rotation);
}
