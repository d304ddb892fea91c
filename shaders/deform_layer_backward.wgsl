// The mirror of deform_layer.wgsl by its input: ∂L/∂x = Wᵀ ∂L/∂y for a chunk of splats, through the
// ReLU that x came out of, and into the place of x.
//
// Needs: common/network, common/matrix_block, common/activation_block, common/weight_block, and
// common/matrix_tile or common/matrix_tile_split.
//
// A tile is 128 hidden inputs × 128 splats. γ, in front of them in one layer, gets no gradient. Only
// the thread that overwrites an element of x reads it.

@group(0) @binding(0) var<uniform> layer: NetworkLayer;
@group(0) @binding(1) var<storage, read> parameters: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> activations: array<vec4<f32>>;

/// First input and first column of the workgroup's tile.
var<private> first_input: u32;
var<private> first_column: u32;

/// Inputs: columns of W.
fn load_left(output: u32, row: u32) -> Block {
    let input = first_input + row;
    if (output >= layer.outputs || input >= layer.inputs) {
        return Block();
    }
    return weight_block(output, input);
}

/// Columns of the rows of ∂L/∂y.
fn load_right(output: u32, column: u32) -> Block {
    if (output >= layer.outputs) {
        return Block();
    }
    return activation_block(layer.output_row + output, first_column + column);
}

fn store_row(row: u32, column: u32, value: vec4<f32>) {
    let input = first_input + row;
    if (input >= layer.inputs) {
        return;
    }
    let at = (layer.input_row + input) * layer.row_vectors + (first_column + column) / 4u;
    activations[at] = select(vec4<f32>(0.0), value, activations[at] > vec4<f32>(0.0));
}

@compute @workgroup_size(256)
fn deform_layer_backward(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    first_input = layer.encoded_inputs + group.x * TILE;
    first_column = group.y * TILE;
    let steps = (layer.outputs + STEP - 1u) / STEP;
    multiply(0u, steps, thread);
}
