// Where each tile's entries start in the sorted list.
//
// Needs: common/dispatch, common/counters, common/region.
//
// One thread per entry, and one past the last: where the tile changes, the starts of all tiles
// after the previous entry's, up to this one's, are here. Every start is written exactly once.

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
    let i = flat_group(group, groups) * 256u + thread;
    let entries = counts[SORTED_ENTRIES];
    if (i > entries) {
        return;
    }
    var first = 0u;
    if (i > 0u) {
        first = entry_tiles[i - 1u] + 1u;
    }
    var last = region.tiles.x * region.tiles.y;
    if (i < entries) {
        last = entry_tiles[i];
    }
    for (var tile = first; tile <= last; tile++) {
        tile_starts[tile] = i;
    }
}
