// Made from shaders/arguments.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size3;
    uint size4;
    uint size5;
    uint size6;
};

struct type_2 {
    uint inner[256];
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
struct Sizes {
    uint depth_block;
    uint network_splats;
    uint padding_1_;
    uint padding_2_;
};
typedef uint type_4[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint VISIBLE = 0u;
constant uint ENTRIES = 1u;
constant uint SORTED_ENTRIES = 2u;
constant uint DYNAMIC = 3u;
constant uint MOST_ENTRIES = 4u;
constant uint HALTED = 5u;
constant uint DRAWN_FRAMES = 6u;
constant uint SCAN_WIDTH = 256u;
constant uint TILE = 16u;
constant uint DEPTH_SORT = 0u;
constant uint BIN = 1u;
constant uint EMIT = 2u;
constant uint ENTRY_SORT = 3u;
constant uint RASTERIZE = 4u;
constant uint NETWORK = 5u;
constant uint ENTRY_CHUNKS = 6u;
constant uint SPLATS_PER_GROUP = 64u;

uint flat_group(
    metal::uint3 group,
    metal::uint3 groups
) {
    return (group.y * groups.x) + group.x;
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

metal::uint3 folded(
    uint count_1
) {
    uint rows = naga_div((count_1 + MAX_GROUPS_PER_ROW) - 1u, MAX_GROUPS_PER_ROW);
    return metal::uint3(metal::min(count_1, MAX_GROUPS_PER_ROW), metal::max(rows, 1u), 1u);
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

uint saturating_add(
    uint a_1,
    uint b_1
) {
    uint sum_1 = a_1 + b_1;
    return (sum_1 < a_1) ? 4294967295u : sum_1;
}

uint inclusive_scan(
    uint thread_2,
    uint value,
    threadgroup type_2& scan_values
) {
    uint sum = {};
    uint distance = 1u;
    uint left = {};
    sum = value;
    uint _e5 = sum;
    scan_values.inner[thread_2] = _e5;
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e26 = distance;
            distance = _e26 * 2u;
        }
        loop_init = false;
        uint _e8 = distance;
        if (_e8 < SCAN_WIDTH) {
        } else {
            break;
        }
        {
            left = 0u;
            uint _e13 = distance;
            if (thread_2 >= _e13) {
                uint _e16 = distance;
                uint _e19 = scan_values.inner[thread_2 - _e16];
                left = _e19;
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e20 = sum;
            uint _e21 = left;
            uint _e22 = saturating_add(_e20, _e21);
            sum = _e22;
            uint _e25 = sum;
            scan_values.inner[thread_2] = _e25;
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
        }
    }
    uint _e29 = sum;
    return _e29;
}

void scan_barrier(
) {
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    return;
}

void set_arguments(
    uint slot,
    uint groups_1,
    device type_4& arguments,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::uint3 _e2 = folded(groups_1);
    arguments[4u * slot] = _e2.x;
    arguments[(4u * slot) + 1u] = _e2.y;
    arguments[(4u * slot) + 2u] = _e2.z;
    return;
}

[[max_total_threads_per_threadgroup(1)]] kernel void network(
  constant Sizes& sizes [[user(fake0)]]
, device type_4 const& counts [[user(fake0)]]
, device type_4& arguments [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint _e3 = counts[3];
    uint _e6 = sizes.network_splats;
    uint _e7 = divide_up(_e3, _e6);
    set_arguments(NETWORK, _e7, arguments, _buffer_sizes);
    return;
}


struct drawing_orderInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void drawing_order(
  uint thread_ [[thread_index_in_threadgroup]]
, threadgroup type_2& scan_values
, constant Sizes& sizes [[user(fake0)]]
, device type_4& counts [[user(fake0)]]
, device type_4 const& digit_counts [[user(fake0)]]
, device type_4& arguments [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint _e3 = digit_counts[thread_];
    uint _e4 = inclusive_scan(thread_, _e3, scan_values);
    if (thread_ == 0u) {
        uint visible = scan_values.inner[255];
        counts[0] = visible;
        uint _e15 = sizes.depth_block;
        uint _e16 = divide_up(visible, _e15);
        set_arguments(DEPTH_SORT, _e16, arguments, _buffer_sizes);
        uint _e19 = divide_up(visible, SPLATS_PER_GROUP);
        set_arguments(BIN, _e19, arguments, _buffer_sizes);
        return;
    } else {
        return;
    }
}


struct entriesInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void entries(
  uint thread_1 [[thread_index_in_threadgroup]]
, threadgroup type_2& scan_values
, constant Region& region [[user(fake0)]]
, device type_4& counts [[user(fake0)]]
, device type_4& group_entries [[user(fake0)]]
, device type_4& arguments [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint before = 0u;
    uint first = 0u;
    uint count = {};
    bool fits = {};
    bool local = {};
    uint _e3 = counts[0];
    uint _e5 = divide_up(_e3, SPLATS_PER_GROUP);
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e34 = first;
            first = _e34 + SCAN_WIDTH;
        }
        loop_init_1 = false;
        uint _e10 = first;
        if (_e10 < _e5) {
        } else {
            break;
        }
        {
            uint _e12 = first;
            uint group_1 = _e12 + thread_1;
            count = 0u;
            if (group_1 < _e5) {
                uint _e19 = group_entries[group_1];
                count = _e19;
            }
            uint _e20 = count;
            uint _e21 = inclusive_scan(thread_1, _e20, scan_values);
            if (group_1 < _e5) {
                uint _e25 = before;
                uint _e26 = saturating_add(_e25, _e21);
                uint _e27 = count;
                group_entries[group_1] = _e26 - _e27;
            }
            uint _e29 = before;
            uint _e32 = scan_values.inner[255];
            uint _e33 = saturating_add(_e29, _e32);
            before = _e33;
            scan_barrier();
        }
    }
    if (thread_1 != 0u) {
        return;
    }
    uint _e41 = before;
    counts[1] = _e41;
    uint _e46 = counts[4];
    uint _e47 = before;
    counts[4] = metal::max(_e46, _e47);
    uint _e49 = before;
    uint _e52 = region.capacity;
    fits = _e49 <= _e52;
    uint _e57 = region.halts;
    if (_e57 != 0u) {
        bool _e60 = fits;
        if (_e60) {
            uint _e65 = counts[5];
            local = _e65 == 0u;
        } else {
            local = false;
        }
        bool _e69 = local;
        fits = _e69;
        bool _e74 = fits;
        counts[5] = _e74 ? 0u : 1u;
        uint _e78 = counts[6];
        bool _e81 = fits;
        counts[6] = _e78 + (_e81 ? 1u : 0u);
    }
    uint _e85 = before;
    bool _e86 = fits;
    uint sorted = _e86 ? _e85 : 0u;
    counts[2] = sorted;
    bool _e92 = fits;
    set_arguments(EMIT, _e92 ? _e5 : 0u, arguments, _buffer_sizes);
    uint _e98 = region.sort_keys_per_thread;
    uint _e100 = divide_up(sorted, 256u * _e98);
    set_arguments(ENTRY_SORT, _e100, arguments, _buffer_sizes);
    uint _e103 = divide_up(sorted, 256u);
    set_arguments(ENTRY_CHUNKS, _e103, arguments, _buffer_sizes);
    uint _e109 = region.tiles.x;
    uint _e113 = region.tiles.y;
    bool _e115 = fits;
    set_arguments(RASTERIZE, _e115 ? (_e109 * _e113) : 0u, arguments, _buffer_sizes);
    return;
}
