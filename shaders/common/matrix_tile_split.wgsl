// Products of matrices on cooperative matrices (tensor cores), to the accuracy of single precision but
// for a digit: what common/matrix_tile.wgsl does, with each factor as the sum of two halves.
//
// Needs: common/matrix_block. The stage's own files have store_row(row, column, value), what becomes of
// four neighbours in a row of the result; factor_scales(first, end, thread), powers of two that bring
// both factors into the range of halves; and limited_right(value), which keeps the right one there.
//
// x = h + l, h = x rounded to 11 bits and l = x − h rounded to 11 more, is x to 2⁻²²; of (h + l)(h' + l')
// all but l l' is computed, which is 2⁻²² of it, and summed in 32 bits (Markidis et al. 2018; Ootomo and
// Yokota 2022). A factor that the scales leave beyond 65 504 becomes no number, and so does the sum.
//
// 256 threads, eight subgroups of 32; each computes 32 × 64 elements as 2 × 4 tiles of 16 × 16, in 24
// products for 12 loads a step. Factors pass through workgroup memory as in common/matrix_tile.wgsl.

/// Vectors of four halves from one row of a factor to the next. 12 words, so that the eight rows that
/// are read together lie in different ones of the 32 banks of workgroup memory.
const SPLIT_STRIDE: u32 = 6u;
/// Vectors of sixteen rows.
const TILE_OF_ROWS: u32 = 96u;
/// Vectors of two tiles of sums, 16 × 32.
const SUMS: u32 = 128u;

/// A step of both factors, high and low parts: row by row, along the sum.
var<workgroup> left_high: array<vec4<f16>, 768>;
var<workgroup> left_low: array<vec4<f16>, 768>;
var<workgroup> right_high: array<vec4<f16>, 768>;
var<workgroup> right_low: array<vec4<f16>, 768>;
/// Two tiles of sums for each subgroup, on their way to the stage.
var<workgroup> sums: array<vec4<f32>, 1024>;

/// A number rounded to the 11 bits of a half, by its bits: what a compiler makes of x − f32(f16(x)) may
/// be zero.
fn high_part(value: vec4<f32>) -> vec4<f32> {
    let bits = bitcast<vec4<u32>>(value) + vec4<u32>(0x1000u);
    return bitcast<vec4<f32>>(bits & vec4<u32>(0xffffe000u));
}

fn store_left(at: u32, value: vec4<f32>) {
    let high = high_part(value);
    left_high[at] = vec4<f16>(high);
    left_low[at] = vec4<f16>(value - high);
}

fn store_right(at: u32, value: vec4<f32>) {
    let high = high_part(value);
    right_high[at] = vec4<f16>(high);
    right_low[at] = vec4<f16>(value - high);
}

/// Which block a thread loads: four neighbours along the sum, eight along the tile, so that neighbours
/// read 64 bytes or 128, whichever way the factor lies in memory.
fn loaded_block(thread: u32) -> vec2<u32> {
    let t = thread % 128u;
    return vec2<u32>(t / 4u, t % 4u);
}

fn store_step(block: Block, scales: vec2<f32>, thread: u32) {
    let place = loaded_block(thread);
    let at = 4u * place.x * SPLIT_STRIDE + place.y;
    let rows = transposed(block);
    if (thread < 128u) {
        store_left(at, scales.x * rows.k0);
        store_left(at + SPLIT_STRIDE, scales.x * rows.k1);
        store_left(at + 2u * SPLIT_STRIDE, scales.x * rows.k2);
        store_left(at + 3u * SPLIT_STRIDE, scales.x * rows.k3);
    } else {
        store_right(at, scales.y * limited_right(rows.k0));
        store_right(at + SPLIT_STRIDE, scales.y * limited_right(rows.k1));
        store_right(at + 2u * SPLIT_STRIDE, scales.y * limited_right(rows.k2));
        store_right(at + 3u * SPLIT_STRIDE, scales.y * limited_right(rows.k3));
    }
}

/// Hands two tiles of the subgroup, side by side from `row` and `column`, to the stage: eight
/// neighbouring threads have a row of 32.
fn store_sums(row: u32, column: u32, unscale: f32, thread: u32) {
    let lane = thread % 32u;
    for (var i = 0u; i < 4u; i++) {
        let tile_row = lane / 8u + 4u * i;
        let vector = lane % 8u;
        let sum = sums[thread / 32u * SUMS + 8u * tile_row + vector];
        store_row(row + tile_row, column + 4u * vector, unscale * sum);
    }
}

/// Computes the tile, summed over the steps from `first` to before `end`, one at least, and hands it
/// to the stage. Returns Σₖ of the rows that the thread has loaded.
fn multiply(first: u32, end: u32, thread: u32) -> vec4<f32> {
    let group = thread / 32u;
    let row = 32u * (group % 4u);
    let column = 64u * (group / 4u);
    let left_at = row * SPLIT_STRIDE;
    let right_at = column * SPLIT_STRIDE;
    let scales = factor_scales(first, end, thread);
    var c00 = coop_mat16x16<f32, C>();
    var c01 = coop_mat16x16<f32, C>();
    var c02 = coop_mat16x16<f32, C>();
    var c03 = coop_mat16x16<f32, C>();
    var c10 = coop_mat16x16<f32, C>();
    var c11 = coop_mat16x16<f32, C>();
    var c12 = coop_mat16x16<f32, C>();
    var c13 = coop_mat16x16<f32, C>();
    var loaded = vec4<f32>(0.0);
    var next = load_step(first, thread);
    for (var step = first; step < end; step++) {
        workgroupBarrier();
        store_step(next, scales, thread);
        workgroupBarrier();
        loaded += (next.k0 + next.k1) + (next.k2 + next.k3);
        if (step + 1u < end) {
            next = load_step(step + 1u, thread);
        }
        let h0 = coopLoadT<coop_mat16x16<f16, A>>(&left_high[left_at], SPLIT_STRIDE);
        let l0 = coopLoadT<coop_mat16x16<f16, A>>(&left_low[left_at], SPLIT_STRIDE);
        let h1 = coopLoadT<coop_mat16x16<f16, A>>(&left_high[left_at + TILE_OF_ROWS], SPLIT_STRIDE);
        let l1 = coopLoadT<coop_mat16x16<f16, A>>(&left_low[left_at + TILE_OF_ROWS], SPLIT_STRIDE);
        let g0 = coopLoad<coop_mat16x16<f16, B>>(&right_high[right_at], SPLIT_STRIDE);
        let m0 = coopLoad<coop_mat16x16<f16, B>>(&right_low[right_at], SPLIT_STRIDE);
        c00 = coopMultiplyAdd(h0, g0, coopMultiplyAdd(h0, m0, coopMultiplyAdd(l0, g0, c00)));
        c10 = coopMultiplyAdd(h1, g0, coopMultiplyAdd(h1, m0, coopMultiplyAdd(l1, g0, c10)));
        let g1 = coopLoad<coop_mat16x16<f16, B>>(&right_high[right_at + TILE_OF_ROWS], SPLIT_STRIDE);
        let m1 = coopLoad<coop_mat16x16<f16, B>>(&right_low[right_at + TILE_OF_ROWS], SPLIT_STRIDE);
        c01 = coopMultiplyAdd(h0, g1, coopMultiplyAdd(h0, m1, coopMultiplyAdd(l0, g1, c01)));
        c11 = coopMultiplyAdd(h1, g1, coopMultiplyAdd(h1, m1, coopMultiplyAdd(l1, g1, c11)));
        let g2 = coopLoad<coop_mat16x16<f16, B>>(&right_high[right_at + 2u * TILE_OF_ROWS], SPLIT_STRIDE);
        let m2 = coopLoad<coop_mat16x16<f16, B>>(&right_low[right_at + 2u * TILE_OF_ROWS], SPLIT_STRIDE);
        c02 = coopMultiplyAdd(h0, g2, coopMultiplyAdd(h0, m2, coopMultiplyAdd(l0, g2, c02)));
        c12 = coopMultiplyAdd(h1, g2, coopMultiplyAdd(h1, m2, coopMultiplyAdd(l1, g2, c12)));
        let g3 = coopLoad<coop_mat16x16<f16, B>>(&right_high[right_at + 3u * TILE_OF_ROWS], SPLIT_STRIDE);
        let m3 = coopLoad<coop_mat16x16<f16, B>>(&right_low[right_at + 3u * TILE_OF_ROWS], SPLIT_STRIDE);
        c03 = coopMultiplyAdd(h0, g3, coopMultiplyAdd(h0, m3, coopMultiplyAdd(l0, g3, c03)));
        c13 = coopMultiplyAdd(h1, g3, coopMultiplyAdd(h1, m3, coopMultiplyAdd(l1, g3, c13)));
    }
    let unscale = 1.0 / (scales.x * scales.y);
    let at = group * SUMS;
    workgroupBarrier();
    coopStoreT(c00, &sums[at], 8u);
    coopStoreT(c01, &sums[at + 4u], 8u);
    workgroupBarrier();
    store_sums(row, column, unscale, thread);
    workgroupBarrier();
    coopStoreT(c02, &sums[at], 8u);
    coopStoreT(c03, &sums[at + 4u], 8u);
    workgroupBarrier();
    store_sums(row, column + 32u, unscale, thread);
    workgroupBarrier();
    coopStoreT(c10, &sums[at], 8u);
    coopStoreT(c11, &sums[at + 4u], 8u);
    workgroupBarrier();
    store_sums(row + 16u, column, unscale, thread);
    workgroupBarrier();
    coopStoreT(c12, &sums[at], 8u);
    coopStoreT(c13, &sums[at + 4u], 8u);
    workgroupBarrier();
    store_sums(row + 16u, column + 32u, unscale, thread);
    return loaded;
}

/// Of each four rows of the left factor, in the first 32 threads, what the four threads with these
/// rows have loaded.
fn sum_of_rows(loaded: vec4<f32>, thread: u32) -> vec4<f32> {
    workgroupBarrier();
    let place = loaded_block(thread);
    if (thread < 128u) {
        sums[4u * place.x + place.y] = loaded;
    }
    workgroupBarrier();
    let first = 4u * (thread % TILE_VECTORS);
    return (sums[first] + sums[first + 1u]) + (sums[first + 2u] + sums[first + 3u]);
}
