// Stage 1, second part: the deformation network, fused, in single precision or with weights and
// hidden vectors in half precision.
//
// Needs: common/dispatch, common/counters, common/frame, common/numbers, common/trigonometry,
// common/deformation, common/deform_splat, and common/hidden_single or common/hidden_half.
//
// A workgroup evaluates SPLATS splats. The hidden vectors stay in workgroup memory, feature-major:
// row k holds feature k of all splats. A thread computes 4 features of 16 splats; per row of
// weights it reads one vec4 of weights and four vec4 of features, the same ones as its neighbours,
// for 64 multiply–adds. Layers
// overwrite the hidden vectors in place, between barriers. The part of the input that depends on
// the time alone is in the biases of layer 0 and of the skip layer, computed once per frame in
// double precision; γ(xyz) is encoded again for the skip layer, which is cheaper than keeping it.

@group(0) @binding(0) var<uniform> deformation: Deformation;
@group(0) @binding(1) var<storage, read> canonical_poses: array<Pose>;
@group(0) @binding(2) var<storage, read_write> poses: array<Pose>;
@group(0) @binding(3) var<storage, read> dynamic_splats: array<u32>;
@group(0) @binding(4) var<storage, read> counts: array<u32>;
/// Rows of WIDTH weights, one per input feature: layer after layer; the skip layer's rows for h
/// before those for γ(xyz). Then WIDTH rows of 16 for the heads.
@group(0) @binding(5) var<storage, read> weights: array<Stored>;
/// WIDTH biases per layer, then 16 for the heads.
@group(0) @binding(6) var<storage, read> biases: array<vec4<f32>>;

/// Width of the hidden layers, padded with zeros to a multiple of 64.
override WIDTH: u32 = 256u;
/// Splats per workgroup.
override SPLATS: u32 = 16u;
/// WIDTH / 4 · SPLATS / 16.
override THREADS: u32 = 64u;
/// max(WIDTH, input rows) · SPLATS / 4.
override HIDDEN_VECTORS: u32 = 1024u;

/// Four features of sixteen splats.
struct Block {
    s0: vec4<f32>,
    s1: vec4<f32>,
    s2: vec4<f32>,
    s3: vec4<f32>,
    s4: vec4<f32>,
    s5: vec4<f32>,
    s6: vec4<f32>,
    s7: vec4<f32>,
    s8: vec4<f32>,
    s9: vec4<f32>,
    s10: vec4<f32>,
    s11: vec4<f32>,
    s12: vec4<f32>,
    s13: vec4<f32>,
    s14: vec4<f32>,
    s15: vec4<f32>,
}

/// γ of the group's positions into the first rows; rows up to `input_rows` are filled with zeros.
fn encode(first: u32, thread: u32) {
    let quads = SPLATS / 4u;
    let waves = 3u * deformation.octaves;
    for (var task = thread; task < quads * waves; task += THREADS) {
        let quad = task % quads;
        let axis = (task / quads) % 3u;
        let octave = task / (quads * 3u);
        let wave = waves_of(four_coordinates(first + 4u * quad, axis), axis, octave);
        let row = 3u + 6u * octave + axis;
        hidden[row * quads + quad] = Stored(wave.sine);
        hidden[(row + 3u) * quads + quad] = Stored(wave.cosine);
    }
    for (var task = thread; task < quads * 3u; task += THREADS) {
        let quad = task % quads;
        let axis = task / quads;
        let world = four_coordinates(first + 4u * quad, axis) + deformation.origin[axis];
        hidden[axis * quads + quad] = Stored(world);
    }
    let used = (3u + 6u * deformation.octaves) * quads;
    for (var at = used + thread; at < deformation.input_rows * quads; at += THREADS) {
        hidden[at] = Stored();
    }
}

/// block += W h over `rows` rows of weights from `first_row` on and as many rows of `hidden`.
fn accumulate(block: ptr<function, Block>, first_row: u32, rows: u32, features: u32, quad: u32) {
    var weight_at = first_row * (WIDTH / 4u) + features;
    var hidden_at = quad;
    // Weights of the next four rows are on their way while these are used.
    var w0 = weights[weight_at];
    var w1 = weights[weight_at + WIDTH / 4u];
    var w2 = weights[weight_at + 2u * (WIDTH / 4u)];
    var w3 = weights[weight_at + 3u * (WIDTH / 4u)];
    for (var row = 0u; row < rows; row += 4u) {
        // Behind the last row come the next layer's, or the heads'.
        weight_at += WIDTH;
        let next0 = weights[weight_at];
        let next1 = weights[weight_at + WIDTH / 4u];
        let next2 = weights[weight_at + 2u * (WIDTH / 4u)];
        let next3 = weights[weight_at + 3u * (WIDTH / 4u)];
        multiply_add(block, vec4<f32>(w0), hidden_at);
        multiply_add(block, vec4<f32>(w1), hidden_at + SPLATS / 4u);
        multiply_add(block, vec4<f32>(w2), hidden_at + 2u * (SPLATS / 4u));
        multiply_add(block, vec4<f32>(w3), hidden_at + 3u * (SPLATS / 4u));
        hidden_at += SPLATS;
        w0 = next0;
        w1 = next1;
        w2 = next2;
        w3 = next3;
    }
}

/// block += w ⊗ (one feature of sixteen splats).
fn multiply_add(block: ptr<function, Block>, w: vec4<f32>, at: u32) {
    let a = vec4<f32>(hidden[at]);
    let b = vec4<f32>(hidden[at + 1u]);
    let c = vec4<f32>(hidden[at + 2u]);
    let d = vec4<f32>(hidden[at + 3u]);
    (*block).s0 = fma(w, vec4<f32>(a.x), (*block).s0);
    (*block).s1 = fma(w, vec4<f32>(a.y), (*block).s1);
    (*block).s2 = fma(w, vec4<f32>(a.z), (*block).s2);
    (*block).s3 = fma(w, vec4<f32>(a.w), (*block).s3);
    (*block).s4 = fma(w, vec4<f32>(b.x), (*block).s4);
    (*block).s5 = fma(w, vec4<f32>(b.y), (*block).s5);
    (*block).s6 = fma(w, vec4<f32>(b.z), (*block).s6);
    (*block).s7 = fma(w, vec4<f32>(b.w), (*block).s7);
    (*block).s8 = fma(w, vec4<f32>(c.x), (*block).s8);
    (*block).s9 = fma(w, vec4<f32>(c.y), (*block).s9);
    (*block).s10 = fma(w, vec4<f32>(c.z), (*block).s10);
    (*block).s11 = fma(w, vec4<f32>(c.w), (*block).s11);
    (*block).s12 = fma(w, vec4<f32>(d.x), (*block).s12);
    (*block).s13 = fma(w, vec4<f32>(d.y), (*block).s13);
    (*block).s14 = fma(w, vec4<f32>(d.z), (*block).s14);
    (*block).s15 = fma(w, vec4<f32>(d.w), (*block).s15);
}

/// ReLU, and into the rows of the thread's features.
fn store(block: Block, features: u32, quad: u32) {
    let at = 4u * features * (SPLATS / 4u) + quad;
    store_quad(at, block.s0, block.s1, block.s2, block.s3);
    store_quad(at + 1u, block.s4, block.s5, block.s6, block.s7);
    store_quad(at + 2u, block.s8, block.s9, block.s10, block.s11);
    store_quad(at + 3u, block.s12, block.s13, block.s14, block.s15);
}

/// Four features of four splats, into four rows.
fn store_quad(at: u32, a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>) {
    let zero = vec4<f32>(0.0);
    let rows = transpose(mat4x4<f32>(max(a, zero), max(b, zero), max(c, zero), max(d, zero)));
    hidden[at] = Stored(rows[0]);
    hidden[at + SPLATS / 4u] = Stored(rows[1]);
    hidden[at + 2u * (SPLATS / 4u)] = Stored(rows[2]);
    hidden[at + 3u * (SPLATS / 4u)] = Stored(rows[3]);
}

@compute @workgroup_size(THREADS)
fn deform(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let first = flat_group(group, groups) * SPLATS;
    let features = thread % (WIDTH / 4u);
    let quad = 4u * (thread / (WIDTH / 4u));

    encode(first, thread);
    workgroupBarrier();
    var row = 0u;
    for (var layer = 0u; layer < deformation.depth; layer++) {
        let bias = biases[layer * (WIDTH / 4u) + features];
        var block = Block(
            bias, bias, bias, bias, bias, bias, bias, bias,
            bias, bias, bias, bias, bias, bias, bias, bias,
        );
        let rows = select(WIDTH, deformation.input_rows, layer == 0u);
        accumulate(&block, row, rows, features, quad);
        row += rows;
        workgroupBarrier();
        if (layer == deformation.skip_layer) {
            encode(first, thread);
            workgroupBarrier();
            accumulate(&block, row, deformation.input_rows, features, quad);
            row += deformation.input_rows;
            workgroupBarrier();
        }
        store(block, features, quad);
        workgroupBarrier();
    }
    let head_weights = row * (WIDTH / 4u);
    let head_biases = deformation.depth * (WIDTH / 4u);
    // Heads: four outputs of one splat at a time, then all outputs of a splat by one thread. There
    // are 4 · SPLATS ≤ 4 · THREADS of them, which the threads keep until all have been computed.
    let outputs_0 = head(thread, head_weights, head_biases);
    let outputs_1 = head(thread + THREADS, head_weights, head_biases);
    let outputs_2 = head(thread + 2u * THREADS, head_weights, head_biases);
    let outputs_3 = head(thread + 3u * THREADS, head_weights, head_biases);
    workgroupBarrier();
    store_head(thread, outputs_0);
    store_head(thread + THREADS, outputs_1);
    store_head(thread + 2u * THREADS, outputs_2);
    store_head(thread + 3u * THREADS, outputs_3);
    workgroupBarrier();
    for (var i = thread; i < SPLATS && first + i < evaluated_splats(); i += THREADS) {
        let splat = listed_splat(first + i);
        poses[splat] = apply_outputs(
            canonical_poses[splat],
            kept_outputs(i),
            kept_outputs(SPLATS + i),
            kept_outputs(2u * SPLATS + i),
            kept_outputs(3u * SPLATS + i),
        );
    }
}

fn store_head(task: u32, outputs: vec4<f32>) {
    if (task < 4u * SPLATS) {
        keep_outputs(task, outputs);
    }
}

/// Outputs 4q … 4q + 3 of splat s, for task = q · SPLATS + s.
fn head(task: u32, head_weights: u32, head_biases: u32) -> vec4<f32> {
    let quarter = task / SPLATS;
    if (quarter >= 4u) {
        return vec4<f32>(0.0);
    }
    let splat = task % SPLATS;
    var sum = biases[head_biases + quarter];
    for (var row = 0u; row < WIDTH; row++) {
        let feature = f32(hidden[row * (SPLATS / 4u) + splat / 4u][splat % 4u]);
        sum += vec4<f32>(weights[head_weights + 4u * row + quarter]) * feature;
    }
    return sum;
}
