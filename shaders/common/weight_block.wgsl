// What the products of the deformation network under training read of its weights.
//
// Needs: common/network, common/matrix_block; of the stage: `layer`, `parameters`.

/// Rows `output` … + 3 of W at the columns `input` … + 3.
fn weight_block(output: u32, input: u32) -> Block {
    let stride = layer.inputs / 4u;
    let at = layer.weights + output * stride + input / 4u;
    return Block(
        parameters[at],
        parameters[at + stride],
        parameters[at + 2u * stride],
        parameters[at + 3u * stride],
    );
}
