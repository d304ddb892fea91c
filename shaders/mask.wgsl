// Stage 1, first part: which splats move.
//
// Needs: common/dispatch, common/counters, common/frame, common/numbers, common/deformation.
//
// One thread per splat. A splat whose motion value is above the threshold (or not a number) goes
// into the list that the network works on, the others take their state at t = 0. The order of the
// list depends on which workgroup comes first; the network treats each splat by itself, so the
// poses do not.

@group(0) @binding(0) var<uniform> deformation: Deformation;
@group(0) @binding(1) var<storage, read> motion: array<f32>;
/// Poses at t = 0.
@group(0) @binding(2) var<storage, read> initial_poses: array<Pose>;
@group(0) @binding(3) var<storage, read_write> poses: array<Pose>;
@group(0) @binding(4) var<storage, read_write> dynamic_list: array<u32>;
@group(0) @binding(5) var<storage, read_write> dynamic_count: array<atomic<u32>>;

var<workgroup> group_count: atomic<u32>;
var<workgroup> group_first: u32;

@compute @workgroup_size(256)
fn mask(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let splat = flat_group(group, groups) * 256u + thread;
    if (thread == 0u) {
        atomicStore(&group_count, 0u);
    }
    workgroupBarrier();
    var moves = false;
    var place = 0u;
    if (splat < deformation.splats) {
        let value = motion[splat];
        moves = is_nan(value) || value > deformation.threshold;
        if (moves) {
            place = atomicAdd(&group_count, 1u);
        } else {
            poses[splat] = initial_poses[splat];
        }
    }
    workgroupBarrier();
    if (thread == 0u) {
        group_first = atomicAdd(&dynamic_count[DYNAMIC], atomicLoad(&group_count));
    }
    workgroupBarrier();
    if (moves) {
        dynamic_list[group_first + place] = splat;
    }
}
