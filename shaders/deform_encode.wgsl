// γ of a chunk of splats under training: [γ(xyz), γ(t)], a row per feature.
//
// Needs: common/dispatch, common/numbers, common/trigonometry, common/network.
//
// One thread per column. Always in single precision with our own sine (common/trigonometry.wgsl).
// A splat whose position is not a number is not drawn; it gets zeros, or it would be in every weight.

@group(0) @binding(0) var<uniform> chunk: NetworkChunk;
@group(0) @binding(1) var<storage, read> positions: array<f32>;
@group(0) @binding(2) var<storage, read_write> activations: array<f32>;
/// Splats that the network moves, by column.
@group(0) @binding(3) var<storage, read> order: array<u32>;

fn store_feature(feature: u32, column: u32, value: f32) {
    activations[(chunk.encoding_row + feature) * 4u * chunk.row_vectors + column] = value;
}

@compute @workgroup_size(64)
fn deform_encode(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let column = flat_group(group, groups) * 64u + thread;
    if (column >= 16u * chunk.steps) {
        return;
    }
    var position = vec3<f32>(0.0);
    var is_known = false;
    if (column < chunk.splats) {
        let at = 3u * order[chunk.first + column];
        position = vec3<f32>(positions[at], positions[at + 1u], positions[at + 2u]);
        is_known = is_finite(position.x) && is_finite(position.y) && is_finite(position.z);
    }
    let present = select(0.0, 1.0, is_known);
    for (var axis = 0u; axis < 3u; axis++) {
        let coordinate = select(0.0, position[axis], is_known);
        store_feature(axis, column, coordinate);
        let turns = turns_of(coordinate);
        for (var octave = 0u; octave < chunk.octaves; octave++) {
            let wave = sin_cos_of_turns(turns, f32(1u << octave), 0.0);
            store_feature(3u + 6u * octave + axis, column, present * wave.x);
            store_feature(6u + 6u * octave + axis, column, present * wave.y);
        }
    }
    let after = 3u + 6u * chunk.octaves;
    for (var feature = 0u; feature < chunk.time_features; feature++) {
        store_feature(after + feature, column, present * chunk.time[feature / 4u][feature % 4u]);
    }
}
