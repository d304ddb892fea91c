// The splat of each entry, once the tile sort has moved the numbers.
//
// Needs: common/dispatch, common/counters.

@group(0) @binding(0) var<storage, read> counts: array<u32>;
@group(0) @binding(1) var<storage, read> entry_slots: array<u32>;
@group(0) @binding(2) var<storage, read> slot_splats: array<u32>;
@group(0) @binding(3) var<storage, read_write> entry_splats: array<u32>;

@compute @workgroup_size(256)
fn resolve_entries(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let entry = flat_group(group, groups) * 256u + thread;
    if (entry < counts[SORTED_ENTRIES]) {
        entry_splats[entry] = slot_splats[entry_slots[entry]];
    }
}
