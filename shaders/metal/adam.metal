// Made from shaders/adam.wgsl by scripts/export-msl.

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
    uint size6;
};

struct type_6 {
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
    type_6 rates;
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
typedef float type_7[1];
typedef metal::atomic_uint type_9[1];
typedef uint type_10[1];
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
constant uint REPORT_WORDS = 8u;
constant uint REPORT_DIFFERENCE = 0u;
constant uint REPORT_DISSIMILARITY = 1u;
constant uint REPORT_IMAGE_NOT_FINITE = 2u;
constant uint REPORT_NOT_FINITE = 3u;
constant uint REPORT_VISIBLE = 4u;
constant uint REPORT_ENTRIES = 5u;
constant uint REPORT_HALTED = 6u;
constant uint REPORT_STEP = 7u;
constant uint LOG_SCALES = 1u;
constant uint OPACITY_LOGITS = 3u;
constant float MAX_ROOT = 18446743000000000000.0;
constant uint GROUP = 0u;
constant uint WIDTH = 1u;

uint flat_group(
    metal::uint3 group_1,
    metal::uint3 groups_1
) {
    return (group_1.y * groups_1.x) + group_1.x;
}

bool is_finite(
    float x
) {
    return (as_type<uint>(x) & 2139095040u) != 2139095040u;
}

int naga_f2i32(float value) {
    return static_cast<int>(metal::clamp(value, -2147483600.0, 2147483500.0));
}

float exponential(
    float x_1
) {
    float limited = metal::clamp(x_1, -87.0, 88.0);
    float n = metal::rint(limited * LOG2_E);
    float r = metal::fma(n, 0.00021219444, metal::fma(n, -0.6933594, limited));
    float series = 0.16666667 + (r * (0.041666668 + (r * (0.008333334 + (r * (0.0013888889 + (r / 5040.0)))))));
    float mantissa = 1.0 + (r + ((r * r) * (0.5 + (r * series))));
    return mantissa * as_type<float>(static_cast<uint>(as_type<int>(as_type<uint>(naga_f2i32(n)) + as_type<uint>(127))) << 23u);
}

float logistic(
    float x_2
) {
    float _e3 = exponential(-(metal::abs(x_2)));
    return ((x_2 < 0.0) ? _e3 : 1.0) / (1.0 + _e3);
}

uint report_word(
    uint slot,
    uint word
) {
    return (slot * REPORT_WORDS) + word;
}

float pressure(
    float parameter,
    constant TrainingStep& training
) {
    if (false) {
        float _e8 = training.opacity_pressure;
        float _e9 = logistic(parameter);
        float _e11 = logistic(-(parameter));
        return _e8 * (_e9 * _e11);
    }
    if (false) {
        float _e21 = training.scale_pressure;
        float _e22 = exponential(parameter);
        return _e21 * _e22;
    }
    return 0.0;
}

struct adamInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void adam(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant TrainingStep& training [[user(fake0)]]
, device type_7& parameters [[user(fake0)]]
, device type_7 const& gradients [[user(fake0)]]
, device type_7& first_moments [[user(fake0)]]
, device type_7& second_moments [[user(fake0)]]
, device type_9& reports [[user(fake0)]]
, device type_10 const& counts [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    bool local = {};
    bool local_1 = {};
    bool local_2 = {};
    bool local_3 = {};
    bool local_4 = {};
    uint _e3 = flat_group(group, groups);
    uint i = (_e3 * 256u) + thread_;
    uint _e9 = training.splats;
    if (!((i >= (_e9 * WIDTH)))) {
        uint _e18 = counts[5];
        local = _e18 != 0u;
    } else {
        local = true;
    }
    bool _e22 = local;
    if (_e22) {
        return;
    }
    float parameter_1 = parameters[i];
    float stored = gradients[i];
    float _e29 = pressure(parameter_1, training);
    float gradient = stored + _e29;
    float _e33 = training.beta1_;
    float _e36 = first_moments[i];
    float _e40 = training.one_minus_beta1_;
    float mean = (_e33 * _e36) + (_e40 * gradient);
    float _e45 = training.beta2_;
    float _e48 = second_moments[i];
    float _e52 = training.one_minus_beta2_;
    float square = (_e45 * _e48) + (_e52 * (gradient * gradient));
    float rate = training.rates.inner[0u][0u];
    float _e73 = training.second_correction;
    float _e77 = training.epsilon;
    float moved = parameter_1 - ((rate * mean) / ((metal::sqrt(square) * _e73) + _e77));
    bool _e81 = is_finite(parameter_1);
    if (_e81) {
        bool _e84 = is_finite(stored);
        local_1 = _e84;
    } else {
        local_1 = false;
    }
    bool _e86 = local_1;
    if (_e86) {
        local_2 = metal::abs(gradient) <= MAX_ROOT;
    } else {
        local_2 = false;
    }
    bool _e93 = local_2;
    if (_e93) {
        bool _e96 = is_finite(square);
        local_3 = _e96;
    } else {
        local_3 = false;
    }
    bool _e98 = local_3;
    if (_e98) {
        bool _e101 = is_finite(moved);
        local_4 = _e101;
    } else {
        local_4 = false;
    }
    bool usable = local_4;
    if (usable) {
        parameters[i] = moved;
        first_moments[i] = mean;
        second_moments[i] = square;
        return;
    } else {
        uint _e113 = training.slot;
        uint _e115 = report_word(_e113, REPORT_NOT_FINITE);
        uint _e118 = metal::atomic_fetch_add_explicit(&reports[_e115], 1u, metal::memory_order_relaxed);
        return;
    }
}
