// Made from shaders/mask.wgsl by scripts/export-msl.

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

struct Frame {
    metal::float4 rotation_x;
    metal::float4 rotation_y;
    metal::float4 rotation_z;
    metal::float4 centre_high;
    metal::float4 centre_low;
    metal::float4 rotation_z_low;
    metal::float2 focal;
    metal::float2 principal;
    metal::float2 slope_min;
    metal::float2 slope_max;
    metal::float2 image;
    uint sh_degree;
    uint color_source;
    float heat_scale;
    uint zero;
    float depth_near;
    float depth_slope;
};
struct Pose {
    metal::packed_float3 position;
    float log2_opacity;
    metal::float4 rotation;
    metal::packed_float3 scale;
    uint label;
};
struct type_7 {
    metal::float4 inner[24];
};
struct Deformation {
    metal::float4 origin;
    type_7 origin_turns;
    uint splats;
    uint masked;
    float threshold;
    uint octaves;
    uint depth;
    uint skip_layer;
    uint input_rows;
    uint screw;
    uint as_trained;
    uint zero;
    uint padding_1_;
    uint padding_2_;
};
typedef float type_8[1];
typedef Pose type_9[1];
typedef uint type_10[1];
typedef metal::atomic_uint type_12[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint VISIBLE = 0u;
constant uint ENTRIES = 1u;
constant uint SORTED_ENTRIES = 2u;
constant uint DYNAMIC = 3u;
constant uint MOST_ENTRIES = 4u;
constant uint HALTED = 5u;
constant uint DRAWN_FRAMES = 6u;

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

bool is_finite(
    float x
) {
    return (as_type<uint>(x) & 2139095040u) != 2139095040u;
}

bool is_nan(
    float x_1
) {
    return (as_type<uint>(x_1) & 2147483647u) > 2139095040u;
}

float opaque(
    float x_2,
    uint zero
) {
    return as_type<float>(as_type<uint>(x_2) ^ zero);
}

float upper_half(
    float x_3
) {
    return as_type<float>(as_type<uint>(x_3) & 4294963200u);
}

metal::float2 two_sum(
    float a_1,
    float b_1,
    uint zero_1
) {
    float _e4 = opaque(a_1 + b_1, zero_1);
    float _e6 = opaque(_e4 - a_1, zero_1);
    float _e8 = opaque(_e4 - _e6, zero_1);
    return metal::float2(_e4, (a_1 - _e8) + (b_1 - _e6));
}

metal::float2 two_product(
    float a_2,
    float b_2,
    uint zero_2
) {
    float _e4 = opaque(a_2 * b_2, zero_2);
    float _e5 = upper_half(a_2);
    float _e6 = upper_half(b_2);
    float a_low = a_2 - _e5;
    float b_low = b_2 - _e6;
    float error = ((((_e5 * _e6) - _e4) + (_e5 * b_low)) + (a_low * _e6)) + (a_low * b_low);
    return metal::float2(_e4, error);
}

metal::float2 add_two_floats(
    metal::float2 a_3,
    metal::float2 b_3,
    uint zero_3
) {
    metal::float2 _e5 = two_sum(a_3.x, b_3.x, zero_3);
    metal::float2 _e12 = two_sum(_e5.x, _e5.y + (a_3.y + b_3.y), zero_3);
    return _e12;
}

struct maskInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void mask(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Deformation& deformation [[user(fake0)]]
, device type_8 const& motion [[user(fake0)]]
, device type_9 const& initial_poses [[user(fake0)]]
, device type_9& poses [[user(fake0)]]
, device type_10& dynamic_list [[user(fake0)]]
, device type_12& dynamic_count [[user(fake0)]]
, threadgroup metal::atomic_uint& group_count
, threadgroup uint& group_first
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    bool moves = false;
    uint place = 0u;
    bool local = {};
    uint _e3 = flat_group(group, groups);
    uint splat = (_e3 * 256u) + thread_;
    if (thread_ == 0u) {
        metal::atomic_store_explicit(&group_count, 0u, metal::memory_order_relaxed);
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    uint _e17 = deformation.splats;
    if (splat < _e17) {
        float value = motion[splat];
        bool _e22 = is_nan(value);
        if (!(_e22)) {
            float _e28 = deformation.threshold;
            local = value > _e28;
        } else {
            local = true;
        }
        bool _e31 = local;
        moves = _e31;
        bool _e32 = moves;
        if (_e32) {
            uint _e35 = metal::atomic_fetch_add_explicit(&group_count, 1u, metal::memory_order_relaxed);
            place = _e35;
        } else {
            Pose _e40 = initial_poses[splat];
            poses[splat] = _e40;
        }
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    if (thread_ == 0u) {
        uint _e47 = metal::atomic_load_explicit(&group_count, metal::memory_order_relaxed);
        uint _e48 = metal::atomic_fetch_add_explicit(&dynamic_count[3], _e47, metal::memory_order_relaxed);
        group_first = _e48;
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    bool _e49 = moves;
    if (_e49) {
        uint _e52 = group_first;
        uint _e53 = place;
        dynamic_list[_e52 + _e53] = splat;
        return;
    } else {
        return;
    }
}
