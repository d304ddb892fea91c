// Products of matrices in single precision: a workgroup computes a tile of 128 × 128 of
// Σₖ left[k] ⊗ right[k].
//
// Needs: common/matrix_block. The stage's own file has store_row(row, column, value): what becomes of
// four neighbours in a row of the result.
//
// 256 threads, 16 × 16. Both factors pass through workgroup memory in steps of 16 along the sum
// (16 KiB, which every device has); the next step's are on their way, in registers, while one is
// multiplied. A thread computes 8 × 8 elements: per index of the sum it reads four vectors for 64
// multiply–adds. Its rows and columns are two runs of four, 64 apart, so that neighbours read
// neighbouring vectors.

/// Row k: elements of one factor at index k of the sum.
var<workgroup> left: array<vec4<f32>, 512>;
var<workgroup> right: array<vec4<f32>, 512>;

/// A thread's elements: row by row, eight columns each.
struct Tile {
    a0: vec4<f32>,
    b0: vec4<f32>,
    a1: vec4<f32>,
    b1: vec4<f32>,
    a2: vec4<f32>,
    b2: vec4<f32>,
    a3: vec4<f32>,
    b3: vec4<f32>,
    a4: vec4<f32>,
    b4: vec4<f32>,
    a5: vec4<f32>,
    b5: vec4<f32>,
    a6: vec4<f32>,
    b6: vec4<f32>,
    a7: vec4<f32>,
    b7: vec4<f32>,
    /// Σₖ of the rows that the thread has loaded.
    loaded: vec4<f32>,
}

/// Which block a thread loads. Threads in pairs are neighbours along the sum: where that is how the
/// factor lies in memory, they read 32 bytes.
fn loaded_block(thread: u32) -> vec2<u32> {
    let t = thread % 128u;
    return vec2<u32>((t / 2u) % 16u + 16u * (t / 64u), t % 2u + 2u * ((t / 32u) % 2u));
}

fn store_step(block: Block, thread: u32) {
    let place = loaded_block(thread);
    let at = 4u * place.y * TILE_VECTORS + place.x;
    if (thread < 128u) {
        left[at] = block.k0;
        left[at + TILE_VECTORS] = block.k1;
        left[at + 2u * TILE_VECTORS] = block.k2;
        left[at + 3u * TILE_VECTORS] = block.k3;
    } else {
        right[at] = block.k0;
        right[at + TILE_VECTORS] = block.k1;
        right[at + 2u * TILE_VECTORS] = block.k2;
        right[at + 3u * TILE_VECTORS] = block.k3;
    }
}

/// First vector of rows, and of columns, that a thread computes; the others are 16 vectors on.
fn tile_place(thread: u32) -> vec2<u32> {
    return vec2<u32>(thread / 16u, thread % 16u);
}

/// tile += the step in workgroup memory.
fn multiply_add(tile: ptr<function, Tile>, place: vec2<u32>) {
    for (var k = 0u; k < STEP; k++) {
        let l = left[k * TILE_VECTORS + place.x];
        let m = left[k * TILE_VECTORS + place.x + 16u];
        let a = right[k * TILE_VECTORS + place.y];
        let b = right[k * TILE_VECTORS + place.y + 16u];
        (*tile).a0 = fma(vec4<f32>(l.x), a, (*tile).a0);
        (*tile).b0 = fma(vec4<f32>(l.x), b, (*tile).b0);
        (*tile).a1 = fma(vec4<f32>(l.y), a, (*tile).a1);
        (*tile).b1 = fma(vec4<f32>(l.y), b, (*tile).b1);
        (*tile).a2 = fma(vec4<f32>(l.z), a, (*tile).a2);
        (*tile).b2 = fma(vec4<f32>(l.z), b, (*tile).b2);
        (*tile).a3 = fma(vec4<f32>(l.w), a, (*tile).a3);
        (*tile).b3 = fma(vec4<f32>(l.w), b, (*tile).b3);
        (*tile).a4 = fma(vec4<f32>(m.x), a, (*tile).a4);
        (*tile).b4 = fma(vec4<f32>(m.x), b, (*tile).b4);
        (*tile).a5 = fma(vec4<f32>(m.y), a, (*tile).a5);
        (*tile).b5 = fma(vec4<f32>(m.y), b, (*tile).b5);
        (*tile).a6 = fma(vec4<f32>(m.z), a, (*tile).a6);
        (*tile).b6 = fma(vec4<f32>(m.z), b, (*tile).b6);
        (*tile).a7 = fma(vec4<f32>(m.w), a, (*tile).a7);
        (*tile).b7 = fma(vec4<f32>(m.w), b, (*tile).b7);
    }
}

/// The thread's part of the tile, summed over the steps from `first` to before `end`: one at least.
fn product(first: u32, end: u32, thread: u32) -> Tile {
    let place = tile_place(thread);
    var tile = Tile();
    var next = load_step(first, thread);
    for (var step = first; step < end; step++) {
        workgroupBarrier();
        store_step(next, thread);
        workgroupBarrier();
        tile.loaded += (next.k0 + next.k1) + (next.k2 + next.k3);
        if (step + 1u < end) {
            next = load_step(step + 1u, thread);
        }
        multiply_add(&tile, place);
    }
    return tile;
}

/// Hands the thread's elements to the stage.
fn store_tile(tile: Tile, thread: u32) {
    let place = tile_place(thread);
    store_pair(4u * place.x, place.y, tile.a0, tile.b0);
    store_pair(4u * place.x + 1u, place.y, tile.a1, tile.b1);
    store_pair(4u * place.x + 2u, place.y, tile.a2, tile.b2);
    store_pair(4u * place.x + 3u, place.y, tile.a3, tile.b3);
    store_pair(4u * place.x + 64u, place.y, tile.a4, tile.b4);
    store_pair(4u * place.x + 65u, place.y, tile.a5, tile.b5);
    store_pair(4u * place.x + 66u, place.y, tile.a6, tile.b6);
    store_pair(4u * place.x + 67u, place.y, tile.a7, tile.b7);
}

fn store_pair(row: u32, column_vector: u32, first: vec4<f32>, second: vec4<f32>) {
    store_row(row, 4u * column_vector, first);
    store_row(row, 4u * column_vector + 64u, second);
}

/// Computes the tile, summed over the steps from `first` to before `end`, one at least, and hands it
/// to the stage. Returns Σₖ of the rows that the thread has loaded.
fn multiply(first: u32, end: u32, thread: u32) -> vec4<f32> {
    let tile = product(first, end, thread);
    store_tile(tile, thread);
    return tile.loaded;
}

/// Of each four rows of the left factor, in the first 32 threads, what the four threads with these
/// rows have loaded.
fn sum_of_rows(loaded: vec4<f32>, thread: u32) -> vec4<f32> {
    workgroupBarrier();
    let at = loaded_block(thread);
    if (thread < 128u) {
        left[4u * at.x + at.y] = loaded;
    }
    workgroupBarrier();
    let first = 4u * (thread % TILE_VECTORS);
    return (left[first] + left[first + 1u]) + (left[first + 2u] + left[first + 3u]);
}
