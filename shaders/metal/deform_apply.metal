// Made from shaders/deform_apply.wgsl by scripts/export-msl.

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
    uint size10;
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
typedef metal::float4 type_7[1];
typedef float type_8[1];
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

float part_of_output(
    uint output,
    uint vector_1,
    metal::float4 h,
    constant NetworkLayer& layer,
    device type_7 const& parameters,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e6 = layer.weights;
    uint _e9 = layer.inputs;
    metal::float4 _e16 = parameters[(_e6 + (output * naga_div(_e9, 4u))) + vector_1];
    return metal::dot(_e16, h);
}

struct deform_applyInput {
};
[[max_total_threads_per_threadgroup(64)]] kernel void deform_apply(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant NetworkChunk& chunk [[user(fake0)]]
, constant NetworkLayer& layer [[user(fake0)]]
, device type_7 const& parameters [[user(fake0)]]
, device type_8 const& activations [[user(fake0)]]
, device type_8 const& positions [[user(fake0)]]
, device type_8 const& log_scales [[user(fake0)]]
, device type_7 const& rotations [[user(fake0)]]
, device type_8& deformed_positions [[user(fake0)]]
, device type_8& deformed_log_scales [[user(fake0)]]
, device type_7& deformed_rotations [[user(fake0)]]
, device type_9 const& order [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    metal::float4 first = {};
    metal::float4 second = {};
    metal::float2 third = {};
    uint vector = 0u;
    uint _e3 = flat_group(group, groups);
    uint column = (_e3 * 64u) + thread_;
    uint _e9 = chunk.splats;
    if (column >= _e9) {
        return;
    }
    uint _e13 = layer.weights;
    uint _e16 = layer.outputs;
    uint _e19 = layer.inputs;
    uint biases = _e13 + naga_div(_e16 * _e19, 4u);
    metal::float4 _e26 = parameters[biases];
    first = _e26;
    metal::float4 _e32 = parameters[biases + 1u];
    second = _e32;
    metal::float4 _e38 = parameters[biases + 2u];
    third = _e38.xy;
    uint _e44 = layer.row_vectors;
    uint stride = 4u * _e44;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e124 = vector;
            vector = _e124 + 1u;
        }
        loop_init = false;
        uint _e48 = vector;
        uint _e51 = layer.inputs;
        if (_e48 < naga_div(_e51, 4u)) {
        } else {
            break;
        }
        {
            uint _e57 = layer.input_row;
            uint _e59 = vector;
            uint at = ((_e57 + (4u * _e59)) * stride) + column;
            float _e66 = activations[at];
            float _e70 = activations[at + stride];
            float _e76 = activations[at + (2u * stride)];
            float _e82 = activations[at + (3u * stride)];
            metal::float4 h_1 = metal::float4(_e66, _e70, _e76, _e82);
            metal::float4 _e84 = first;
            uint _e86 = vector;
            float _e87 = part_of_output(0u, _e86, h_1, layer, parameters, _buffer_sizes);
            uint _e89 = vector;
            float _e90 = part_of_output(1u, _e89, h_1, layer, parameters, _buffer_sizes);
            uint _e92 = vector;
            float _e93 = part_of_output(2u, _e92, h_1, layer, parameters, _buffer_sizes);
            uint _e95 = vector;
            float _e96 = part_of_output(3u, _e95, h_1, layer, parameters, _buffer_sizes);
            first = _e84 + metal::float4(_e87, _e90, _e93, _e96);
            metal::float4 _e99 = second;
            uint _e101 = vector;
            float _e102 = part_of_output(4u, _e101, h_1, layer, parameters, _buffer_sizes);
            uint _e104 = vector;
            float _e105 = part_of_output(5u, _e104, h_1, layer, parameters, _buffer_sizes);
            uint _e107 = vector;
            float _e108 = part_of_output(6u, _e107, h_1, layer, parameters, _buffer_sizes);
            uint _e110 = vector;
            float _e111 = part_of_output(7u, _e110, h_1, layer, parameters, _buffer_sizes);
            second = _e99 + metal::float4(_e102, _e105, _e108, _e111);
            metal::float2 _e114 = third;
            uint _e116 = vector;
            float _e117 = part_of_output(8u, _e116, h_1, layer, parameters, _buffer_sizes);
            uint _e119 = vector;
            float _e120 = part_of_output(9u, _e119, h_1, layer, parameters, _buffer_sizes);
            third = _e114 + metal::float2(_e117, _e120);
        }
    }
    uint _e129 = chunk.first;
    uint splat = order[_e129 + column];
    uint at_1 = 3u * splat;
    float _e139 = positions[at_1];
    float _e141 = first.x;
    deformed_positions[at_1] = _e139 + _e141;
    float _e151 = positions[at_1 + 1u];
    float _e153 = first.y;
    deformed_positions[at_1 + 1u] = _e151 + _e153;
    float _e163 = positions[at_1 + 2u];
    float _e165 = first.z;
    deformed_positions[at_1 + 2u] = _e163 + _e165;
    float _e168 = first.w;
    metal::float4 _e169 = second;
    metal::float4 d_rotation = metal::float4(_e168, _e169.xyz);
    metal::float4 _e176 = rotations[splat];
    metal::float4 _e177 = deformed_rotation(_e176, d_rotation);
    deformed_rotations[splat] = _e177;
    float _e182 = log_scales[at_1];
    float _e184 = second.w;
    float _e185 = deformed_log_scale(_e182, _e184);
    deformed_log_scales[at_1] = _e185;
    float _e194 = log_scales[at_1 + 1u];
    float _e196 = third.x;
    float _e197 = deformed_log_scale(_e194, _e196);
    deformed_log_scales[at_1 + 1u] = _e197;
    float _e206 = log_scales[at_1 + 2u];
    float _e208 = third.y;
    float _e209 = deformed_log_scale(_e206, _e208);
    deformed_log_scales[at_1 + 2u] = _e209;
    return;
}
