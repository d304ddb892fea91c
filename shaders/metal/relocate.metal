// Made from shaders/relocate.wgsl by scripts/export-msl.

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
};

struct type_5 {
    uint inner[256];
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
typedef uint type_8[1];
typedef metal::atomic_uint type_10[1];
typedef float type_11[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint VISIBLE = 0u;
constant uint ENTRIES = 1u;
constant uint SORTED_ENTRIES = 2u;
constant uint DYNAMIC = 3u;
constant uint MOST_ENTRIES = 4u;
constant uint HALTED = 5u;
constant uint DRAWN_FRAMES = 6u;
constant uint SCAN_WIDTH = 256u;
constant float LOG2_E = 1.442695;
constant float LN_2_HIGH = 0.6933594;
constant float LN_2_LOW = -0.00021219444;
constant float LN_2_ = 0.6931472;
constant uint PURPOSE_NOISE = 3u;
constant uint PURPOSE_RELOCATION = 4u;
constant uint PURPOSE_GROWTH = 5u;
constant uint NO_HOST = 4294967295u;
constant uint DEAD = 4294967294u;
constant uint MAX_COPIES = 51u;
constant float MAX_LOGIT = 15.942385;
constant float MIN_LOGIT = -80.0;
constant float SQRT_TAU = 2.5066283;

uint flat_group(
    metal::uint3 group_2,
    metal::uint3 groups_2
) {
    return (group_2.y * groups_2.x) + group_2.x;
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

uint saturating_add(
    uint a_4,
    uint b_4
) {
    uint sum_2 = a_4 + b_4;
    return (sum_2 < a_4) ? 4294967295u : sum_2;
}

uint inclusive_scan(
    uint thread_3,
    uint value,
    threadgroup type_5& scan_values
) {
    uint sum = {};
    uint distance = 1u;
    uint left = {};
    sum = value;
    uint _e5 = sum;
    scan_values.inner[thread_3] = _e5;
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e26 = distance;
            distance = _e26 * 2u;
        }
        loop_init = false;
        uint _e8 = distance;
        if (_e8 < SCAN_WIDTH) {
        } else {
            break;
        }
        {
            left = 0u;
            uint _e13 = distance;
            if (thread_3 >= _e13) {
                uint _e16 = distance;
                uint _e19 = scan_values.inner[thread_3 - _e16];
                left = _e19;
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e20 = sum;
            uint _e21 = left;
            uint _e22 = saturating_add(_e20, _e21);
            sum = _e22;
            uint _e25 = sum;
            scan_values.inner[thread_3] = _e25;
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
        }
    }
    uint _e29 = sum;
    return _e29;
}

void scan_barrier(
) {
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    return;
}

int naga_f2i32(float value) {
    return static_cast<int>(metal::clamp(value, -2147483600.0, 2147483500.0));
}

float exponential(
    float x_4
) {
    float limited = metal::clamp(x_4, -87.0, 88.0);
    float n_2 = metal::rint(limited * LOG2_E);
    float r = metal::fma(n_2, 0.00021219444, metal::fma(n_2, -0.6933594, limited));
    float series_2 = 0.16666667 + (r * (0.041666668 + (r * (0.008333334 + (r * (0.0013888889 + (r / 5040.0)))))));
    float mantissa = 1.0 + (r + ((r * r) * (0.5 + (r * series_2))));
    return mantissa * as_type<float>(static_cast<uint>(as_type<int>(as_type<uint>(naga_f2i32(n_2)) + as_type<uint>(127))) << 23u);
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
    float series_3 = 2.0 + (s2_ * (0.6666667 + (s2_ * (0.4 + (s2_ * (0.2857143 + (s2_ * 0.22222222)))))));
    return (static_cast<float>(exponent) * LN_2_) + (s * series_3);
}

uint multiply_high(
    uint a_5,
    uint b_5
) {
    uint a_low_1 = a_5 & 65535u;
    uint a_high = a_5 >> 16u;
    uint b_low_1 = b_5 & 65535u;
    uint b_high = b_5 >> 16u;
    uint first_2 = (a_high * b_low_1) + ((a_low_1 * b_low_1) >> 16u);
    uint second = (a_low_1 * b_high) + (first_2 & 65535u);
    return ((a_high * b_high) + (first_2 >> 16u)) + (second >> 16u);
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
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e48 = round;
            round = _e48 + 1u;
        }
        loop_init_1 = false;
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
    uint k_1 = upper ? ~(word) : word;
    float p = (static_cast<float>(k_1) + 0.5) * 0.00000000023283064;
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

uint first_above(
    uint below,
    constant Densification& densification,
    device type_8 const& sums,
    device type_8 const& block_sums,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint first_1 = 0u;
    uint end = {};
    uint _e5 = densification.splats;
    end = _e5;
    while(true) {
        uint _e7 = first_1;
        uint _e8 = end;
        if (_e7 < _e8) {
        } else {
            break;
        }
        {
            uint _e10 = first_1;
            uint _e11 = end;
            uint _e12 = first_1;
            uint middle = _e10 + naga_div(_e11 - _e12, 2u);
            uint _e21 = block_sums[naga_div(middle, 256u)];
            uint _e24 = sums[middle];
            if ((_e21 + _e24) <= below) {
                first_1 = middle + 1u;
            } else {
                end = middle;
            }
        }
    }
    uint _e29 = first_1;
    return _e29;
}

float log_one_plus(
    float u
) {
    float series = 0.06666667;
    float s_1 = u / (2.0 + u);
    float s2_1 = s_1 * s_1;
    float _e7 = series;
    series = (_e7 * s2_1) + 0.07692308;
    float _e11 = series;
    series = (_e11 * s2_1) + 0.09090909;
    float _e15 = series;
    series = (_e15 * s2_1) + 0.11111111;
    float _e19 = series;
    series = (_e19 * s2_1) + 0.14285715;
    float _e23 = series;
    series = (_e23 * s2_1) + 0.2;
    float _e27 = series;
    series = (_e27 * s2_1) + 0.33333334;
    float _e33 = series;
    return (2.0 * s_1) * (1.0 + (_e33 * s2_1));
}

float one_minus_exponential(
    float t
) {
    float series_1 = {};
    if (t > 0.5) {
        float _e4 = exponential(-(t));
        return 1.0 - _e4;
    }
    series_1 = 1.0 - (t / 9.0);
    float _e14 = series_1;
    series_1 = 1.0 - ((t / 8.0) * _e14);
    float _e20 = series_1;
    series_1 = 1.0 - ((t / 7.0) * _e20);
    float _e26 = series_1;
    series_1 = 1.0 - ((t / 6.0) * _e26);
    float _e32 = series_1;
    series_1 = 1.0 - ((t / 5.0) * _e32);
    float _e38 = series_1;
    series_1 = 1.0 - ((t / 4.0) * _e38);
    float _e44 = series_1;
    series_1 = 1.0 - ((t / 3.0) * _e44);
    float _e50 = series_1;
    return t * (1.0 - ((t / 2.0) * _e50));
}

float share_of_copies(
    float a_6,
    uint n
) {
    float share = 0.0;
    uint bit = 32u;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e24 = bit;
            bit = naga_div(_e24, 2u);
        }
        loop_init_2 = false;
        uint _e6 = bit;
        if (_e6 > 0u) {
        } else {
            break;
        }
        {
            float _e9 = share;
            float _e10 = share;
            share = _e9 * (2.0 - _e10);
            uint _e14 = bit;
            if ((n & _e14) != 0u) {
                float _e18 = share;
                float _e19 = share;
                share = _e18 + (a_6 * (1.0 - _e19));
            }
        }
    }
    float _e27 = share;
    return _e27;
}

float profile_of_copies(
    float opacity,
    uint n_1
) {
    float sum_1 = 0.0;
    uint k = 52u;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e22 = k;
            k = _e22 - 1u;
        }
        loop_init_3 = false;
        uint _e7 = k;
        if (_e7 > 0u) {
        } else {
            break;
        }
        {
            uint _e10 = k;
            float x_9 = static_cast<float>(_e10) * 0.125;
            float _e13 = sum_1;
            float _e17 = exponential((-0.5 * x_9) * x_9);
            float _e19 = share_of_copies(opacity * _e17, n_1);
            sum_1 = _e13 + _e19;
        }
    }
    float _e24 = share_of_copies(opacity, n_1);
    float _e25 = sum_1;
    return 0.125 * (_e24 + (2.0 * _e25));
}

struct sum_blocksInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void sum_blocks(
  uint thread_ [[thread_index_in_threadgroup]]
, threadgroup type_5& scan_values
, constant Densification& densification [[user(fake0)]]
, device type_8& block_sums [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint before = 0u;
    uint first = 0u;
    uint own = {};
    uint _e3 = densification.splats;
    uint _e5 = divide_up(_e3, 256u);
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e34 = first;
            first = _e34 + SCAN_WIDTH;
        }
        loop_init_4 = false;
        uint _e10 = first;
        if (_e10 < _e5) {
        } else {
            break;
        }
        {
            uint _e12 = first;
            uint block = _e12 + thread_;
            own = 0u;
            if (block < _e5) {
                uint _e19 = block_sums[block];
                own = _e19;
            }
            uint _e20 = own;
            uint _e21 = inclusive_scan(thread_, _e20, scan_values);
            if (block < _e5) {
                uint _e25 = before;
                uint _e27 = own;
                block_sums[block] = (_e25 + _e21) - _e27;
            }
            uint _e29 = before;
            uint _e32 = scan_values.inner[255];
            before = _e29 + _e32;
            scan_barrier();
        }
    }
    if (thread_ == 0u) {
        uint _e41 = before;
        block_sums[_e5] = _e41;
        return;
    } else {
        return;
    }
}


struct drawInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void draw(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_1 [[thread_index_in_threadgroup]]
, constant Densification& densification [[user(fake0)]]
, device type_8 const& sums [[user(fake0)]]
, device type_8 const& block_sums [[user(fake0)]]
, device type_8& hosts [[user(fake0)]]
, device type_10& copies [[user(fake0)]]
, device type_8 const& counts [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    bool wants_host = {};
    uint host = NO_HOST;
    bool local = {};
    uint _e3 = flat_group(group, groups);
    uint i = (_e3 * 256u) + thread_1;
    uint _e9 = densification.count;
    if (i >= _e9) {
        return;
    }
    uint _e13 = densification.splats;
    wants_host = i >= _e13;
    uint _e18 = densification.purpose;
    if (_e18 == PURPOSE_RELOCATION) {
        uint _e23 = hosts[i];
        wants_host = _e23 == DEAD;
    }
    bool _e28 = wants_host;
    if (_e28) {
        uint _e33 = counts[5];
        local = _e33 == 0u;
    } else {
        local = false;
    }
    bool _e37 = local;
    if (_e37) {
        metal::uint2 _e40 = densification.seed;
        uint _e43 = densification.purpose;
        uint _e46 = densification.step;
        metal::uint4 _e47 = random_words(_e40, _e43, _e46, i);
        uint word_1 = _e47.x;
        uint _e52 = densification.splats;
        uint _e54 = divide_up(_e52, 256u);
        uint total = block_sums[_e54];
        if (total > 0u) {
            uint _e59 = multiply_high(word_1, total);
            uint _e60 = first_above(_e59, densification, sums, block_sums, _buffer_sizes);
            host = _e60;
        } else {
            uint _e63 = densification.even_weight;
            if (_e63 > 0u) {
                uint even = densification.even_weight;
                uint _e71 = densification.splats;
                uint _e73 = multiply_high(word_1, _e71 * even);
                host = naga_div(_e73, even);
            }
        }
        uint _e75 = host;
        if (_e75 != NO_HOST) {
            uint _e79 = host;
            uint _e82 = metal::atomic_fetch_add_explicit(&copies[_e79], 1u, metal::memory_order_relaxed);
        }
    }
    uint _e85 = host;
    hosts[i] = _e85;
    return;
}


struct correctInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void correct(
  metal::uint3 group_1 [[threadgroup_position_in_grid]]
, metal::uint3 groups_1 [[threadgroups_per_grid]]
, uint thread_2 [[thread_index_in_threadgroup]]
, constant Densification& densification [[user(fake0)]]
, device type_10 const& copies [[user(fake0)]]
, device type_11& opacity_logits [[user(fake0)]]
, device type_11& log_scales [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint axis = 0u;
    uint _e3 = flat_group(group_1, groups_1);
    uint i_1 = (_e3 * 256u) + thread_2;
    uint _e9 = densification.splats;
    if (i_1 >= _e9) {
        return;
    }
    uint drawn = metal::atomic_load_explicit(&copies[i_1], metal::memory_order_relaxed);
    if (drawn == 0u) {
        return;
    }
    uint n_3 = metal::min(drawn + 1u, MAX_COPIES);
    float logit = opacity_logits[i_1];
    bool _e23 = is_nan(logit);
    if (_e23) {
        float _e28 = densification.lowest_logit;
        opacity_logits[i_1] = _e28;
        return;
    }
    float x_10 = metal::clamp(logit, MIN_LOGIT, MAX_LOGIT);
    float _e36 = exponential(-(metal::abs(x_10)));
    float _e37 = log_one_plus(_e36);
    float t_1 = (metal::max(x_10, 0.0) + _e37) / static_cast<float>(n_3);
    float _e41 = one_minus_exponential(t_1);
    float _e42 = logistic(x_10);
    float _e45 = profile_of_copies(_e41, n_3);
    float scale = (_e42 * SQRT_TAU) / _e45;
    float _e49 = natural_log(_e41);
    float _e53 = densification.lowest_logit;
    opacity_logits[i_1] = metal::max(t_1 + _e49, _e53);
    float _e55 = natural_log(scale);
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e70 = axis;
            axis = _e70 + 1u;
        }
        loop_init_5 = false;
        uint _e58 = axis;
        if (_e58 < 3u) {
        } else {
            break;
        }
        {
            uint _e64 = axis;
            float _e67 = log_scales[(3u * i_1) + _e64];
            log_scales[(3u * i_1) + _e64] = _e67 + _e55;
        }
    }
    return;
}
