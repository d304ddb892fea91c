// Made from shaders/restride.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size1;
    uint size2;
};

struct Strides {
    uint before;
    uint after;
    uint total;
    uint padding;
};
typedef float type_3[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;

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

struct restrideInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void restride(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Strides& strides [[user(fake0)]]
, device type_3 const& narrow [[user(fake0)]]
, device type_3& spread [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    float value = 0.0;
    uint _e3 = flat_group(group, groups);
    uint i = (_e3 * 256u) + thread_;
    uint _e9 = strides.total;
    if (i >= _e9) {
        return;
    }
    uint _e13 = strides.after;
    uint column = naga_mod(i, _e13);
    uint _e19 = strides.before;
    if (column < _e19) {
        uint _e24 = strides.after;
        uint _e28 = strides.before;
        float _e32 = narrow[(naga_div(i, _e24) * _e28) + column];
        value = _e32;
    }
    float _e35 = value;
    spread[i] = _e35;
    return;
}
