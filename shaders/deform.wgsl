// Stage 1, second part: the deformation network, fused, in single precision.
//
// Needs: common/dispatch, common/counters, common/frame, common/numbers, common/trigonometry,
// common/deformation, common/deform_splat.
//
// A workgroup evaluates SPLATS splats. The hidden vectors stay in workgroup memory, feature-major:
// row k holds feature k of all splats. A thread computes 4 features of 8 splats; per row of
// weights it reads one vec4 of weights and two vec4 of features for 32 multiply–adds. Layers
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
@group(0) @binding(5) var<storage, read> weights: array<vec4<f32>>;
/// WIDTH biases per layer, then 16 for the heads.
@group(0) @binding(6) var<storage, read> biases: array<vec4<f32>>;

/// Width of the hidden layers, padded with zeros to a multiple of 64.
override WIDTH: u32 = 256u;
/// Splats per workgroup.
override SPLATS: u32 = 32u;
/// WIDTH / 4 · SPLATS / 8.
override THREADS: u32 = 256u;
/// max(WIDTH, input rows) · SPLATS / 4.
override HIDDEN_VECTORS: u32 = 2048u;

var<workgroup> hidden: array<vec4<f32>, HIDDEN_VECTORS>;

/// Four features of eight splats.
struct Block {
    s0: vec4<f32>,
    s1: vec4<f32>,
    s2: vec4<f32>,
    s3: vec4<f32>,
    s4: vec4<f32>,
    s5: vec4<f32>,
    s6: vec4<f32>,
    s7: vec4<f32>,
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
        hidden[row * quads + quad] = wave.sine;
        hidden[(row + 3u) * quads + quad] = wave.cosine;
    }
    for (var task = thread; task < quads * 3u; task += THREADS) {
        let quad = task % quads;
        let axis = task / quads;
        hidden[axis * quads + quad] = four_coordinates(first + 4u * quad, axis)
            + deformation.origin[axis];
    }
    let used = (3u + 6u * deformation.octaves) * quads;
    for (var at = used + thread; at < deformation.input_rows * quads; at += THREADS) {
        hidden[at] = vec4<f32>(0.0);
    }
}

/// block += W h over `rows` rows of weights from `first_row` on and as many rows of `hidden`.
fn accumulate(block: ptr<function, Block>, first_row: u32, rows: u32, features: u32, quad: u32) {
    var weight_at = first_row * (WIDTH / 4u) + features;
    var hidden_at = quad;
    for (var row = 0u; row < rows; row += 4u) {
        let w0 = weights[weight_at];
        let w1 = weights[weight_at + WIDTH / 4u];
        let w2 = weights[weight_at + 2u * (WIDTH / 4u)];
        let w3 = weights[weight_at + 3u * (WIDTH / 4u)];
        multiply_add(block, w0, hidden[hidden_at], hidden[hidden_at + 1u]);
        hidden_at += SPLATS / 4u;
        multiply_add(block, w1, hidden[hidden_at], hidden[hidden_at + 1u]);
        hidden_at += SPLATS / 4u;
        multiply_add(block, w2, hidden[hidden_at], hidden[hidden_at + 1u]);
        hidden_at += SPLATS / 4u;
        multiply_add(block, w3, hidden[hidden_at], hidden[hidden_at + 1u]);
        hidden_at += SPLATS / 4u;
        weight_at += WIDTH;
    }
}

fn multiply_add(block: ptr<function, Block>, w: vec4<f32>, a: vec4<f32>, b: vec4<f32>) {
    (*block).s0 += w * a.x;
    (*block).s1 += w * a.y;
    (*block).s2 += w * a.z;
    (*block).s3 += w * a.w;
    (*block).s4 += w * b.x;
    (*block).s5 += w * b.y;
    (*block).s6 += w * b.z;
    (*block).s7 += w * b.w;
}

/// ReLU, and into the rows of the thread's features.
fn store(block: Block, features: u32, quad: u32) {
    let zero = vec4<f32>(0.0);
    let low = transpose(mat4x4<f32>(
        max(block.s0, zero), max(block.s1, zero), max(block.s2, zero), max(block.s3, zero)));
    let high = transpose(mat4x4<f32>(
        max(block.s4, zero), max(block.s5, zero), max(block.s6, zero), max(block.s7, zero)));
    let at = 4u * features * (SPLATS / 4u) + quad;
    hidden[at] = low[0];
    hidden[at + 1u] = high[0];
    hidden[at + SPLATS / 4u] = low[1];
    hidden[at + SPLATS / 4u + 1u] = high[1];
    hidden[at + 2u * (SPLATS / 4u)] = low[2];
    hidden[at + 2u * (SPLATS / 4u) + 1u] = high[2];
    hidden[at + 3u * (SPLATS / 4u)] = low[3];
    hidden[at + 3u * (SPLATS / 4u) + 1u] = high[3];
}

@compute @workgroup_size(THREADS)
fn deform(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let first = flat_group(group, groups) * SPLATS;
    let features = thread % (WIDTH / 4u);
    let quad = 2u * (thread / (WIDTH / 4u));

    encode(first, thread);
    workgroupBarrier();
    var row = 0u;
    for (var layer = 0u; layer < deformation.depth; layer++) {
        let bias = biases[layer * (WIDTH / 4u) + features];
        var block = Block(bias, bias, bias, bias, bias, bias, bias, bias);
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
    // Heads: four outputs of one splat at a time, then all outputs of a splat by one thread. With
    // 4 · SPLATS ≤ THREADS · 2 two turns are enough; a thread keeps both in registers.
    let first_outputs = head(thread, head_weights, head_biases);
    let second_outputs = head(thread + THREADS, head_weights, head_biases);
    workgroupBarrier();
    if (thread < 4u * SPLATS) {
        hidden[thread] = first_outputs;
    }
    if (thread + THREADS < 4u * SPLATS) {
        hidden[thread + THREADS] = second_outputs;
    }
    workgroupBarrier();
    if (thread < SPLATS && first + thread < evaluated_splats()) {
        let splat = listed_splat(first + thread);
        poses[splat] = apply_outputs(
            canonical_poses[splat],
            hidden[thread],
            hidden[SPLATS + thread],
            hidden[2u * SPLATS + thread],
            hidden[3u * SPLATS + thread],
        );
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
        let feature = hidden[row * (SPLATS / 4u) + splat / 4u][splat % 4u];
        sum += weights[head_weights + 4u * row + quarter] * feature;
    }
    return sum;
}
