// Made from shaders/depth_gradient.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size1;
    uint size2;
    uint size3;
    uint size4;
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
typedef metal::float4 type_5[1];
typedef metal::uint4 type_7[1];
typedef float type_8[1];
typedef metal::float2 type_10[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;
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

struct depth_gradientInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void depth_gradient(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Region& region [[user(fake0)]]
, device type_5 const& image [[user(fake0)]]
, device type_7 const& layers [[user(fake0)]]
, device type_8 const& by_depth [[user(fake0)]]
, device type_10& by_depth_sums [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    metal::float2 sums = metal::float2(0.0);
    uint _e3 = flat_group(group, groups);
    uint pixel = (_e3 * 256u) + thread_;
    uint _e10 = region.image.x;
    uint _e14 = region.image.y;
    if (pixel >= (_e10 * _e14)) {
        return;
    }
    float weight = image[pixel].w;
    if (weight > 0.0) {
        float _e28 = by_depth[pixel];
        float by_weighted = _e28 / weight;
        uint _e34 = layers[pixel].x;
        sums = metal::float2(by_weighted, -(by_weighted) * as_type<float>(_e34));
    }
    metal::float2 _e40 = sums;
    by_depth_sums[pixel] = _e40;
    return;
}
