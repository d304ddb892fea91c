// Made from shaders/deform_encode.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size1;
    uint size2;
    uint size3;
};

struct type_6 {
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
    type_6 time;
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
typedef float type_7[1];
typedef uint type_8[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant float TAU = 6.2831855;
constant float INVERSE_TAU_1_ = 0.15911865;
constant float INVERSE_TAU_2_ = 0.000036284328;
constant float INVERSE_TAU_3_ = 0.0000000064206382;

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

metal::float4 turns_of(
    float x_4
) {
    float high = as_type<float>(as_type<uint>(x_4) & 4294963200u);
    float low = x_4 - high;
    return metal::float4(high * INVERSE_TAU_1_, low * INVERSE_TAU_1_, high * INVERSE_TAU_2_, (low * INVERSE_TAU_2_) + (x_4 * INVERSE_TAU_3_));
}

float without_whole(
    float x_5
) {
    return x_5 - metal::rint(x_5);
}

int naga_f2i32(float value) {
    return static_cast<int>(metal::clamp(value, -2147483600.0, 2147483500.0));
}

metal::float2 sin_cos_of_turns(
    metal::float4 turns,
    float scale,
    float offset
) {
    metal::float2 pair = {};
    metal::float4 scaled = turns * scale;
    metal::float4 parts = scaled - metal::rint(scaled);
    float _e14 = without_whole(((parts.x + offset) + (parts.y + parts.z)) + parts.w);
    float quarters = metal::rint(_e14 * 4.0);
    float r = (_e14 - (0.25 * quarters)) * TAU;
    float r2_ = r * r;
    float sine = r + ((r * r2_) * (-0.16666655 + (r2_ * (0.008332161 + (r2_ * -0.00019515296)))));
    float cosine = (1.0 - (0.5 * r2_)) + ((r2_ * r2_) * (0.041666646 + (r2_ * (-0.0013887316 + (r2_ * 0.000024433157)))));
    int quadrant = naga_f2i32(quarters) & 3;
    pair = metal::float2(sine, cosine);
    if ((quadrant & 1) == 1) {
        pair = metal::float2(cosine, -(sine));
    }
    if (quadrant >= 2) {
        metal::float2 _e61 = pair;
        pair = -(_e61);
    }
    metal::float2 _e63 = pair;
    return _e63;
}

uint sum_parts(
    uint steps,
    uint most_parts
) {
    return metal::clamp(naga_div(steps, 4u), 1u, most_parts);
}

void store_feature(
    uint feature_1,
    uint column,
    float value,
    constant NetworkChunk& chunk,
    device type_7& activations,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e6 = chunk.encoding_row;
    uint _e12 = chunk.row_vectors;
    activations[(((_e6 + feature_1) * 4u) * _e12) + column] = value;
    return;
}

struct deform_encodeInput {
};
[[max_total_threads_per_threadgroup(64)]] kernel void deform_encode(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant NetworkChunk& chunk [[user(fake0)]]
, device type_7 const& positions [[user(fake0)]]
, device type_7& activations [[user(fake0)]]
, device type_8 const& order [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    metal::float3 position = metal::float3(0.0);
    bool is_known = false;
    bool local = {};
    bool local_1 = {};
    uint axis = 0u;
    uint octave = {};
    uint feature = 0u;
    uint _e3 = flat_group(group, groups);
    uint column_1 = (_e3 * 64u) + thread_;
    uint _e10 = chunk.steps;
    if (column_1 >= (16u * _e10)) {
        return;
    }
    uint _e20 = chunk.splats;
    if (column_1 < _e20) {
        uint _e26 = chunk.first;
        uint _e29 = order[_e26 + column_1];
        uint at = 3u * _e29;
        float _e33 = positions[at];
        float _e38 = positions[at + 1u];
        float _e43 = positions[at + 2u];
        position = metal::float3(_e33, _e38, _e43);
        float _e46 = position.x;
        bool _e47 = is_finite(_e46);
        if (_e47) {
            float _e51 = position.y;
            bool _e52 = is_finite(_e51);
            local = _e52;
        } else {
            local = false;
        }
        bool _e54 = local;
        if (_e54) {
            float _e58 = position.z;
            bool _e59 = is_finite(_e58);
            local_1 = _e59;
        } else {
            local_1 = false;
        }
        bool _e61 = local_1;
        is_known = _e61;
    }
    bool _e62 = is_known;
    float present = _e62 ? 1.0 : 0.0;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e114 = axis;
            axis = _e114 + 1u;
        }
        loop_init = false;
        uint _e68 = axis;
        if (_e68 < 3u) {
        } else {
            break;
        }
        {
            uint _e71 = axis;
            float _e73 = position[_e71];
            bool _e74 = is_known;
            float coordinate = _e74 ? _e73 : 0.0;
            uint _e77 = axis;
            store_feature(_e77, column_1, coordinate, chunk, activations, _buffer_sizes);
            metal::float4 _e78 = turns_of(coordinate);
            octave = 0u;
            bool loop_init_1 = true;
            while(true) {
                if (!loop_init_1) {
                    uint _e111 = octave;
                    octave = _e111 + 1u;
                }
                loop_init_1 = false;
                uint _e81 = octave;
                uint _e84 = chunk.octaves;
                if (_e81 < _e84) {
                } else {
                    break;
                }
                {
                    uint _e87 = octave;
                    metal::float2 _e91 = sin_cos_of_turns(_e78, static_cast<float>(1u << _e87), 0.0);
                    uint _e94 = octave;
                    uint _e97 = axis;
                    store_feature((3u + (6u * _e94)) + _e97, column_1, present * _e91.x, chunk, activations, _buffer_sizes);
                    uint _e103 = octave;
                    uint _e106 = axis;
                    store_feature((6u + (6u * _e103)) + _e106, column_1, present * _e91.y, chunk, activations, _buffer_sizes);
                }
            }
        }
    }
    uint _e120 = chunk.octaves;
    uint after = 3u + (6u * _e120);
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e145 = feature;
            feature = _e145 + 1u;
        }
        loop_init_2 = false;
        uint _e125 = feature;
        uint _e128 = chunk.time_features;
        if (_e125 < _e128) {
        } else {
            break;
        }
        {
            uint _e130 = feature;
            uint _e134 = feature;
            uint _e138 = feature;
            float _e142 = chunk.time.inner[naga_div(_e134, 4u)][naga_mod(_e138, 4u)];
            store_feature(after + _e130, column_1, present * _e142, chunk, activations, _buffer_sizes);
        }
    }
    return;
}
