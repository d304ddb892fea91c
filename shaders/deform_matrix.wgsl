// Stage 1, second part: the deformation network on cooperative matrices (tensor cores), 16-bit
// weights and hidden vectors, 32-bit sums.
//
// Needs: common/dispatch, common/counters, common/frame, common/numbers, common/trigonometry,
// common/deformation, common/deform_splat.
//
// A workgroup of eight subgroups of 32 evaluates 64 splats. The hidden vectors lie splat-major in
// workgroup memory; subgroup g computes features 32 g … 32 g + 31 of all splats as 4 × 2 tiles of
// 16 × 16. Sums pass through a scratch tile of each subgroup on their way to bias, ReLU and 16
// bits. γ is encoded in 32 bits and rounded once. The host uses this kernel only on devices whose
// subgroups have 32 threads, for networks 256 wide, after comparing it with the plain kernel.

@group(0) @binding(0) var<uniform> deformation: Deformation;
@group(0) @binding(1) var<storage, read> canonical_poses: array<Pose>;
@group(0) @binding(2) var<storage, read_write> poses: array<Pose>;
@group(0) @binding(3) var<storage, read> dynamic_splats: array<u32>;
@group(0) @binding(4) var<storage, read> counts: array<u32>;
/// As in deform.wgsl, in half precision.
@group(0) @binding(5) var<storage, read> weights: array<f16>;
@group(0) @binding(6) var<storage, read> biases: array<f32>;

const WIDTH: u32 = 256u;
const SPLATS: u32 = 64u;
const THREADS: u32 = 256u;
const HEAD_OUTPUTS: u32 = 16u;
/// Halves from one splat to the next: not a multiple of the 32 banks of workgroup memory.
const STRIDE: u32 = 264u;

var<workgroup> hidden: array<f16, 16896>;
/// One tile of sums for each subgroup.
var<workgroup> scratch: array<f32, 2048>;

/// γ of the group's positions into the first columns, zeros up to `input_rows`.
fn encode(first: u32, thread: u32) {
    let quads = SPLATS / 4u;
    let waves = 3u * deformation.octaves;
    for (var task = thread; task < quads * waves; task += THREADS) {
        let quad = task % quads;
        let axis = (task / quads) % 3u;
        let octave = task / (quads * 3u);
        let wave = waves_of(four_coordinates(first + 4u * quad, axis), axis, octave);
        let at = 4u * quad * STRIDE + 3u + 6u * octave + axis;
        for (var i = 0u; i < 4u; i++) {
            hidden[at + i * STRIDE] = f16(wave.sine[i]);
            hidden[at + i * STRIDE + 3u] = f16(wave.cosine[i]);
        }
    }
    for (var task = thread; task < SPLATS * 3u; task += THREADS) {
        let splat = task / 3u;
        let axis = task % 3u;
        let position = canonical_poses[listed_splat(first + splat)].position[axis];
        hidden[splat * STRIDE + axis] = f16(position + deformation.origin[axis]);
    }
    let used = 3u + 6u * deformation.octaves;
    let unused = deformation.input_rows - used;
    for (var task = thread; task < SPLATS * unused; task += THREADS) {
        hidden[(task / unused) * STRIDE + used + task % unused] = f16(0.0);
    }
}

/// Bias, ReLU and rounding of one tile of sums in the subgroup's scratch.
fn finish_tile(splat_tile: u32, feature: u32, bias_at: u32, group: u32, lane: u32) {
    // Two lanes a splat, eight features each.
    let splat = lane / 2u;
    let column = 8u * (lane % 2u);
    for (var i = 0u; i < 8u; i++) {
        let sum = scratch[group * 256u + splat * 16u + column + i]
            + biases[bias_at + feature + column + i];
        // Beyond the largest half a feature would become infinite, and zero times it no number.
        let at = (16u * splat_tile + splat) * STRIDE + feature + column + i;
        hidden[at] = f16(clamp(sum, 0.0, 65504.0));
    }
}

@compute @workgroup_size(256)
fn deform_matrix(
    @builtin(workgroup_id) group_id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let first = flat_group(group_id, groups) * SPLATS;
    let group = thread / 32u;
    let lane = thread % 32u;
    let feature = 32u * group;

    encode(first, thread);
    workgroupBarrier();
    var row = 0u;
    for (var layer = 0u; layer < deformation.depth; layer++) {
        var c00 = coop_mat16x16<f32, C>();
        var c10 = coop_mat16x16<f32, C>();
        var c20 = coop_mat16x16<f32, C>();
        var c30 = coop_mat16x16<f32, C>();
        var c01 = coop_mat16x16<f32, C>();
        var c11 = coop_mat16x16<f32, C>();
        var c21 = coop_mat16x16<f32, C>();
        var c31 = coop_mat16x16<f32, C>();
        // The skip layer has a second turn, over γ.
        let turns = select(1u, 2u, layer == deformation.skip_layer);
        for (var turn = 0u; turn < turns; turn++) {
            if (turn == 1u) {
                workgroupBarrier();
                encode(first, thread);
                workgroupBarrier();
            }
            let rows = select(WIDTH, deformation.input_rows, layer == 0u || turn == 1u);
            for (var k = 0u; k < rows; k += 16u) {
                let weight_at = (row + k) * WIDTH + feature;
                let b0 = coopLoadT<coop_mat16x16<f16, B>>(&weights[weight_at], WIDTH);
                let b1 = coopLoadT<coop_mat16x16<f16, B>>(&weights[weight_at + 16u], WIDTH);
                let a0 = coopLoadT<coop_mat16x16<f16, A>>(&hidden[k], STRIDE);
                c00 = coopMultiplyAdd(a0, b0, c00);
                c01 = coopMultiplyAdd(a0, b1, c01);
                let a1 = coopLoadT<coop_mat16x16<f16, A>>(&hidden[16u * STRIDE + k], STRIDE);
                c10 = coopMultiplyAdd(a1, b0, c10);
                c11 = coopMultiplyAdd(a1, b1, c11);
                let a2 = coopLoadT<coop_mat16x16<f16, A>>(&hidden[32u * STRIDE + k], STRIDE);
                c20 = coopMultiplyAdd(a2, b0, c20);
                c21 = coopMultiplyAdd(a2, b1, c21);
                let a3 = coopLoadT<coop_mat16x16<f16, A>>(&hidden[48u * STRIDE + k], STRIDE);
                c30 = coopMultiplyAdd(a3, b0, c30);
                c31 = coopMultiplyAdd(a3, b1, c31);
            }
            row += rows;
        }
        let bias_at = layer * WIDTH;
        let scratch_at = group * 256u;
        workgroupBarrier();
        coopStoreT(c00, &scratch[scratch_at], 16u);
        workgroupBarrier();
        finish_tile(0u, feature, bias_at, group, lane);
        workgroupBarrier();
        coopStoreT(c10, &scratch[scratch_at], 16u);
        workgroupBarrier();
        finish_tile(1u, feature, bias_at, group, lane);
        workgroupBarrier();
        coopStoreT(c20, &scratch[scratch_at], 16u);
        workgroupBarrier();
        finish_tile(2u, feature, bias_at, group, lane);
        workgroupBarrier();
        coopStoreT(c30, &scratch[scratch_at], 16u);
        workgroupBarrier();
        finish_tile(3u, feature, bias_at, group, lane);
        workgroupBarrier();
        coopStoreT(c01, &scratch[scratch_at], 16u);
        workgroupBarrier();
        finish_tile(0u, feature + 16u, bias_at, group, lane);
        workgroupBarrier();
        coopStoreT(c11, &scratch[scratch_at], 16u);
        workgroupBarrier();
        finish_tile(1u, feature + 16u, bias_at, group, lane);
        workgroupBarrier();
        coopStoreT(c21, &scratch[scratch_at], 16u);
        workgroupBarrier();
        finish_tile(2u, feature + 16u, bias_at, group, lane);
        workgroupBarrier();
        coopStoreT(c31, &scratch[scratch_at], 16u);
        workgroupBarrier();
        finish_tile(3u, feature + 16u, bias_at, group, lane);
        workgroupBarrier();
    }
    // Heads: subgroup g < 4 computes all 16 outputs of splats 16 g … 16 g + 15.
    var outputs = coop_mat16x16<f32, C>();
    let splat_tile = min(group, 3u);
    for (var k = 0u; k < WIDTH; k += 16u) {
        let at = row * WIDTH + k * HEAD_OUTPUTS;
        let b = coopLoadT<coop_mat16x16<f16, B>>(&weights[at], HEAD_OUTPUTS);
        let a = coopLoadT<coop_mat16x16<f16, A>>(&hidden[16u * splat_tile * STRIDE + k], STRIDE);
        outputs = coopMultiplyAdd(a, b, outputs);
    }
    coopStoreT(outputs, &scratch[group * 256u], 16u);
    workgroupBarrier();
    if (thread < SPLATS && first + thread < evaluated_splats()) {
        let splat = listed_splat(first + thread);
        poses[splat] = apply_outputs(
            canonical_poses[splat],
            four_outputs(thread, 0u),
            four_outputs(thread, 4u),
            four_outputs(thread, 8u),
            four_outputs(thread, 12u),
        );
    }
}

fn four_outputs(splat: u32, output: u32) -> vec4<f32> {
    let at = splat * HEAD_OUTPUTS + output;
    let bias = deformation.depth * WIDTH + output;
    return vec4<f32>(
        scratch[at] + biases[bias],
        scratch[at + 1u] + biases[bias + 1u],
        scratch[at + 2u] + biases[bias + 2u],
        scratch[at + 3u] + biases[bias + 3u],
    );
}
