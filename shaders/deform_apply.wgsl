// The heads of the network under training, and what their outputs do to the splats of a chunk: stored
// parameters → stored parameters of the deformed splats, which the renderer's kernels take as they
// take any others.
//
// Needs: common/dispatch, common/numbers, common/rotation, common/exponential, common/network,
// common/deformed_parameters, common/deformed_splat.
//
// One thread per splat: x + d; normalise(q) + d_q, which the projection normalises; ln(eˡ + d_s).
// Ten outputs are too few for a tile of common/matrix_tile.wgsl.

@group(0) @binding(0) var<uniform> chunk: NetworkChunk;
/// The heads.
@group(0) @binding(1) var<uniform> layer: NetworkLayer;
@group(0) @binding(2) var<storage, read> parameters: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> activations: array<f32>;
@group(0) @binding(4) var<storage, read> positions: array<f32>;
@group(0) @binding(5) var<storage, read> log_scales: array<f32>;
@group(0) @binding(6) var<storage, read> rotations: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> deformed_positions: array<f32>;
@group(0) @binding(8) var<storage, read_write> deformed_log_scales: array<f32>;
@group(0) @binding(9) var<storage, read_write> deformed_rotations: array<vec4<f32>>;
/// Splats that the network moves, by column; those that rest follow.
@group(0) @binding(10) var<storage, read> order: array<u32>;

/// W[output] · h, for four inputs.
fn part_of_output(output: u32, vector: u32, h: vec4<f32>) -> f32 {
    return dot(parameters[layer.weights + output * (layer.inputs / 4u) + vector], h);
}

@compute @workgroup_size(64)
fn deform_apply(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let column = flat_group(group, groups) * 64u + thread;
    if (column >= chunk.splats) {
        return;
    }
    let biases = layer.weights + layer.outputs * layer.inputs / 4u;
    var first = parameters[biases];
    var second = parameters[biases + 1u];
    var third = parameters[biases + 2u].xy;
    let stride = 4u * layer.row_vectors;
    for (var vector = 0u; vector < layer.inputs / 4u; vector++) {
        let at = (layer.input_row + 4u * vector) * stride + column;
        let h = vec4<f32>(
            activations[at],
            activations[at + stride],
            activations[at + 2u * stride],
            activations[at + 3u * stride],
        );
        first += vec4<f32>(
            part_of_output(0u, vector, h),
            part_of_output(1u, vector, h),
            part_of_output(2u, vector, h),
            part_of_output(3u, vector, h),
        );
        second += vec4<f32>(
            part_of_output(4u, vector, h),
            part_of_output(5u, vector, h),
            part_of_output(6u, vector, h),
            part_of_output(7u, vector, h),
        );
        third += vec2<f32>(part_of_output(8u, vector, h), part_of_output(9u, vector, h));
    }
    let splat = order[chunk.first + column];
    let at = 3u * splat;
    deformed_positions[at] = positions[at] + first.x;
    deformed_positions[at + 1u] = positions[at + 1u] + first.y;
    deformed_positions[at + 2u] = positions[at + 2u] + first.z;
    let d_rotation = vec4<f32>(first.w, second.xyz);
    deformed_rotations[splat] = deformed_rotation(rotations[splat], d_rotation);
    deformed_log_scales[at] = deformed_log_scale(log_scales[at], second.w);
    deformed_log_scales[at + 1u] = deformed_log_scale(log_scales[at + 1u], third.x);
    deformed_log_scales[at + 2u] = deformed_log_scale(log_scales[at + 2u], third.y);
}
