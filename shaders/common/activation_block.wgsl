// What the products of the deformation network under training read of its activations.
//
// Needs: common/network, common/matrix_block; of the stage: `layer`, `activations`.

/// Rows `row` … + 3 at the columns `column` … + 3.
fn activation_block(row: u32, column: u32) -> Block {
    let stride = layer.row_vectors;
    let at = row * stride + column / 4u;
    return Block(
        activations[at],
        activations[at + stride],
        activations[at + 2u * stride],
        activations[at + 3u * stride],
    );
}
