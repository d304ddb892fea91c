// Made from shaders/copy.wgsl by scripts/export-msl.

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

struct Densification {
    uint splats;
    uint count;
    metal::uint2 seed;
    uint step;
    uint purpose;
    uint shift;
    uint even_weight;
    float dead_logit;
    float lowest_logit;
    uint padding_1_;
    uint padding_2_;
};
typedef uint type_4[1];
typedef float type_5[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint NO_HOST = 4294967295u;
constant uint DEAD = 4294967294u;
constant uint WIDTH = 1u;

uint flat_group(
    metal::uint3 group_1,
    metal::uint3 groups_1
) {
    return (group_1.y * groups_1.x) + group_1.x;
}
uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}


struct copyInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void copy(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Densification& densification [[user(fake0)]]
, device type_4 const& hosts [[user(fake0)]]
, device type_4 const& copies [[user(fake0)]]
, device type_5& parameters [[user(fake0)]]
, device type_5& first_moments [[user(fake0)]]
, device type_5& second_moments [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    bool local = {};
    uint _e3 = flat_group(group, groups);
    uint i = (_e3 * 256u) + thread_;
    uint splat = naga_div(i, WIDTH);
    uint _e11 = densification.count;
    if (splat >= _e11) {
        return;
    }
    uint host = hosts[splat];
    uint _e18 = densification.splats;
    if (host < _e18) {
        float _e29 = parameters[(host * WIDTH) + naga_mod(i, WIDTH)];
        parameters[i] = _e29;
    } else {
        uint _e32 = densification.splats;
        if (!((splat >= _e32))) {
            uint _e39 = copies[splat];
            local = _e39 == 0u;
        } else {
            local = true;
        }
        bool _e43 = local;
        if (_e43) {
            return;
        }
    }
    first_moments[i] = 0.0;
    second_moments[i] = 0.0;
    return;
}
