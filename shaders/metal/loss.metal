// Made from shaders/loss.wgsl by scripts/export-msl.

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
typedef metal::float4 type_7[1];
typedef uint type_8[1];
typedef float type_9[1];
struct type_10 {
    float inner[11];
};
struct type_11 {
    float inner[676];
};
struct type_12 {
    metal::float4 inner[416];
};
struct Compared {
    float s;
    float e;
    float weight;
    float target_value;
};
constant uint REPORT_WORDS = 8u;
constant uint REPORT_DIFFERENCE = 0u;
constant uint REPORT_DISSIMILARITY = 1u;
constant uint REPORT_IMAGE_NOT_FINITE = 2u;
constant uint REPORT_NOT_FINITE = 3u;
constant uint REPORT_VISIBLE = 4u;
constant uint REPORT_ENTRIES = 5u;
constant uint REPORT_HALTED = 6u;
constant uint REPORT_STEP = 7u;
constant uint TILE = 16u;
constant uint RADIUS = 5u;
constant uint TAPS = 11u;
constant uint WIDE = 26u;
constant float C1_ = 0.0001;
constant float C2_ = 0.0009;
constant float UNIT = 0.003921569;
constant float MIDDLE = 1.0;
constant type_10 WINDOW = type_10 {{0.0010283801, 0.007598758, 0.036000773, 0.10936069, 0.21300554, 0.2660117, 0.21300554, 0.10936069, 0.036000773, 0.007598758, 0.0010283801}};

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
    float a,
    float b,
    uint zero_1
) {
    float _e4 = opaque(a + b, zero_1);
    float _e6 = opaque(_e4 - a, zero_1);
    float _e8 = opaque(_e4 - _e6, zero_1);
    return metal::float2(_e4, (a - _e8) + (b - _e6));
}

metal::float2 two_product(
    float a_1,
    float b_1,
    uint zero_2
) {
    float _e4 = opaque(a_1 * b_1, zero_2);
    float _e5 = upper_half(a_1);
    float _e6 = upper_half(b_1);
    float a_low = a_1 - _e5;
    float b_low = b_1 - _e6;
    float error = ((((_e5 * _e6) - _e4) + (_e5 * b_low)) + (a_low * _e6)) + (a_low * b_low);
    return metal::float2(_e4, error);
}

metal::float2 add_two_floats(
    metal::float2 a_2,
    metal::float2 b_2,
    uint zero_3
) {
    metal::float2 _e5 = two_sum(a_2.x, b_2.x, zero_3);
    metal::float2 _e12 = two_sum(_e5.x, _e5.y + (a_2.y + b_2.y), zero_3);
    return _e12;
}

uint report_word(
    uint slot,
    uint word
) {
    return (slot * REPORT_WORDS) + word;
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

Compared compared(
    uint pixel,
    uint channel_2,
    constant TrainingStep& training,
    device type_7 const& render,
    device type_8 const& photograph,
    device type_8 const& pixel_weights,
    constant _mslBufferSizes& _buffer_sizes
) {
    float y = {};
    float weight = 1.0;
    metal::float4 rendered = render[pixel];
    uint bytes = photograph[pixel];
    float behind = training.background[channel_2];
    y = static_cast<float>((bytes >> (8u * channel_2)) & 255u) * UNIT;
    uint alpha_byte = bytes >> 24u;
    if (alpha_byte != 255u) {
        float alpha = static_cast<float>(alpha_byte) * UNIT;
        float _e28 = y;
        y = (alpha * _e28) + ((1.0 - alpha) * behind);
    }
    float _e34 = y;
    uint _e37 = training.zero;
    float _e38 = opaque(_e34, _e37);
    y = _e38;
    float x_4 = rendered[channel_2] + ((1.0 - rendered.w) * behind);
    uint _e49 = training.weighted;
    if (_e49 != 0u) {
        uint _e56 = pixel_weights[naga_div(pixel, 4u)];
        weight = static_cast<float>((_e56 >> (8u * naga_mod(pixel, 4u))) & 255u) * UNIT;
    }
    float _e67 = weight;
    float _e68 = y;
    float e_1 = _e67 * (x_4 - _e68);
    float _e71 = y;
    float _e75 = weight;
    float _e76 = y;
    return Compared {e_1 + (2.0 * _e71), e_1, _e75, _e76};
}

uint pixel_at(
    metal::uint2 first,
    uint place_4,
    constant TrainingStep& training
) {
    bool local = {};
    bool local_1 = {};
    bool local_2 = {};
    uint x_5 = first.x + naga_mod(place_4, WIDE);
    uint y_1 = first.y + naga_div(place_4, WIDE);
    if (!((x_5 < RADIUS))) {
        local = y_1 < RADIUS;
    } else {
        local = true;
    }
    bool _e18 = local;
    if (!(_e18)) {
        uint _e27 = training.image.x;
        local_1 = (x_5 - RADIUS) >= _e27;
    } else {
        local_1 = true;
    }
    bool _e30 = local_1;
    if (!(_e30)) {
        uint _e39 = training.image.y;
        local_2 = (y_1 - RADIUS) >= _e39;
    } else {
        local_2 = true;
    }
    bool _e42 = local_2;
    if (_e42) {
        return 4294967295u;
    }
    uint _e49 = training.image.x;
    return (((y_1 - RADIUS) * _e49) + x_5) - RADIUS;
}

struct lossInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void loss(
  metal::uint3 tile [[threadgroup_position_in_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant TrainingStep& training [[user(fake0)]]
, device type_7 const& render [[user(fake0)]]
, device type_8 const& photograph [[user(fake0)]]
, device type_8 const& pixel_weights [[user(fake0)]]
, device type_9& derivatives [[user(fake0)]]
, device type_7& tile_sums [[user(fake0)]]
, threadgroup type_11& wide_0_
, threadgroup type_11& wide_1_
, threadgroup type_12& across
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    metal::float3 sums = metal::float3(0.0);
    uint channel = 0u;
    uint place = {};
    float s = {};
    float e = {};
    uint place_1 = {};
    metal::float4 sum = {};
    uint tap = {};
    metal::float4 moments = {};
    uint tap_1 = {};
    uint half_ = 128u;
    metal::uint2 first_1 = tile.xy * TILE;
    metal::uint2 own = first_1 + metal::uint2(naga_mod(thread_, TILE), naga_div(thread_, TILE));
    metal::uint2 _e13 = training.image;
    bool inside = metal::all(own < _e13);
    uint _e20 = training.image.x;
    uint own_pixel = (own.y * _e20) + own.x;
    metal::uint2 _e29 = training.image;
    metal::uint2 centre = metal::min(first_1 + metal::uint2(8u), _e29 - metal::uint2(1u));
    uint _e37 = training.image.x;
    uint _e41 = training.image.y;
    uint pixels = _e37 * _e41;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e283 = channel;
            channel = _e283 + 1u;
        }
        loop_init = false;
        uint _e48 = channel;
        if (_e48 < 3u) {
        } else {
            break;
        }
        {
            uint _e55 = training.image.x;
            uint _e59 = channel;
            Compared _e60 = compared((centre.y * _e55) + centre.x, _e59, training, render, photograph, pixel_weights, _buffer_sizes);
            float near = 2.0 * _e60.target_value;
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            place = thread_;
            bool loop_init_1 = true;
            while(true) {
                if (!loop_init_1) {
                    uint _e89 = place;
                    place = _e89 + 256u;
                }
                loop_init_1 = false;
                uint _e65 = place;
                if (_e65 < 676u) {
                } else {
                    break;
                }
                {
                    uint _e68 = place;
                    uint _e69 = pixel_at(first_1, _e68, training);
                    s = 0.0;
                    e = 0.0;
                    if (_e69 != 4294967295u) {
                        uint _e76 = channel;
                        Compared _e77 = compared(_e69, _e76, training, render, photograph, pixel_weights, _buffer_sizes);
                        s = _e77.s;
                        e = _e77.e;
                    }
                    uint _e81 = place;
                    float _e83 = s;
                    wide_0_.inner[_e81] = _e83 - near;
                    uint _e86 = place;
                    float _e88 = e;
                    wide_1_.inner[_e86] = _e88;
                }
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            place_1 = thread_;
            bool loop_init_2 = true;
            while(true) {
                if (!loop_init_2) {
                    uint _e139 = place_1;
                    place_1 = _e139 + 256u;
                }
                loop_init_2 = false;
                uint _e93 = place_1;
                if (_e93 < 416u) {
                } else {
                    break;
                }
                {
                    uint _e96 = place_1;
                    uint _e101 = place_1;
                    uint start = (naga_div(_e96, TILE) * WIDE) + naga_mod(_e101, TILE);
                    sum = metal::float4(0.0);
                    tap = 0u;
                    bool loop_init_3 = true;
                    while(true) {
                        if (!loop_init_3) {
                            uint _e133 = tap;
                            tap = _e133 + 1u;
                        }
                        loop_init_3 = false;
                        uint _e110 = tap;
                        if (_e110 < TAPS) {
                        } else {
                            break;
                        }
                        {
                            uint _e114 = tap;
                            float _e117 = wide_0_.inner[start + _e114];
                            uint _e119 = tap;
                            float _e122 = wide_1_.inner[start + _e119];
                            metal::float2 v = metal::float2(_e117, _e122);
                            metal::float4 _e124 = sum;
                            uint _e126 = tap;
                            sum = _e124 + (WINDOW.inner[_e126] * metal::float4(v, v * v));
                        }
                    }
                    uint _e136 = place_1;
                    metal::float4 _e138 = sum;
                    across.inner[_e136] = _e138;
                }
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            moments = metal::float4(0.0);
            tap_1 = 0u;
            bool loop_init_4 = true;
            while(true) {
                if (!loop_init_4) {
                    uint _e164 = tap_1;
                    tap_1 = _e164 + 1u;
                }
                loop_init_4 = false;
                uint _e147 = tap_1;
                if (_e147 < TAPS) {
                } else {
                    break;
                }
                {
                    metal::float4 _e150 = moments;
                    uint _e152 = tap_1;
                    uint _e155 = tap_1;
                    metal::float4 _e160 = across.inner[thread_ + (_e155 * TILE)];
                    moments = _e150 + (WINDOW.inner[_e152] * _e160);
                }
            }
            if (inside) {
                float _e167 = moments.z;
                float _e169 = moments.x;
                float _e171 = moments.x;
                float variance_s = metal::max(_e167 - (_e169 * _e171), 0.0);
                float _e177 = moments.w;
                float _e179 = moments.y;
                float _e181 = moments.y;
                float variance_e = metal::max(_e177 - (_e179 * _e181), 0.0);
                float _e187 = moments.x;
                float u = _e187 + near;
                float v_1 = moments.y;
                float inverse_d1_ = 1.0 / ((0.5 * ((u * u) + (v_1 * v_1))) + C1_);
                float inverse_d2_ = 1.0 / ((0.5 * (variance_s + variance_e)) + C2_);
                float q1_ = (v_1 * v_1) * inverse_d1_;
                float q2_ = variance_e * inverse_d2_;
                float by_square_s = ((0.5 * (1.0 - q1_)) * q2_) * inverse_d2_;
                float by_square_e = ((-0.5 * (1.0 - q1_)) * (2.0 - q2_)) * inverse_d2_;
                float by_mean = (((1.0 - q2_) * inverse_d1_) * ((u * q1_) - (v_1 * (2.0 - q1_)))) - (2.0 * (((u - MIDDLE) * by_square_s) + (v_1 * by_square_e)));
                uint _e242 = channel;
                uint plane = ((3u * _e242) * pixels) + own_pixel;
                derivatives[plane] = by_mean;
                derivatives[plane + pixels] = by_square_s;
                derivatives[plane + (2u * pixels)] = by_square_e;
                float e_2 = wide_1_.inner[(((naga_div(thread_, TILE) + RADIUS) * WIDE) + naga_mod(thread_, TILE)) + RADIUS];
                metal::float3 _e270 = sums;
                bool _e276 = is_finite(e_2);
                sums = _e270 + metal::float3(metal::abs(e_2), q2_ + ((1.0 - q2_) * q1_), _e276 ? 0.0 : 1.0);
            }
        }
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    metal::float3 _e287 = sums;
    across.inner[thread_] = metal::float4(_e287, 0.0);
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e306 = half_;
            half_ = naga_div(_e306, 2u);
        }
        loop_init_5 = false;
        uint _e292 = half_;
        if (_e292 > 0u) {
        } else {
            break;
        }
        {
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e295 = half_;
            if (thread_ < _e295) {
                metal::float4 _e299 = across.inner[thread_];
                uint _e301 = half_;
                metal::float4 _e304 = across.inner[thread_ + _e301];
                across.inner[thread_] = _e299 + _e304;
            }
        }
    }
    if (thread_ == 0u) {
        uint _e316 = training.tiles.x;
        metal::float4 _e323 = across.inner[0];
        tile_sums[(tile.y * _e316) + tile.x] = _e323;
        return;
    } else {
        return;
    }
}


struct loss_backwardInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void loss_backward(
  metal::uint3 tile_1 [[threadgroup_position_in_grid]]
, uint thread_1 [[thread_index_in_threadgroup]]
, constant TrainingStep& training [[user(fake0)]]
, device type_7 const& render [[user(fake0)]]
, device type_8 const& photograph [[user(fake0)]]
, device type_8 const& pixel_weights [[user(fake0)]]
, device type_9 const& derivatives [[user(fake0)]]
, device type_7& gradient [[user(fake0)]]
, threadgroup type_11& wide_0_
, threadgroup type_11& wide_1_
, threadgroup type_11& wide_2_
, threadgroup type_12& across
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    metal::float3 by_color = metal::float3(0.0);
    uint channel_1 = 0u;
    uint place_2 = {};
    metal::float3 values = {};
    uint place_3 = {};
    metal::float3 sum_1 = {};
    uint tap_2 = {};
    metal::float3 blurred = {};
    uint tap_3 = {};
    metal::uint2 first_2 = tile_1.xy * TILE;
    metal::uint2 own_1 = first_2 + metal::uint2(naga_mod(thread_1, TILE), naga_div(thread_1, TILE));
    metal::uint2 _e13 = training.image;
    bool inside_1 = metal::all(own_1 < _e13);
    uint _e20 = training.image.x;
    uint own_pixel_1 = (own_1.y * _e20) + own_1.x;
    uint _e27 = training.image.x;
    uint _e31 = training.image.y;
    uint pixels_1 = _e27 * _e31;
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e201 = channel_1;
            channel_1 = _e201 + 1u;
        }
        loop_init_6 = false;
        uint _e38 = channel_1;
        if (_e38 < 3u) {
        } else {
            break;
        }
        {
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e42 = channel_1;
            uint plane_1 = (3u * _e42) * pixels_1;
            place_2 = thread_1;
            bool loop_init_7 = true;
            while(true) {
                if (!loop_init_7) {
                    uint _e88 = place_2;
                    place_2 = _e88 + 256u;
                }
                loop_init_7 = false;
                uint _e46 = place_2;
                if (_e46 < 676u) {
                } else {
                    break;
                }
                {
                    uint _e49 = place_2;
                    uint _e50 = pixel_at(first_2, _e49, training);
                    values = metal::float3(0.0);
                    if (_e50 != 4294967295u) {
                        float _e59 = derivatives[plane_1 + _e50];
                        float _e64 = derivatives[(plane_1 + pixels_1) + _e50];
                        float _e71 = derivatives[(plane_1 + (2u * pixels_1)) + _e50];
                        values = metal::float3(_e59, _e64, _e71);
                    }
                    uint _e74 = place_2;
                    float _e77 = values.x;
                    wide_0_.inner[_e74] = _e77;
                    uint _e79 = place_2;
                    float _e82 = values.y;
                    wide_1_.inner[_e79] = _e82;
                    uint _e84 = place_2;
                    float _e87 = values.z;
                    wide_2_.inner[_e84] = _e87;
                }
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            place_3 = thread_1;
            bool loop_init_8 = true;
            while(true) {
                if (!loop_init_8) {
                    uint _e139 = place_3;
                    place_3 = _e139 + 256u;
                }
                loop_init_8 = false;
                uint _e92 = place_3;
                if (_e92 < 416u) {
                } else {
                    break;
                }
                {
                    uint _e95 = place_3;
                    uint _e100 = place_3;
                    uint start_1 = (naga_div(_e95, TILE) * WIDE) + naga_mod(_e100, TILE);
                    sum_1 = metal::float3(0.0);
                    tap_2 = 0u;
                    bool loop_init_9 = true;
                    while(true) {
                        if (!loop_init_9) {
                            uint _e131 = tap_2;
                            tap_2 = _e131 + 1u;
                        }
                        loop_init_9 = false;
                        uint _e109 = tap_2;
                        if (_e109 < TAPS) {
                        } else {
                            break;
                        }
                        {
                            uint _e112 = tap_2;
                            uint i = start_1 + _e112;
                            metal::float3 _e114 = sum_1;
                            uint _e116 = tap_2;
                            float _e120 = wide_0_.inner[i];
                            float _e123 = wide_1_.inner[i];
                            float _e126 = wide_2_.inner[i];
                            sum_1 = _e114 + (WINDOW.inner[_e116] * metal::float3(_e120, _e123, _e126));
                        }
                    }
                    uint _e134 = place_3;
                    metal::float3 _e136 = sum_1;
                    across.inner[_e134] = metal::float4(_e136, 0.0);
                }
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            blurred = metal::float3(0.0);
            tap_3 = 0u;
            bool loop_init_10 = true;
            while(true) {
                if (!loop_init_10) {
                    uint _e165 = tap_3;
                    tap_3 = _e165 + 1u;
                }
                loop_init_10 = false;
                uint _e147 = tap_3;
                if (_e147 < TAPS) {
                } else {
                    break;
                }
                {
                    metal::float3 _e150 = blurred;
                    uint _e152 = tap_3;
                    uint _e155 = tap_3;
                    metal::float4 _e160 = across.inner[thread_1 + (_e155 * TILE)];
                    blurred = _e150 + (WINDOW.inner[_e152] * _e160.xyz);
                }
            }
            if (inside_1) {
                uint _e167 = channel_1;
                Compared _e168 = compared(own_pixel_1, _e167, training, render, photograph, pixel_weights, _buffer_sizes);
                float _e170 = blurred.x;
                float _e175 = blurred.y;
                float _e179 = blurred.z;
                float by_similarity = _e170 + (2.0 * (((_e168.s - MIDDLE) * _e175) + (_e168.e * _e179)));
                float _e187 = training.l1_scale;
                float by_l1_ = _e187 * metal::sign(_e168.e);
                uint _e191 = channel_1;
                float _e196 = training.ssim_scale;
                by_color[_e191] = _e168.weight * (by_l1_ - (_e196 * by_similarity));
            }
        }
    }
    if (inside_1) {
        metal::float3 _e203 = by_color;
        metal::float4 _e206 = training.background;
        float by_alpha = -(metal::dot(_e203, _e206.xyz));
        metal::float3 _e212 = by_color;
        gradient[own_pixel_1] = metal::float4(_e212, by_alpha);
        return;
    } else {
        return;
    }
}
