// The mirror of deform_layer.wgsl by its parameters: ∂L/∂W = Σ ∂L/∂y ⊗ x and ∂L/∂b = Σ ∂L/∂y over
// the splats of a chunk, in parts that deform_weights_sum.wgsl adds up in a fixed order.
//
// Needs: common/network, common/matrix_block, common/activation_block, and common/matrix_tile or
// common/matrix_tile_split.
//
// A tile is 128 outputs × 128 inputs; groups.x counts through the tiles, groups.y through the parts
// of the sum: a layer has at most a handful of tiles, far fewer than a GPU has cores.

@group(0) @binding(0) var<uniform> chunk: NetworkChunk;
@group(0) @binding(1) var<uniform> layer: NetworkLayer;
@group(0) @binding(2) var<storage, read> activations: array<vec4<f32>>;
/// Part by part, the gradient by W and then that by b.
@group(0) @binding(3) var<storage, read_write> parts: array<vec4<f32>>;

/// First output and first input of the workgroup's tile.
var<private> first_output: u32;
var<private> first_input: u32;
/// Where the workgroup's part starts.
var<private> first_vector: u32;

/// Outputs: rows of ∂L/∂y.
fn load_left(column: u32, row: u32) -> Block {
    let output = first_output + row;
    if (output >= layer.outputs) {
        return Block();
    }
    return transposed(activation_block(layer.output_row + output, column));
}

/// Inputs: rows of x.
fn load_right(column: u32, row: u32) -> Block {
    let input = first_input + row;
    if (input >= layer.inputs) {
        return Block();
    }
    return transposed(activation_block(layer.input_row + input, column));
}

fn store_row(row: u32, column: u32, value: vec4<f32>) {
    let output = first_output + row;
    let input = first_input + column;
    if (output < layer.outputs && input < layer.inputs) {
        parts[first_vector + (output * layer.inputs + input) / 4u] = value;
    }
}

/// ∂L/∂b is the sum of the rows of ∂L/∂y.
fn store_bias(loaded: vec4<f32>, thread: u32) {
    let sum = sum_of_rows(loaded, thread);
    let output = first_output + 4u * thread;
    if (thread < TILE_VECTORS && output < layer.outputs) {
        parts[first_vector + (layer.outputs * layer.inputs + output) / 4u] = sum;
    }
}

@compute @workgroup_size(256)
fn deform_weights_backward(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let input_tiles = (layer.inputs + TILE - 1u) / TILE;
    first_output = group.x / input_tiles * TILE;
    first_input = group.x % input_tiles * TILE;
    first_vector = group.y * (layer.outputs * layer.inputs + layer.outputs) / 4u;
    let count = sum_parts(chunk.steps, layer.most_parts);
    let first_step = chunk.steps * group.y / count;
    let loaded = multiply(first_step, chunk.steps * (group.y + 1u) / count, thread);
    if (group.x % input_tiles == 0u) {
        store_bias(loaded, thread);
    }
}
