// Made from shaders/noise.wgsl by scripts/export-msl.

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

struct type_8 {
    metal::float4 inner[2];
};
struct TrainingStep {
    uint splats;
    uint step;
    metal::uint2 seed;
    metal::float4 background;
    metal::uint2 image;
    metal::uint2 tiles;
    float l1_scale;
    float ssim_scale;
    uint weighted;
    uint slot;
    type_8 rates;
    float beta1_;
    float one_minus_beta1_;
    float beta2_;
    float one_minus_beta2_;
    float second_correction;
    float epsilon;
    float opacity_pressure;
    float scale_pressure;
    float noise_amplitude;
    float gate_steepness;
    float gate_opacity;
    uint zero;
};
typedef float type_9[1];
typedef metal::float4 type_10[1];
typedef uint type_11[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint VISIBLE = 0u;
constant uint ENTRIES = 1u;
constant uint SORTED_ENTRIES = 2u;
constant uint DYNAMIC = 3u;
constant uint MOST_ENTRIES = 4u;
constant uint HALTED = 5u;
constant uint DRAWN_FRAMES = 6u;
constant float LOG2_E = 1.442695;
constant float LN_2_HIGH = 0.6933594;
constant float LN_2_LOW = -0.00021219444;
constant float LN_2_ = 0.6931472;
constant uint PURPOSE_NOISE = 3u;
constant uint PURPOSE_RELOCATION = 4u;
constant uint PURPOSE_GROWTH = 5u;
constant uint REPORT_WORDS = 8u;
constant uint REPORT_DIFFERENCE = 0u;
constant uint REPORT_DISSIMILARITY = 1u;
constant uint REPORT_IMAGE_NOT_FINITE = 2u;
constant uint REPORT_NOT_FINITE = 3u;
constant uint REPORT_VISIBLE = 4u;
constant uint REPORT_ENTRIES = 5u;
constant uint REPORT_HALTED = 6u;
constant uint REPORT_STEP = 7u;
constant float MIN_NORMAL = 0.000000000000000000000000000000000000011754944;

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

uint multiply_high(
    uint a_4,
    uint b_4
) {
    uint a_low_1 = a_4 & 65535u;
    uint a_high = a_4 >> 16u;
    uint b_low_1 = b_4 & 65535u;
    uint b_high = b_4 >> 16u;
    uint first = (a_high * b_low_1) + ((a_low_1 * b_low_1) >> 16u);
    uint second = (a_low_1 * b_high) + (first & 65535u);
    return ((a_high * b_high) + (first >> 16u)) + (second >> 16u);
}

metal::uint4 random_words(
    metal::uint2 seed,
    uint purpose,
    uint step,
    uint index
) {
    metal::uint4 counter = {};
    metal::uint2 key = {};
    uint round = 0u;
    counter = metal::uint4(index, 0u, step, purpose);
    key = seed;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e48 = round;
            round = _e48 + 1u;
        }
        loop_init = false;
        uint _e10 = round;
        if (_e10 < 10u) {
        } else {
            break;
        }
        {
            uint _e15 = counter.z;
            uint _e16 = multiply_high(3449720151u, _e15);
            uint _e18 = counter.y;
            uint _e21 = key.x;
            uint _e25 = counter.z;
            uint _e29 = counter.x;
            uint _e30 = multiply_high(3528531795u, _e29);
            uint _e32 = counter.w;
            uint _e35 = key.y;
            uint _e39 = counter.x;
            counter = metal::uint4((_e16 ^ _e18) ^ _e21, 3449720151u * _e25, (_e30 ^ _e32) ^ _e35, 3528531795u * _e39);
            metal::uint2 _e42 = key;
            key = _e42 + metal::uint2(2654435769u, 3144134277u);
        }
    }
    metal::uint4 _e50 = counter;
    return _e50;
}

float normal_number(
    uint word
) {
    float ratio = 0.0;
    bool upper = (word >> 31u) == 1u;
    uint k = upper ? ~(word) : word;
    float p = (static_cast<float>(k) + 0.5) * 0.00000000023283064;
    float _e17 = natural_log((4.0 * p) * (1.0 - p));
    float w = -(_e17);
    if (w < 5.0) {
        float x_7 = w - 2.5;
        ratio = 0.000000028102264;
        float _e26 = ratio;
        ratio = (_e26 * x_7) + 0.00000034327394;
        float _e30 = ratio;
        ratio = (_e30 * x_7) - 0.0000035233877;
        float _e34 = ratio;
        ratio = (_e34 * x_7) - 0.0000043915065;
        float _e38 = ratio;
        ratio = (_e38 * x_7) + 0.00021858087;
        float _e42 = ratio;
        ratio = (_e42 * x_7) - 0.0012537251;
        float _e46 = ratio;
        ratio = (_e46 * x_7) - 0.0041776816;
        float _e50 = ratio;
        ratio = (_e50 * x_7) + 0.24664073;
        float _e54 = ratio;
        ratio = (_e54 * x_7) + 1.5014094;
    } else {
        float x_8 = metal::sqrt(w) - 3.4;
        ratio = 0.000004827362;
        float _e62 = ratio;
        ratio = (_e62 * x_8) - 0.00018134432;
        float _e66 = ratio;
        ratio = (_e66 * x_8) + 0.0006654724;
        float _e70 = ratio;
        ratio = (_e70 * x_8) - 0.0011195377;
        float _e74 = ratio;
        ratio = (_e74 * x_8) + 0.0014981556;
        float _e78 = ratio;
        ratio = (_e78 * x_8) - 0.0025249582;
        float _e82 = ratio;
        ratio = (_e82 * x_8) + 0.003966079;
        float _e86 = ratio;
        ratio = (_e86 * x_8) + 1.0066411;
        float _e90 = ratio;
        ratio = (_e90 * x_8) + 3.234784;
    }
    float _e94 = ratio;
    float magnitude = (1.4142135 * _e94) * (1.0 - (2.0 * p));
    return upper ? magnitude : -(magnitude);
}

uint report_word(
    uint slot,
    uint word_1
) {
    return (slot * REPORT_WORDS) + word_1;
}

metal::float3 turned(
    metal::float4 q,
    metal::float3 v
) {
    float largest = metal::max(metal::max(metal::abs(q.x), metal::abs(q.y)), metal::max(metal::abs(q.z), metal::abs(q.w)));
    metal::float4 scaled = q / metal::float4(metal::max(largest, MIN_NORMAL));
    float factor = 2.0 / metal::max(metal::dot(scaled, scaled), MIN_NORMAL);
    metal::float3 once = metal::cross(scaled.yzw, v);
    return v + (factor * ((scaled.x * once) + metal::cross(scaled.yzw, once)));
}

struct noiseInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void noise(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant TrainingStep& training [[user(fake0)]]
, device type_9& positions [[user(fake0)]]
, device type_9 const& log_scales [[user(fake0)]]
, device type_10 const& rotations [[user(fake0)]]
, device type_9 const& opacity_logits [[user(fake0)]]
, device type_11 const& counts [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    bool local = {};
    bool local_1 = {};
    bool local_2 = {};
    bool local_3 = {};
    bool local_4 = {};
    bool local_5 = {};
    bool local_6 = {};
    bool local_7 = {};
    bool local_8 = {};
    bool local_9 = {};
    bool local_10 = {};
    uint _e3 = flat_group(group, groups);
    uint i = (_e3 * 256u) + thread_;
    uint _e9 = training.splats;
    if (!((i >= _e9))) {
        uint _e16 = counts[5];
        local = _e16 != 0u;
    } else {
        local = true;
    }
    bool _e20 = local;
    if (_e20) {
        return;
    }
    float logit = opacity_logits[i];
    metal::float4 q_1 = rotations[i];
    float _e31 = log_scales[3u * i];
    float _e38 = log_scales[(3u * i) + 1u];
    float _e45 = log_scales[(3u * i) + 2u];
    metal::float3 scale = metal::float3(_e31, _e38, _e45);
    bool _e47 = is_nan(logit);
    if (!(_e47)) {
        bool _e52 = is_nan(scale.x);
        if (!(_e52)) {
            bool _e57 = is_nan(scale.y);
            local_2 = _e57;
        } else {
            local_2 = true;
        }
        bool _e59 = local_2;
        if (!(_e59)) {
            bool _e64 = is_nan(scale.z);
            local_3 = _e64;
        } else {
            local_3 = true;
        }
        bool _e66 = local_3;
        local_1 = !(_e66);
    } else {
        local_1 = false;
    }
    bool _e69 = local_1;
    if (_e69) {
        bool _e73 = is_finite(q_1.x);
        local_4 = _e73;
    } else {
        local_4 = false;
    }
    bool _e75 = local_4;
    if (_e75) {
        bool _e79 = is_finite(q_1.y);
        local_5 = _e79;
    } else {
        local_5 = false;
    }
    bool _e81 = local_5;
    if (_e81) {
        bool _e85 = is_finite(q_1.z);
        local_6 = _e85;
    } else {
        local_6 = false;
    }
    bool _e87 = local_6;
    if (_e87) {
        bool _e91 = is_finite(q_1.w);
        local_7 = _e91;
    } else {
        local_7 = false;
    }
    bool known = local_7;
    float _e96 = training.gate_steepness;
    float _e99 = training.gate_opacity;
    float _e100 = logistic(logit);
    float _e103 = logistic(_e96 * (_e99 - _e100));
    float _e106 = training.noise_amplitude;
    float amplitude = _e106 * _e103;
    metal::uint2 _e110 = training.seed;
    uint _e114 = training.step;
    metal::uint4 _e115 = random_words(_e110, PURPOSE_NOISE, _e114, i);
    float _e119 = exponential(2.0 * scale.x);
    float _e121 = normal_number(_e115.x);
    float _e126 = exponential(2.0 * scale.y);
    float _e128 = normal_number(_e115.y);
    float _e133 = exponential(2.0 * scale.z);
    float _e135 = normal_number(_e115.z);
    metal::float3 along_axes = amplitude * metal::float3(_e119 * _e121, _e126 * _e128, _e133 * _e135);
    float _e143 = positions[3u * i];
    float _e150 = positions[(3u * i) + 1u];
    float _e157 = positions[(3u * i) + 2u];
    metal::float3 position = metal::float3(_e143, _e150, _e157);
    metal::float3 _e159 = turned(q_1, along_axes);
    metal::float3 moved = position + _e159;
    if (known) {
        bool _e164 = is_finite(moved.x);
        local_8 = _e164;
    } else {
        local_8 = false;
    }
    bool _e166 = local_8;
    if (_e166) {
        bool _e170 = is_finite(moved.y);
        local_9 = _e170;
    } else {
        local_9 = false;
    }
    bool _e172 = local_9;
    if (_e172) {
        bool _e176 = is_finite(moved.z);
        local_10 = _e176;
    } else {
        local_10 = false;
    }
    bool _e178 = local_10;
    if (_e178) {
        positions[3u * i] = moved.x;
        positions[(3u * i) + 1u] = moved.y;
        positions[(3u * i) + 2u] = moved.z;
        return;
    } else {
        return;
    }
}
