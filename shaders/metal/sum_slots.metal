// Made from shaders/sum_slots.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size1;
    uint size2;
    uint size3;
    uint size4;
    uint size5;
};

struct SplatCount {
    uint count;
    uint capacity;
    uint stored_degree;
    uint degree;
};
typedef uint type_2[1];
typedef float type_4[1];
typedef metal::float4 type_6[1];
struct type_8 {
    metal::float4 inner[256];
};
struct type_10 {
    metal::float2 inner[256];
};
struct type_11 {
    uint inner[256];
};
struct SlotSums {
    metal::float4 a;
    metal::float4 b;
    metal::float2 c;
    char _pad3[8];
};
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint VISIBLE = 0u;
constant uint ENTRIES = 1u;
constant uint SORTED_ENTRIES = 2u;
constant uint DYNAMIC = 3u;
constant uint MOST_ENTRIES = 4u;
constant uint HALTED = 5u;
constant uint DRAWN_FRAMES = 6u;
constant uint CHUNK = 256u;
constant uint NO_SLOT = 4294967295u;
constant bool DEPTH = false;

uint flat_group(
    metal::uint3 group_2,
    metal::uint3 groups_2
) {
    return (group_2.y * groups_2.x) + group_2.x;
}

uint sum_count(
) {
    return 9u;
}

SlotSums load_slot(
    uint slot_1,
    device type_4 const& slots,
    constant _mslBufferSizes& _buffer_sizes
) {
    float depth = 0.0;
    uint _e1 = sum_count();
    uint at = slot_1 * _e1;
    if (DEPTH) {
        float _e10 = slots[at + 9u];
        depth = _e10;
    }
    float _e13 = slots[at];
    float _e18 = slots[at + 1u];
    float _e23 = slots[at + 2u];
    float _e28 = slots[at + 3u];
    float _e34 = slots[at + 4u];
    float _e39 = slots[at + 5u];
    float _e44 = slots[at + 6u];
    float _e49 = slots[at + 7u];
    float _e55 = slots[at + 8u];
    float _e56 = depth;
    return SlotSums {metal::float4(_e13, _e18, _e23, _e28), metal::float4(_e34, _e39, _e44, _e49), metal::float2(_e55, _e56)};
}

void store_slot(
    uint slot_2,
    SlotSums value_1,
    device type_4& slots,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e2 = sum_count();
    uint at_1 = slot_2 * _e2;
    slots[at_1] = value_1.a.x;
    slots[at_1 + 1u] = value_1.a.y;
    slots[at_1 + 2u] = value_1.a.z;
    slots[at_1 + 3u] = value_1.a.w;
    slots[at_1 + 4u] = value_1.b.x;
    slots[at_1 + 5u] = value_1.b.y;
    slots[at_1 + 6u] = value_1.b.z;
    slots[at_1 + 7u] = value_1.b.w;
    slots[at_1 + 8u] = value_1.c.x;
    if (DEPTH) {
        slots[at_1 + 9u] = value_1.c.y;
        return;
    } else {
        return;
    }
}

SlotSums add_behind(
    SlotSums value_2,
    uint thread_2,
    uint distance,
    threadgroup type_8& chunk_a,
    threadgroup type_8& chunk_b,
    threadgroup type_10& chunk_c,
    threadgroup type_11& chunk_splats
) {
    SlotSums sum = {};
    chunk_a.inner[thread_2] = value_2.a;
    chunk_b.inner[thread_2] = value_2.b;
    chunk_c.inner[thread_2] = value_2.c;
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    sum = value_2;
    uint other = thread_2 + distance;
    if (other < CHUNK) {
        uint _e18 = chunk_splats.inner[other];
        uint _e21 = chunk_splats.inner[thread_2];
        if (_e18 == _e21) {
            metal::float4 _e26 = chunk_a.inner[other];
            metal::float4 _e31 = chunk_b.inner[other];
            metal::float2 _e36 = chunk_c.inner[other];
            sum = SlotSums {value_2.a + _e26, value_2.b + _e31, value_2.c + _e36};
        }
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    SlotSums _e39 = sum;
    return _e39;
}

struct sum_chunksInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void sum_chunks(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, device type_2 const& counts [[user(fake0)]]
, device type_2 const& slot_splats [[user(fake0)]]
, device type_4& slots [[user(fake0)]]
, device type_2& first_slots [[user(fake0)]]
, threadgroup type_8& chunk_a
, threadgroup type_8& chunk_b
, threadgroup type_10& chunk_c
, threadgroup type_11& chunk_splats
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint splat = NO_SLOT;
    SlotSums value = SlotSums {metal::float4(0.0), metal::float4(0.0), metal::float2(0.0)};
    bool starts_run = true;
    bool starts_part = true;
    bool local = {};
    uint _e3 = flat_group(group, groups);
    uint slot_3 = (_e3 * CHUNK) + thread_;
    uint _e9 = counts[2];
    bool inside = slot_3 < _e9;
    if (inside) {
        uint _e23 = slot_splats[slot_3];
        splat = _e23;
        SlotSums _e24 = load_slot(slot_3, slots, _buffer_sizes);
        value = _e24;
    }
    uint _e27 = splat;
    chunk_splats.inner[thread_] = _e27;
    SlotSums _e28 = value;
    SlotSums _e30 = add_behind(_e28, thread_, 1u, chunk_a, chunk_b, chunk_c, chunk_splats);
    value = _e30;
    SlotSums _e31 = value;
    SlotSums _e33 = add_behind(_e31, thread_, 2u, chunk_a, chunk_b, chunk_c, chunk_splats);
    value = _e33;
    SlotSums _e34 = value;
    SlotSums _e36 = add_behind(_e34, thread_, 4u, chunk_a, chunk_b, chunk_c, chunk_splats);
    value = _e36;
    SlotSums _e37 = value;
    SlotSums _e39 = add_behind(_e37, thread_, 8u, chunk_a, chunk_b, chunk_c, chunk_splats);
    value = _e39;
    SlotSums _e40 = value;
    SlotSums _e42 = add_behind(_e40, thread_, 16u, chunk_a, chunk_b, chunk_c, chunk_splats);
    value = _e42;
    SlotSums _e43 = value;
    SlotSums _e45 = add_behind(_e43, thread_, 32u, chunk_a, chunk_b, chunk_c, chunk_splats);
    value = _e45;
    SlotSums _e46 = value;
    SlotSums _e48 = add_behind(_e46, thread_, 64u, chunk_a, chunk_b, chunk_c, chunk_splats);
    value = _e48;
    SlotSums _e49 = value;
    SlotSums _e51 = add_behind(_e49, thread_, 128u, chunk_a, chunk_b, chunk_c, chunk_splats);
    value = _e51;
    if (!(inside)) {
        return;
    }
    if (slot_3 > 0u) {
        uint _e63 = slot_splats[slot_3 - 1u];
        uint _e64 = splat;
        starts_run = _e63 != _e64;
        bool _e66 = starts_run;
        if (!(_e66)) {
            local = thread_ == 0u;
        } else {
            local = true;
        }
        bool _e73 = local;
        starts_part = _e73;
    }
    bool _e74 = starts_part;
    if (_e74) {
        SlotSums _e75 = value;
        store_slot(slot_3, _e75, slots, _buffer_sizes);
    }
    bool _e76 = starts_run;
    if (_e76) {
        uint _e78 = splat;
        first_slots[_e78] = slot_3;
        return;
    } else {
        return;
    }
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}


struct sum_splatsInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void sum_splats(
  metal::uint3 group_1 [[threadgroup_position_in_grid]]
, metal::uint3 groups_1 [[threadgroups_per_grid]]
, uint thread_1 [[thread_index_in_threadgroup]]
, constant SplatCount& splats [[user(fake0)]]
, device type_2 const& counts [[user(fake0)]]
, device type_2 const& slot_splats [[user(fake0)]]
, device type_4 const& slots [[user(fake0)]]
, device type_2 const& first_slots [[user(fake0)]]
, device type_6& sums [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    SlotSums total = {};
    uint slot = {};
    uint _e3 = flat_group(group_1, groups_1);
    uint splat_1 = (_e3 * 256u) + thread_1;
    uint _e9 = splats.count;
    if (splat_1 >= _e9) {
        return;
    }
    uint first = first_slots[splat_1];
    if (first == NO_SLOT) {
        sums[3u * splat_1] = metal::float4(0.0);
        sums[(3u * splat_1) + 1u] = metal::float4(0.0);
        sums[(3u * splat_1) + 2u] = metal::float4(0.0);
        return;
    }
    SlotSums _e38 = load_slot(first, slots, _buffer_sizes);
    total = _e38;
    uint end = counts[2];
    slot = (naga_div(first, CHUNK) + 1u) * CHUNK;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e72 = slot;
            slot = _e72 + CHUNK;
        }
        loop_init = false;
        uint _e50 = slot;
        if (_e50 < end) {
        } else {
            break;
        }
        {
            uint _e53 = slot;
            uint _e55 = slot_splats[_e53];
            if (_e55 != splat_1) {
                break;
            }
            uint _e57 = slot;
            SlotSums _e58 = load_slot(_e57, slots, _buffer_sizes);
            metal::float4 _e60 = total.a;
            metal::float4 _e64 = total.b;
            metal::float2 _e68 = total.c;
            total = SlotSums {_e60 + _e58.a, _e64 + _e58.b, _e68 + _e58.c};
        }
    }
    metal::float4 _e80 = total.a;
    float _e84 = total.c.y;
    sums[3u * splat_1] = metal::float4(_e80.xyz, _e84);
    float _e94 = total.a.w;
    metal::float4 _e96 = total.b;
    sums[(3u * splat_1) + 1u] = metal::float4(_e94, _e96.xyz);
    float _e107 = total.b.w;
    float _e110 = total.c.x;
    sums[(3u * splat_1) + 2u] = metal::float4(_e107, _e110, 1.0, 0.0);
    return;
}
