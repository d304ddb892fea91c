// What a workgroup loads of the two factors of a product of matrices, in blocks of four by four: for
// common/matrix_tile.wgsl and common/matrix_tile_split.wgsl, which compute a tile of 128 × 128 of
// Σₖ left[k] ⊗ right[k].
//
// They have loaded_block(thread): which block of a step a thread loads, in vectors, along the tile (x)
// and along the sum (y). The stage's own file has two functions:
//   load_left(contraction, row), load_right(contraction, row): rows `row` … + 3 of the tile at the
//     indices `contraction` … + 3 of the sum; zeros where there is nothing.

/// Rows and columns of a tile.
const TILE: u32 = 128u;
/// Vectors in a row of a tile.
const TILE_VECTORS: u32 = 32u;
/// Indices of the sum in a step.
const STEP: u32 = 16u;

/// Four rows of a tile (components) at four indices of the sum.
struct Block {
    k0: vec4<f32>,
    k1: vec4<f32>,
    k2: vec4<f32>,
    k3: vec4<f32>,
}

/// The block of four vectors that were read along the sum, one per row of the tile.
fn transposed(rows: Block) -> Block {
    let columns = transpose(mat4x4<f32>(rows.k0, rows.k1, rows.k2, rows.k3));
    return Block(columns[0], columns[1], columns[2], columns[3]);
}

/// The block of a step that a thread loads: the first half of the threads load the left factor, the
/// others the right one.
fn load_step(step: u32, thread: u32) -> Block {
    let at = loaded_block(thread);
    let contraction = step * STEP + 4u * at.y;
    if (thread < 128u) {
        return load_left(contraction, 4u * at.x);
    }
    return load_right(contraction, 4u * at.x);
}
