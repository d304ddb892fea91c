// Made from shaders/deform_apply_backward.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size2;
    uint size3;
    uint size4;
    uint size5;
    uint size6;
    uint size7;
    uint size8;
    uint size9;
};

struct UnitRotation {
    metal::float4 rotation;
    float length;
    char _pad2[12];
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
typedef metal::float4 type_8[1];
typedef uint type_9[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant float MIN_TRAINED_ROTATION_LENGTH = 0.000000000001;
constant float LOG2_E = 1.442695;
constant float LN_2_HIGH = 0.6933594;
constant float LN_2_LOW = -0.00021219444;
constant float LN_2_ = 0.6931472;
constant float MIN_DEFORMED_SCALE = 0.000001;
constant float MAX_SCALE = 1000000000000.0;
constant float LOWEST_LOG_SCALE = -13.815511;
constant float HIGHEST_LOG_SCALE = 27.631021;
constant float MIN_ROTATION_NORM = 0.000001;

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

UnitRotation unit_rotation(
    metal::float4 q
) {
    bool local = {};
    bool local_1 = {};
    bool local_2 = {};
    bool local_3 = {};
    float largest = metal::max(metal::max(metal::abs(q.x), metal::abs(q.y)), metal::max(metal::abs(q.z), metal::abs(q.w)));
    bool _e13 = is_finite(q.x);
    if (_e13) {
        bool _e17 = is_finite(q.y);
        local = _e17;
    } else {
        local = false;
    }
    bool _e19 = local;
    if (_e19) {
        bool _e23 = is_finite(q.z);
        local_1 = _e23;
    } else {
        local_1 = false;
    }
    bool _e25 = local_1;
    if (_e25) {
        bool _e29 = is_finite(q.w);
        local_2 = _e29;
    } else {
        local_2 = false;
    }
    bool finite = local_2;
    if (!(!(finite))) {
        local_3 = !((largest > 0.0));
    } else {
        local_3 = true;
    }
    bool _e40 = local_3;
    if (_e40) {
        return UnitRotation {metal::float4(1.0, 0.0, 0.0, 0.0), 0.0};
    }
    metal::float4 scaled = q / metal::float4(largest);
    float norm = metal::sqrt(metal::dot(scaled, scaled));
    return UnitRotation {scaled / metal::float4(norm), norm * largest};
}

metal::float4 unit_backward(
    UnitRotation unit,
    metal::float4 by_unit
) {
    if (unit.length < MIN_TRAINED_ROTATION_LENGTH) {
        return metal::float4(0.0);
    }
    return (by_unit - (metal::dot(unit.rotation, by_unit) * unit.rotation)) / metal::float4(unit.length);
}

int naga_f2i32(float value) {
    return static_cast<int>(metal::clamp(value, -2147483600.0, 2147483500.0));
}

float exponential(
    float x_4
) {
    float limited = metal::clamp(x_4, -87.0, 88.0);
    float n = metal::rint(limited * LOG2_E);
    float r = metal::fma(n, 0.00021219444, metal::fma(n, -0.6933594, limited));
    float series = 0.16666667 + (r * (0.041666668 + (r * (0.008333334 + (r * (0.0013888889 + (r / 5040.0)))))));
    float mantissa = 1.0 + (r + ((r * r) * (0.5 + (r * series))));
    return mantissa * as_type<float>(static_cast<uint>(as_type<int>(as_type<uint>(naga_f2i32(n)) + as_type<uint>(127))) << 23u);
}

float logistic(
    float x_5
) {
    float _e3 = exponential(-(metal::abs(x_5)));
    return ((x_5 < 0.0) ? _e3 : 1.0) / (1.0 + _e3);
}

float natural_log(
    float x_6
) {
    int bits = as_type<int>(x_6);
    int exponent = as_type<int>(as_type<uint>(bits) - as_type<uint>(1060439283)) >> 23u;
    float mantissa_1 = as_type<float>(as_type<int>(as_type<uint>(bits) - as_type<uint>(exponent << 23u)));
    float s = (mantissa_1 - 1.0) / (mantissa_1 + 1.0);
    float s2_ = s * s;
    float series_1 = 2.0 + (s2_ * (0.6666667 + (s2_ * (0.4 + (s2_ * (0.2857143 + (s2_ * 0.22222222)))))));
    return (static_cast<float>(exponent) * LN_2_) + (s * series_1);
}

uint sum_parts(
    uint steps,
    uint most_parts
) {
    return metal::clamp(naga_div(steps, 4u), 1u, most_parts);
}

float deformed_log_scale(
    float log_scale,
    float d
) {
    bool local_4 = {};
    bool _e2 = is_nan(log_scale);
    if (!(_e2)) {
        bool _e6 = is_nan(d);
        local_4 = _e6;
    } else {
        local_4 = true;
    }
    bool _e8 = local_4;
    if (_e8) {
        return as_type<float>(2143289344u);
    }
    float _e11 = exponential(log_scale);
    float scale = _e11 + d;
    if (!((scale > MIN_DEFORMED_SCALE))) {
        return LOWEST_LOG_SCALE;
    }
    if (scale >= MAX_SCALE) {
        return HIGHEST_LOG_SCALE;
    }
    float _e20 = natural_log(scale);
    return _e20;
}

metal::float4 deformed_rotation(
    metal::float4 rotation,
    metal::float4 d_1
) {
    UnitRotation _e2 = unit_rotation(rotation);
    metal::float4 sum = _e2.rotation + d_1;
    UnitRotation _e7 = unit_rotation(sum);
    return (_e7.length >= MIN_ROTATION_NORM) ? sum : metal::float4(0.0);
}

float by_scale(
    float gradient,
    float deformed
) {
    bool local_5 = {};
    if (deformed > LOWEST_LOG_SCALE) {
        local_5 = deformed < HIGHEST_LOG_SCALE;
    } else {
        local_5 = false;
    }
    bool _e9 = local_5;
    if (!(_e9)) {
        return 0.0;
    }
    float _e13 = exponential(-(deformed));
    return gradient * _e13;
}

void store_output(
    uint output_2,
    uint column,
    float gradient_1,
    constant NetworkLayer& layer,
    device type_7& activations,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e6 = layer.output_row;
    uint _e12 = layer.row_vectors;
    activations[(((_e6 + output_2) * 4u) * _e12) + column] = gradient_1;
    return;
}

struct deform_apply_backwardInput {
};
[[max_total_threads_per_threadgroup(64)]] kernel void deform_apply_backward(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant NetworkChunk& chunk [[user(fake0)]]
, constant NetworkLayer& layer [[user(fake0)]]
, device type_7 const& log_scales [[user(fake0)]]
, device type_8 const& rotations [[user(fake0)]]
, device type_7 const& deformed_log_scales [[user(fake0)]]
, device type_7 const& by_positions [[user(fake0)]]
, device type_7& by_log_scales [[user(fake0)]]
, device type_8& by_rotations [[user(fake0)]]
, device type_7& activations [[user(fake0)]]
, device type_9 const& order [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint output = 0u;
    uint c = 0u;
    uint c_1 = 0u;
    uint output_1 = 10u;
    uint _e3 = flat_group(group, groups);
    uint column_1 = (_e3 * 64u) + thread_;
    uint _e10 = chunk.steps;
    if (column_1 >= (16u * _e10)) {
        return;
    }
    uint _e15 = chunk.splats;
    if (column_1 >= _e15) {
        bool loop_init = true;
        while(true) {
            if (!loop_init) {
                uint _e27 = output;
                output = _e27 + 1u;
            }
            loop_init = false;
            uint _e19 = output;
            uint _e22 = layer.outputs;
            if (_e19 < _e22) {
            } else {
                break;
            }
            {
                uint _e24 = output;
                store_output(_e24, column_1, 0.0, layer, activations, _buffer_sizes);
            }
        }
        return;
    }
    uint _e32 = chunk.first;
    uint splat = order[_e32 + column_1];
    metal::float4 by_rotation = by_rotations[splat];
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e70 = c;
            c = _e70 + 1u;
        }
        loop_init_1 = false;
        uint _e41 = c;
        if (_e41 < 3u) {
        } else {
            break;
        }
        {
            uint _e46 = c;
            uint at = (3u * splat) + _e46;
            uint _e48 = c;
            float _e51 = by_positions[at];
            store_output(_e48, column_1, _e51, layer, activations, _buffer_sizes);
            float _e54 = by_log_scales[at];
            float _e57 = deformed_log_scales[at];
            float _e58 = by_scale(_e54, _e57);
            uint _e60 = c;
            store_output(7u + _e60, column_1, _e58, layer, activations, _buffer_sizes);
            float _e66 = log_scales[at];
            float _e67 = exponential(_e66);
            by_log_scales[at] = _e58 * _e67;
        }
    }
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e83 = c_1;
            c_1 = _e83 + 1u;
        }
        loop_init_2 = false;
        uint _e74 = c_1;
        if (_e74 < 4u) {
        } else {
            break;
        }
        {
            uint _e78 = c_1;
            uint _e80 = c_1;
            store_output(3u + _e78, column_1, by_rotation[_e80], layer, activations, _buffer_sizes);
        }
    }
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e95 = output_1;
            output_1 = _e95 + 1u;
        }
        loop_init_3 = false;
        uint _e87 = output_1;
        uint _e90 = layer.outputs;
        if (_e87 < _e90) {
        } else {
            break;
        }
        {
            uint _e92 = output_1;
            store_output(_e92, column_1, 0.0, layer, activations, _buffer_sizes);
        }
    }
    metal::float4 _e101 = rotations[splat];
    UnitRotation _e102 = unit_rotation(_e101);
    metal::float4 _e103 = unit_backward(_e102, by_rotation);
    by_rotations[splat] = _e103;
    return;
}
