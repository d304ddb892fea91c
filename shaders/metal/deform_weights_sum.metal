// Made from shaders/deform_weights_sum.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size2;
    uint size3;
};

struct type_3 {
    metal::float4 inner[13];
};
struct NetworkChunk {
    uint first;
    uint splats;
    uint steps;
    uint starts_sum;
    uint octaves;
    uint time_features;
    uint encoding_row;
    uint row_vectors;
    type_3 time;
};
struct NetworkLayer {
    uint inputs;
    uint outputs;
    uint input_row;
    uint output_row;
    uint weights;
    uint encoded_inputs;
    uint row_vectors;
    uint most_parts;
    uint head_row;
};
typedef metal::float4 type_4[1];
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

uint sum_parts(
    uint steps,
    uint most_parts
) {
    return metal::clamp(naga_div(steps, 4u), 1u, most_parts);
}

struct deform_weights_sumInput {
};
[[max_total_threads_per_threadgroup(64)]] kernel void deform_weights_sum(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant NetworkChunk& chunk [[user(fake0)]]
, constant NetworkLayer& layer [[user(fake0)]]
, device type_4 const& parts [[user(fake0)]]
, device type_4& gradients [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    metal::float4 sum = metal::float4(0.0);
    uint part = 0u;
    uint _e3 = flat_group(group, groups);
    uint i = (_e3 * 64u) + thread_;
    uint _e9 = layer.outputs;
    uint _e12 = layer.inputs;
    uint _e16 = layer.outputs;
    uint vectors = naga_div((_e9 * _e12) + _e16, 4u);
    if (i >= vectors) {
        return;
    }
    uint _e26 = chunk.starts_sum;
    if (_e26 == 0u) {
        uint _e32 = layer.weights;
        metal::float4 _e35 = gradients[_e32 + i];
        sum = _e35;
    }
    uint _e38 = chunk.steps;
    uint _e41 = layer.most_parts;
    uint _e42 = sum_parts(_e38, _e41);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e56 = part;
            part = _e56 + 1u;
        }
        loop_init = false;
        uint _e45 = part;
        if (_e45 < _e42) {
        } else {
            break;
        }
        {
            metal::float4 _e47 = sum;
            uint _e49 = part;
            metal::float4 _e53 = parts[(_e49 * vectors) + i];
            sum = _e47 + _e53;
        }
    }
    uint _e61 = layer.weights;
    metal::float4 _e64 = sum;
    gradients[_e61 + i] = _e64;
    return;
}
