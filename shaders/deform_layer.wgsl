// A hidden layer of the deformation network under training: y = ReLU(W x + b) for a chunk of splats.
//
// Needs: common/network, common/matrix_block, common/activation_block, common/weight_block, and
// common/matrix_tile or common/matrix_tile_split.
//
// A tile is 128 outputs × 128 splats; groups.x counts through the outputs, groups.y through the
// splats.

@group(0) @binding(0) var<uniform> layer: NetworkLayer;
@group(0) @binding(1) var<storage, read> parameters: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> activations: array<vec4<f32>>;

/// First output and first column of the workgroup's tile.
var<private> first_output: u32;
var<private> first_column: u32;

/// Outputs: rows of W.
fn load_left(input: u32, row: u32) -> Block {
    let output = first_output + row;
    if (input >= layer.inputs || output >= layer.outputs) {
        return Block();
    }
    return transposed(weight_block(output, input));
}

/// Columns of the input's rows.
fn load_right(input: u32, column: u32) -> Block {
    if (input >= layer.inputs) {
        return Block();
    }
    return activation_block(layer.input_row + input, first_column + column);
}

fn store_row(row: u32, column: u32, value: vec4<f32>) {
    let output = first_output + row;
    if (output >= layer.outputs) {
        return;
    }
    let bias = parameters[layer.weights + (layer.outputs * layer.inputs + output) / 4u][output % 4u];
    let at = (layer.output_row + output) * layer.row_vectors + (first_column + column) / 4u;
    activations[at] = max(value + bias, vec4<f32>(0.0));
}

@compute @workgroup_size(256)
fn deform_layer(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    first_output = group.x * TILE;
    first_column = group.y * TILE;
    let steps = (layer.inputs + STEP - 1u) / STEP;
    multiply(0u, steps, thread);
}
