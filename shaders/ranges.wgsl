// Where each tile's entries start in the sorted list.
//
// Needs: common/dispatch, common/counters, common/region.
//
// One thread per tile, and one past the last: the first entry whose tile is not below this one, by
// bisection.

@group(0) @binding(0) var<uniform> region: Region;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read> entry_tiles: array<u32>;
/// tiles + 1 starts.
@group(0) @binding(3) var<storage, read_write> tile_starts: array<u32>;

@compute @workgroup_size(256)
fn ranges(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let tile = flat_group(group, groups) * 256u + thread;
    if (tile > region.tiles.x * region.tiles.y) {
        return;
    }
    var first = 0u;
    var end = counts[SORTED_ENTRIES];
    while (first < end) {
        let middle = first + (end - first) / 2u;
        if (entry_tiles[middle] < tile) {
            first = middle + 1u;
        } else {
            end = middle;
        }
    }
    tile_starts[tile] = first;
}
