// The numbers of workgroups of later dispatches, from what earlier ones counted.
//
// Needs: common/dispatch, common/counters, common/scan, common/region.
//
// One workgroup each. `drawing_order` runs after the first pass of the depth sort, `entries` after
// the bands have been counted; the latter also turns the counts into positions, and where the
// entries do not fit it lets nothing of the region run, so that the last image stays, and leaves
// the number that is needed for the host. In training it also stops what comes after, so that the
// host can go back to the very step.

struct Sizes {
    /// Keys per block of the depth sort.
    depth_block: u32,
    /// Splats per workgroup of the network.
    network_splats: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(0) @binding(0) var<uniform> region: Region;
@group(0) @binding(1) var<uniform> sizes: Sizes;
@group(0) @binding(2) var<storage, read_write> counts: array<u32>;
@group(0) @binding(3) var<storage, read> digit_counts: array<u32>;
@group(0) @binding(4) var<storage, read_write> group_entries: array<u32>;
/// Workgroups (x, y, z) of each indirect dispatch, four words apart.
@group(0) @binding(5) var<storage, read_write> arguments: array<u32>;

const DEPTH_SORT: u32 = 0u;
const BIN: u32 = 1u;
const EMIT: u32 = 2u;
const ENTRY_SORT: u32 = 3u;
const RASTERIZE: u32 = 4u;
const NETWORK: u32 = 5u;
const ENTRY_CHUNKS: u32 = 6u;

const SPLATS_PER_GROUP: u32 = 64u;

fn set_arguments(slot: u32, groups: u32) {
    let folded_groups = folded(groups);
    arguments[4u * slot] = folded_groups.x;
    arguments[4u * slot + 1u] = folded_groups.y;
    arguments[4u * slot + 2u] = folded_groups.z;
}

/// Splats that the network moves → its workgroups.
@compute @workgroup_size(1)
fn network() {
    set_arguments(NETWORK, divide_up(counts[DYNAMIC], sizes.network_splats));
}

@compute @workgroup_size(256)
fn drawing_order(@builtin(local_invocation_index) thread: u32) {
    _ = inclusive_scan(thread, digit_counts[thread]);
    if (thread == 0u) {
        let visible = scan_values[255];
        counts[VISIBLE] = visible;
        set_arguments(DEPTH_SORT, divide_up(visible, sizes.depth_block));
        set_arguments(BIN, divide_up(visible, SPLATS_PER_GROUP));
    }
}

@compute @workgroup_size(256)
fn entries(@builtin(local_invocation_index) thread: u32) {
    let groups = divide_up(counts[VISIBLE], SPLATS_PER_GROUP);
    var before = 0u;
    for (var first = 0u; first < groups; first += SCAN_WIDTH) {
        let group = first + thread;
        var count = 0u;
        if (group < groups) {
            count = group_entries[group];
        }
        let sum = inclusive_scan(thread, count);
        if (group < groups) {
            // Saturated sums mean an overflow, after which no position is used.
            group_entries[group] = saturating_add(before, sum) - count;
        }
        before = saturating_add(before, scan_values[255]);
        scan_barrier();
    }
    if (thread != 0u) {
        return;
    }
    counts[ENTRIES] = before;
    counts[MOST_ENTRIES] = max(counts[MOST_ENTRIES], before);
    var fits = before <= region.capacity;
    if (region.halts != 0u) {
        fits = fits && counts[HALTED] == 0u;
        counts[HALTED] = select(1u, 0u, fits);
        counts[DRAWN_FRAMES] += select(0u, 1u, fits);
    }
    let sorted = select(0u, before, fits);
    counts[SORTED_ENTRIES] = sorted;
    set_arguments(EMIT, select(0u, groups, fits));
    set_arguments(ENTRY_SORT, divide_up(sorted, 256u * region.sort_keys_per_thread));
    set_arguments(ENTRY_CHUNKS, divide_up(sorted, 256u));
    set_arguments(RASTERIZE, select(0u, region.tiles.x * region.tiles.y, fits));
}
