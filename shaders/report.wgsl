// What a step found, into its slot of the ring, before the update; and whether the update may be.
//
// Needs: common/counters, common/training.
//
// One workgroup. Sums are made in a fixed order, so a run gives the same bits every time.

@group(0) @binding(0) var<uniform> training: TrainingStep;
@group(0) @binding(1) var<storage, read> tile_sums: array<vec4<f32>>;
/// Counts of the frame.
@group(0) @binding(2) var<storage, read> counts: array<u32>;
@group(0) @binding(3) var<storage, read_write> reports: array<u32>;

var<workgroup> partial: array<vec4<f32>, 256>;

@compute @workgroup_size(256)
fn report(@builtin(local_invocation_index) thread: u32) {
    let tiles = training.tiles.x * training.tiles.y;
    var sum = vec4<f32>(0.0);
    for (var tile = thread; tile < tiles; tile += 256u) {
        sum += tile_sums[tile];
    }
    partial[thread] = sum;
    for (var half = 128u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if (thread < half) {
            partial[thread] += partial[thread + half];
        }
    }
    if (thread != 0u) {
        return;
    }
    let total = partial[0];
    let slot = training.slot;
    reports[report_word(slot, REPORT_DIFFERENCE)] = bitcast<u32>(total.x);
    reports[report_word(slot, REPORT_DISSIMILARITY)] = bitcast<u32>(total.y);
    reports[report_word(slot, REPORT_IMAGE_NOT_FINITE)] = u32(total.z);
    reports[report_word(slot, REPORT_NOT_FINITE)] = 0u;
    reports[report_word(slot, REPORT_VISIBLE)] = counts[VISIBLE];
    reports[report_word(slot, REPORT_ENTRIES)] = counts[MOST_ENTRIES];
    reports[report_word(slot, REPORT_HALTED)] = counts[HALTED];
    reports[report_word(slot, REPORT_STEP)] = training.step;
}
