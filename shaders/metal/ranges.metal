// Made from shaders/ranges.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size1;
    uint size2;
    uint size3;
};

struct Region {
    metal::uint2 first_tile;
    metal::uint2 tiles;
    metal::uint2 image;
    metal::uint2 output_origin;
    uint output_stride;
    uint capacity;
    uint sort_keys_per_thread;
    uint halts;
};
typedef uint type_3[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint VISIBLE = 0u;
constant uint ENTRIES = 1u;
constant uint SORTED_ENTRIES = 2u;
constant uint DYNAMIC = 3u;
constant uint MOST_ENTRIES = 4u;
constant uint HALTED = 5u;
constant uint DRAWN_FRAMES = 6u;
constant uint TILE = 16u;

uint flat_group(
    metal::uint3 group_1,
    metal::uint3 groups_1
) {
    return (group_1.y * groups_1.x) + group_1.x;
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

metal::uint3 folded(
    uint count
) {
    uint rows = naga_div((count + MAX_GROUPS_PER_ROW) - 1u, MAX_GROUPS_PER_ROW);
    return metal::uint3(metal::min(count, MAX_GROUPS_PER_ROW), metal::max(rows, 1u), 1u);
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

uint divide_up(
    uint a,
    uint b
) {
    return naga_div(a, b) + ((naga_mod(a, b) != 0u) ? 1u : 0u);
}

struct rangesInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void ranges(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Region& region [[user(fake0)]]
, device type_3 const& counts [[user(fake0)]]
, device type_3 const& entry_tiles [[user(fake0)]]
, device type_3& tile_starts [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint first = 0u;
    uint end = {};
    uint _e3 = flat_group(group, groups);
    uint tile = (_e3 * 256u) + thread_;
    uint _e10 = region.tiles.x;
    uint _e14 = region.tiles.y;
    if (tile > (_e10 * _e14)) {
        return;
    }
    uint _e21 = counts[2];
    end = _e21;
    while(true) {
        uint _e23 = first;
        uint _e24 = end;
        if (_e23 < _e24) {
        } else {
            break;
        }
        {
            uint _e26 = first;
            uint _e27 = end;
            uint _e28 = first;
            uint middle = _e26 + naga_div(_e27 - _e28, 2u);
            uint _e35 = entry_tiles[middle];
            if (_e35 < tile) {
                first = middle + 1u;
            } else {
                end = middle;
            }
        }
    }
    uint _e41 = first;
    tile_starts[tile] = _e41;
    return;
}
