// Made from shaders/color_backward.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size5;
    uint size6;
    uint size7;
    uint size8;
    uint size9;
    uint size10;
    uint size11;
    uint size12;
    uint size13;
};

struct Frame {
    metal::float4 rotation_x;
    metal::float4 rotation_y;
    metal::float4 rotation_z;
    metal::float4 centre_high;
    metal::float4 centre_low;
    metal::float4 rotation_z_low;
    metal::float2 focal;
    metal::float2 principal;
    metal::float2 slope_min;
    metal::float2 slope_max;
    metal::float2 image;
    uint sh_degree;
    uint color_source;
    float heat_scale;
    uint zero;
    float depth_near;
    float depth_slope;
};
struct Pose {
    metal::packed_float3 position;
    float log2_opacity;
    metal::float4 rotation;
    metal::packed_float3 scale;
    uint label;
};
struct Ellipse {
    bool drawn;
    char _pad1[7];
    metal::float2 centre;
    metal::packed_float3 factor;
    float half_height;
    metal::float2 depth;
    char _pad5[8];
};
struct SplatCount {
    uint count;
    uint capacity;
    uint stored_degree;
    uint degree;
};
struct type_8 {
    float inner[2880];
};
struct type_9 {
    uint inner[64];
};
typedef float type_10[1];
typedef metal::float4 type_11[1];
struct type_13 {
    metal::float3 inner[2];
};
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint NOT_DRAWN = 4294967295u;
constant float NEAR_PLANE = 0.01;
constant float LOW_PASS = 0.3;
constant float LOG2_255_ = 7.9943533;
constant float FACTOR_SCALE = 0.8493218;
constant float MAX_CHANNEL = 65504.0;
constant float MIN_NORMAL = 0.000000000000000000000000000000000000011754944;
constant float SH_C0_ = 0.28209478;
constant float SH_C1_ = 0.4886025;
constant float LOG2_E = 1.442695;
constant float MAX_SCALE = 1000000000000.0;
constant uint STAGED_SPLATS = 64u;
constant uint MOST_REST = 45u;

uint flat_group(
    metal::uint3 group,
    metal::uint3 groups_1
) {
    return (group.y * groups_1.x) + group.x;
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

metal::float3 from_camera(
    metal::float3 position,
    constant Frame& frame
) {
    metal::float4 _e3 = frame.centre_high;
    metal::float4 _e8 = frame.centre_low;
    return (position - _e3.xyz) - _e8.xyz;
}

metal::float2 view_slope(
    metal::float3 to_splat,
    float inverse_z,
    constant Frame& frame
) {
    metal::float4 _e4 = frame.rotation_x;
    metal::float4 _e9 = frame.rotation_y;
    return metal::float2(metal::dot(_e4.xyz, to_splat), metal::dot(_e9.xyz, to_splat)) * inverse_z;
}

metal::float2 view_depth(
    metal::float3 position_1,
    constant Frame& frame
) {
    metal::float2 sum = metal::float2(0.0);
    uint axis = 0u;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e62 = axis;
            axis = _e62 + 1u;
        }
        loop_init = false;
        uint _e6 = axis;
        if (_e6 < 3u) {
        } else {
            break;
        }
        {
            uint _e9 = axis;
            uint _e13 = axis;
            float _e15 = frame.centre_high[_e13];
            uint _e19 = frame.zero;
            metal::float2 _e20 = two_sum(position_1[_e9], -(_e15), _e19);
            uint _e24 = axis;
            float _e26 = frame.centre_low[_e24];
            float low = _e20.y - _e26;
            uint _e31 = axis;
            float _e33 = frame.rotation_z[_e31];
            uint _e36 = frame.zero;
            metal::float2 _e37 = two_product(_e20.x, _e33, _e36);
            uint _e40 = axis;
            float _e42 = frame.rotation_z[_e40];
            uint _e47 = axis;
            float _e49 = frame.rotation_z_low[_e47];
            float rest = (low * _e42) + (_e20.x * _e49);
            metal::float2 _e52 = sum;
            uint _e59 = frame.zero;
            metal::float2 _e60 = add_two_floats(_e52, metal::float2(_e37.x, _e37.y + rest), _e59);
            sum = _e60;
        }
    }
    metal::float2 _e64 = sum;
    return _e64;
}

metal::float3x3 rotation_matrix(
    metal::float4 q
) {
    float w = q.x;
    float x_6 = q.y;
    float y = q.z;
    float z = q.w;
    return metal::float3x3(metal::float3(1.0 - (2.0 * ((y * y) + (z * z))), 2.0 * ((x_6 * y) + (w * z)), 2.0 * ((x_6 * z) - (w * y))), metal::float3(2.0 * ((x_6 * y) - (w * z)), 1.0 - (2.0 * ((x_6 * x_6) + (z * z))), 2.0 * ((y * z) + (w * x_6))), metal::float3(2.0 * ((x_6 * z) + (w * y)), 2.0 * ((y * z) - (w * x_6)), 1.0 - (2.0 * ((x_6 * x_6) + (y * y)))));
}

Ellipse project_ellipse(
    metal::float3 position_2,
    metal::float4 rotation,
    metal::float3 scale,
    float log2_opacity,
    constant Frame& frame
) {
    Ellipse ellipse = {};
    bool local = {};
    bool local_1 = {};
    bool local_2 = {};
    bool local_3 = {};
    bool local_4 = {};
    bool local_5 = {};
    bool local_6 = {};
    bool local_7 = {};
    ellipse.drawn = false;
    if (!((log2_opacity >= -7.9943533))) {
        Ellipse _e10 = ellipse;
        return _e10;
    }
    metal::float3 _e11 = from_camera(position_2, frame);
    metal::float2 _e12 = view_depth(position_2, frame);
    if (_e12.x > NEAR_PLANE) {
        bool _e19 = is_finite(_e12.x);
        local = _e19;
    } else {
        local = false;
    }
    bool _e21 = local;
    if (!(_e21)) {
        Ellipse _e23 = ellipse;
        return _e23;
    }
    float inverse_z_1 = 1.0 / _e12.x;
    metal::float2 _e27 = view_slope(_e11, inverse_z_1, frame);
    metal::float2 _e30 = frame.focal;
    metal::float2 _e34 = frame.principal;
    metal::float2 centre = (_e30 * _e27) + _e34;
    metal::float2 _e38 = frame.slope_min;
    metal::float2 _e41 = frame.slope_max;
    metal::float2 limited = metal::clamp(_e27, _e38, _e41);
    metal::float2 _e45 = frame.focal;
    metal::float2 gain = _e45 * inverse_z_1;
    metal::float4 _e50 = frame.rotation_x;
    metal::float4 _e55 = frame.rotation_z;
    metal::float3 row_x = gain.x * (_e50.xyz - (limited.x * _e55.xyz));
    metal::float4 _e63 = frame.rotation_y;
    metal::float4 _e68 = frame.rotation_z;
    metal::float3 row_y = gain.y * (_e63.xyz - (limited.y * _e68.xyz));
    metal::float3x3 _e73 = rotation_matrix(rotation);
    metal::float3 mx = (row_x * _e73) * scale;
    metal::float3 my = (row_y * _e73) * scale;
    float xx = metal::dot(mx, mx);
    float yy = metal::dot(my, my);
    float inverse_deviation_y = 1.0 / metal::sqrt(yy + LOW_PASS);
    metal::float3 minors = metal::cross(mx, my) * inverse_deviation_y;
    float rest_1 = (LOW_PASS * inverse_deviation_y) * (((xx + yy) + LOW_PASS) * inverse_deviation_y);
    float inverse_deviation_x = 1.0 / metal::sqrt(metal::dot(minors, minors) + rest_1);
    float lean = (metal::dot(mx, my) * inverse_deviation_y) * inverse_deviation_y;
    float reach = metal::sqrt(metal::max(log2_opacity + LOG2_255_, 0.0)) / FACTOR_SCALE;
    metal::float2 half_size = reach * metal::sqrt(metal::float2(xx, yy) + metal::float2(0.3));
    metal::float3 factor = metal::float3(inverse_deviation_x, -(lean) * inverse_deviation_x, inverse_deviation_y) * FACTOR_SCALE;
    bool _e121 = is_finite(centre.x);
    if (_e121) {
        bool _e125 = is_finite(centre.y);
        local_1 = _e125;
    } else {
        local_1 = false;
    }
    bool _e127 = local_1;
    if (_e127) {
        bool _e131 = is_finite(factor.x);
        local_2 = _e131;
    } else {
        local_2 = false;
    }
    bool _e133 = local_2;
    if (_e133) {
        bool _e137 = is_finite(factor.y);
        local_3 = _e137;
    } else {
        local_3 = false;
    }
    bool _e139 = local_3;
    if (_e139) {
        bool _e143 = is_finite(half_size.x);
        local_4 = _e143;
    } else {
        local_4 = false;
    }
    bool _e145 = local_4;
    if (_e145) {
        bool _e149 = is_finite(half_size.y);
        local_5 = _e149;
    } else {
        local_5 = false;
    }
    bool finite = local_5;
    if (!(metal::any((centre + half_size) <= metal::float2(0.0)))) {
        metal::float2 _e163 = frame.image;
        local_6 = metal::any((centre - half_size) >= _e163);
    } else {
        local_6 = true;
    }
    bool misses = local_6;
    if (finite) {
        local_7 = !(misses);
    } else {
        local_7 = false;
    }
    bool _e173 = local_7;
    ellipse.drawn = _e173;
    ellipse.centre = centre;
    ellipse.factor = factor;
    ellipse.half_height = half_size.y;
    ellipse.depth = _e12;
    Ellipse _e179 = ellipse;
    return _e179;
}

uint naga_f2u32(float value) {
    return static_cast<uint>(metal::clamp(value, 0.0, 4294967000.0));
}

uint low_key(
    metal::float2 depth
) {
    uint exponent = as_type<uint>(depth.x) >> 23u;
    float per_last_place = as_type<float>((277u - exponent) << 23u);
    float share = (depth.y * per_last_place) + 0.5;
    return naga_f2u32(metal::clamp(share * 256.0, 0.0, 255.0));
}

float limited_channel(
    float x_4
) {
    bool _e4 = is_nan(x_4);
    return _e4 ? 0.0 : metal::clamp(x_4, 0.0, MAX_CHANNEL);
}

metal::float3 limited_color(
    metal::float3 color
) {
    float _e2 = limited_channel(color.x);
    float _e4 = limited_channel(color.y);
    float _e6 = limited_channel(color.z);
    return metal::float3(_e2, _e4, _e6);
}

metal::float3 direction(
    metal::float3 v
) {
    bool local_8 = {};
    bool local_9 = {};
    float squared = metal::dot(v, v);
    if (squared > MIN_NORMAL) {
        bool _e6 = is_finite(squared);
        local_8 = _e6;
    } else {
        local_8 = false;
    }
    bool _e8 = local_8;
    if (_e8) {
        return v / metal::float3(metal::sqrt(squared));
    }
    float largest = metal::max(metal::abs(v.x), metal::max(metal::abs(v.y), metal::abs(v.z)));
    if (largest > 0.0) {
        bool _e24 = is_finite(largest);
        local_9 = _e24;
    } else {
        local_9 = false;
    }
    bool _e26 = local_9;
    if (!(_e26)) {
        return metal::float3(0.0, 0.0, 1.0);
    }
    metal::float3 scaled = v / metal::float3(largest);
    return scaled / metal::float3(metal::sqrt(metal::dot(scaled, scaled)));
}

uint rest_floats(
    uint degree
) {
    return 3u * (((degree + 1u) * (degree + 1u)) - 1u);
}

metal::float3 coefficients(
    uint at,
    uint k,
    thread metal::float3& staged_dc,
    constant SplatCount& splats,
    threadgroup type_8& staged_rest
) {
    if (k == 0u) {
        metal::float3 _e5 = staged_dc;
        return _e5;
    }
    uint _e8 = splats.degree;
    uint _e9 = rest_floats(_e8);
    uint first = (at * _e9) + (3u * (k - 1u));
    float _e18 = staged_rest.inner[first];
    float _e23 = staged_rest.inner[first + 1u];
    float _e28 = staged_rest.inner[first + 2u];
    return metal::float3(_e18, _e23, _e28);
}

metal::float3 view_color(
    uint at_1,
    uint degree_1,
    metal::float3 d,
    thread metal::float3& staged_dc,
    constant SplatCount& splats,
    threadgroup type_8& staged_rest
) {
    metal::float3 color_1 = {};
    metal::float3 _e5 = coefficients(at_1, 0u, staged_dc, splats, staged_rest);
    color_1 = metal::float3(0.5) + (SH_C0_ * _e5);
    if (degree_1 == 0u) {
        metal::float3 _e13 = color_1;
        return _e13;
    }
    metal::float3 _e14 = color_1;
    metal::float3 _e19 = coefficients(at_1, 1u, staged_dc, splats, staged_rest);
    color_1 = _e14 + ((-0.4886025 * d.y) * _e19);
    metal::float3 _e22 = color_1;
    metal::float3 _e27 = coefficients(at_1, 2u, staged_dc, splats, staged_rest);
    color_1 = _e22 + ((SH_C1_ * d.z) * _e27);
    metal::float3 _e30 = color_1;
    metal::float3 _e35 = coefficients(at_1, 3u, staged_dc, splats, staged_rest);
    color_1 = _e30 + ((-0.4886025 * d.x) * _e35);
    if (degree_1 == 1u) {
        metal::float3 _e40 = color_1;
        return _e40;
    }
    metal::float3 s = d * d;
    metal::float3 _e42 = color_1;
    metal::float3 _e49 = coefficients(at_1, 4u, staged_dc, splats, staged_rest);
    color_1 = _e42 + (((1.0925485 * d.x) * d.y) * _e49);
    metal::float3 _e52 = color_1;
    metal::float3 _e59 = coefficients(at_1, 5u, staged_dc, splats, staged_rest);
    color_1 = _e52 + (((-1.0925485 * d.y) * d.z) * _e59);
    metal::float3 _e62 = color_1;
    metal::float3 _e73 = coefficients(at_1, 6u, staged_dc, splats, staged_rest);
    color_1 = _e62 + ((0.31539157 * (((2.0 * s.z) - s.x) - s.y)) * _e73);
    metal::float3 _e76 = color_1;
    metal::float3 _e83 = coefficients(at_1, 7u, staged_dc, splats, staged_rest);
    color_1 = _e76 + (((-1.0925485 * d.x) * d.z) * _e83);
    metal::float3 _e86 = color_1;
    metal::float3 _e93 = coefficients(at_1, 8u, staged_dc, splats, staged_rest);
    color_1 = _e86 + ((0.54627424 * (s.x - s.y)) * _e93);
    if (degree_1 == 2u) {
        metal::float3 _e98 = color_1;
        return _e98;
    }
    metal::float3 _e99 = color_1;
    metal::float3 _e110 = coefficients(at_1, 9u, staged_dc, splats, staged_rest);
    color_1 = _e99 + (((-0.5900436 * d.y) * ((3.0 * s.x) - s.y)) * _e110);
    metal::float3 _e113 = color_1;
    metal::float3 _e122 = coefficients(at_1, 10u, staged_dc, splats, staged_rest);
    color_1 = _e113 + ((((2.8906114 * d.x) * d.y) * d.z) * _e122);
    metal::float3 _e125 = color_1;
    metal::float3 _e138 = coefficients(at_1, 11u, staged_dc, splats, staged_rest);
    color_1 = _e125 + (((-0.4570458 * d.y) * (((4.0 * s.z) - s.x) - s.y)) * _e138);
    metal::float3 _e141 = color_1;
    metal::float3 _e158 = coefficients(at_1, 12u, staged_dc, splats, staged_rest);
    color_1 = _e141 + (((0.37317634 * d.z) * (((2.0 * s.z) - (3.0 * s.x)) - (3.0 * s.y))) * _e158);
    metal::float3 _e161 = color_1;
    metal::float3 _e174 = coefficients(at_1, 13u, staged_dc, splats, staged_rest);
    color_1 = _e161 + (((-0.4570458 * d.x) * (((4.0 * s.z) - s.x) - s.y)) * _e174);
    metal::float3 _e177 = color_1;
    metal::float3 _e186 = coefficients(at_1, 14u, staged_dc, splats, staged_rest);
    color_1 = _e177 + (((1.4453057 * d.z) * (s.x - s.y)) * _e186);
    metal::float3 _e189 = color_1;
    metal::float3 _e200 = coefficients(at_1, 15u, staged_dc, splats, staged_rest);
    color_1 = _e189 + (((-0.5900436 * d.x) * (s.x - (3.0 * s.y))) * _e200);
    metal::float3 _e203 = color_1;
    return _e203;
}

int naga_f2i32(float value) {
    return static_cast<int>(metal::clamp(value, -2147483600.0, 2147483500.0));
}

float natural_exp(
    float x_5
) {
    float p = 0.00019875691;
    float limited_1 = metal::clamp(x_5, -87.0, 87.0);
    float n = metal::rint(limited_1 * LOG2_E);
    float r = metal::fma(-(n), -0.00021219444, metal::fma(-(n), 0.6933594, limited_1));
    float r2_ = r * r;
    float _e16 = p;
    p = metal::fma(_e16, r, 0.0013981999);
    float _e19 = p;
    p = metal::fma(_e19, r, 0.008333452);
    float _e22 = p;
    p = metal::fma(_e22, r, 0.041665796);
    float _e25 = p;
    p = metal::fma(_e25, r, 0.16666666);
    float _e28 = p;
    p = metal::fma(_e28, r, 0.5);
    float _e31 = p;
    float power = (metal::fma(_e31, r2_, r) + 1.0) * as_type<float>(static_cast<uint>(as_type<int>(as_type<uint>(naga_f2i32(n)) + as_type<uint>(127))) << 23u);
    return (x_5 < -87.0) ? 0.0 : power;
}

float linear_scale(
    float log_scale
) {
    bool _e1 = is_nan(log_scale);
    if (_e1) {
        return -1.0;
    }
    float _e3 = natural_exp(log_scale);
    return metal::min(_e3, MAX_SCALE);
}

float log2_opacity_of(
    float logit
) {
    bool _e1 = is_nan(logit);
    if (_e1) {
        return -1000.0;
    }
    float _e5 = natural_exp(-(metal::abs(logit)));
    return (metal::clamp(metal::min(logit, 0.0), -1000.0, 0.0) * LOG2_E) - metal::log2(1.0 + _e5);
}

float transparency_of(
    float logit_1
) {
    float _e3 = natural_exp(-(metal::abs(logit_1)));
    return ((logit_1 > 0.0) ? _e3 : 1.0) / (1.0 + _e3);
}

void stage_rest(
    uint group_1,
    uint thread_1,
    bool wanted,
    constant SplatCount& splats,
    threadgroup type_8& staged_rest,
    threadgroup type_9& staged_wanted,
    device type_10 const& sh_rest,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint i = {};
    staged_wanted.inner[thread_1] = wanted ? 1u : 0u;
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    uint _e10 = splats.degree;
    uint _e11 = rest_floats(_e10);
    uint _e14 = splats.stored_degree;
    uint _e15 = rest_floats(_e14);
    uint first_1 = (group_1 * STAGED_SPLATS) * _e15;
    i = thread_1;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e42 = i;
            i = _e42 + STAGED_SPLATS;
        }
        loop_init_1 = false;
        uint _e20 = i;
        if (_e20 < (STAGED_SPLATS * _e11)) {
        } else {
            break;
        }
        {
            uint _e24 = i;
            uint at_6 = naga_div(_e24, _e11);
            uint _e28 = staged_wanted.inner[at_6];
            if (_e28 != 0u) {
                uint _e32 = i;
                uint _e37 = i;
                float _e41 = sh_rest[(first_1 + (at_6 * _e15)) + naga_mod(_e37, _e11)];
                staged_rest.inner[_e32] = _e41;
            }
        }
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    return;
}

metal::float3 load_dc(
    uint splat,
    device type_10 const& sh_dc,
    constant _mslBufferSizes& _buffer_sizes
) {
    float _e5 = sh_dc[3u * splat];
    float _e12 = sh_dc[(3u * splat) + 1u];
    float _e19 = sh_dc[(3u * splat) + 2u];
    return metal::float3(_e5, _e12, _e19);
}

void store_basis(
    uint at_2,
    uint k_1,
    metal::float3 by_color,
    float basis,
    constant SplatCount& splats,
    threadgroup type_8& staged_rest
) {
    uint _e6 = splats.degree;
    uint _e7 = rest_floats(_e6);
    uint first_2 = (at_2 * _e7) + (3u * (k_1 - 1u));
    staged_rest.inner[first_2] = by_color.x * basis;
    staged_rest.inner[first_2 + 1u] = by_color.y * basis;
    staged_rest.inner[first_2 + 2u] = by_color.z * basis;
    return;
}

float exchange(
    uint at_3,
    uint k_2,
    metal::float3 by_color_1,
    float basis_1,
    thread metal::float3& staged_dc,
    constant SplatCount& splats,
    threadgroup type_8& staged_rest
) {
    metal::float3 _e4 = coefficients(at_3, k_2, staged_dc, splats, staged_rest);
    store_basis(at_3, k_2, by_color_1, basis_1, splats, staged_rest);
    metal::bool3 still = by_color_1 == metal::float3(0.0);
    return metal::dot(by_color_1, metal::select(_e4, metal::float3(0.0), still));
}

metal::float3 bands_backward(
    uint at_4,
    metal::float3 d_1,
    metal::float3 by_color_2,
    thread metal::float3& staged_dc,
    constant SplatCount& splats,
    threadgroup type_8& staged_rest
) {
    metal::float3 sum_1 = {};
    uint degree_2 = splats.degree;
    if (degree_2 == 0u) {
        return metal::float3(0.0);
    }
    float _e14 = exchange(at_4, 1u, by_color_2, -0.4886025 * d_1.y, staged_dc, splats, staged_rest);
    float _e19 = exchange(at_4, 2u, by_color_2, SH_C1_ * d_1.z, staged_dc, splats, staged_rest);
    float _e24 = exchange(at_4, 3u, by_color_2, -0.4886025 * d_1.x, staged_dc, splats, staged_rest);
    sum_1 = SH_C1_ * metal::float3(-(_e24), -(_e14), _e19);
    if (degree_2 == 1u) {
        metal::float3 _e33 = sum_1;
        return _e33;
    }
    metal::float3 s_1 = d_1 * d_1;
    float _e41 = exchange(at_4, 4u, by_color_2, (1.0925485 * d_1.x) * d_1.y, staged_dc, splats, staged_rest);
    float a_4 = 1.0925485 * _e41;
    float _e50 = exchange(at_4, 5u, by_color_2, (-1.0925485 * d_1.y) * d_1.z, staged_dc, splats, staged_rest);
    float b_4 = -1.0925485 * _e50;
    float _e63 = exchange(at_4, 6u, by_color_2, 0.31539157 * (((2.0 * s_1.z) - s_1.x) - s_1.y), staged_dc, splats, staged_rest);
    float c = 0.31539157 * _e63;
    float _e72 = exchange(at_4, 7u, by_color_2, (-1.0925485 * d_1.x) * d_1.z, staged_dc, splats, staged_rest);
    float e = -1.0925485 * _e72;
    float _e81 = exchange(at_4, 8u, by_color_2, 0.54627424 * (s_1.x - s_1.y), staged_dc, splats, staged_rest);
    float f = 0.54627424 * _e81;
    metal::float3 _e84 = sum_1;
    sum_1 = _e84 + metal::float3((((a_4 * d_1.y) - ((2.0 * c) * d_1.x)) + (e * d_1.z)) + ((2.0 * f) * d_1.x), (((a_4 * d_1.x) + (b_4 * d_1.z)) - ((2.0 * c) * d_1.y)) - ((2.0 * f) * d_1.y), ((b_4 * d_1.y) + ((4.0 * c) * d_1.z)) + (e * d_1.x));
    if (degree_2 == 2u) {
        metal::float3 _e129 = sum_1;
        return _e129;
    }
    float difference = s_1.x - s_1.y;
    float flat = ((4.0 * s_1.z) - s_1.x) - s_1.y;
    float _e150 = exchange(at_4, 9u, by_color_2, (-0.5900436 * d_1.y) * ((3.0 * s_1.x) - s_1.y), staged_dc, splats, staged_rest);
    float h0_ = -0.5900436 * _e150;
    float _e161 = exchange(at_4, 10u, by_color_2, ((2.8906114 * d_1.x) * d_1.y) * d_1.z, staged_dc, splats, staged_rest);
    float h1_ = 2.8906114 * _e161;
    float _e169 = exchange(at_4, 11u, by_color_2, (-0.4570458 * d_1.y) * flat, staged_dc, splats, staged_rest);
    float h2_ = -0.4570458 * _e169;
    float _e188 = exchange(at_4, 12u, by_color_2, (0.37317634 * d_1.z) * (((2.0 * s_1.z) - (3.0 * s_1.x)) - (3.0 * s_1.y)), staged_dc, splats, staged_rest);
    float h3_ = 0.37317634 * _e188;
    float _e196 = exchange(at_4, 13u, by_color_2, (-0.4570458 * d_1.x) * flat, staged_dc, splats, staged_rest);
    float h4_ = -0.4570458 * _e196;
    float _e204 = exchange(at_4, 14u, by_color_2, (1.4453057 * d_1.z) * difference, staged_dc, splats, staged_rest);
    float h5_ = 1.4453057 * _e204;
    float _e217 = exchange(at_4, 15u, by_color_2, (-0.5900436 * d_1.x) * (s_1.x - (3.0 * s_1.y)), staged_dc, splats, staged_rest);
    float h6_ = -0.5900436 * _e217;
    float xy = d_1.x * d_1.y;
    float yz = d_1.y * d_1.z;
    float xz = d_1.x * d_1.z;
    metal::float3 _e229 = sum_1;
    sum_1 = _e229 + metal::float3((((((((6.0 * h0_) * xy) + (h1_ * yz)) - ((2.0 * h2_) * xy)) - ((6.0 * h3_) * xz)) + (h4_ * (((4.0 * s_1.z) - (3.0 * s_1.x)) - s_1.y))) + ((2.0 * h5_) * xz)) + ((3.0 * h6_) * difference), (((((((3.0 * h0_) * difference) + (h1_ * xz)) + (h2_ * (((4.0 * s_1.z) - s_1.x) - (3.0 * s_1.y)))) - ((6.0 * h3_) * yz)) - ((2.0 * h4_) * xy)) - ((2.0 * h5_) * yz)) - ((6.0 * h6_) * xy), ((((h1_ * xy) + ((8.0 * h2_) * yz)) + (h3_ * ((6.0 * s_1.z) - (3.0 * (s_1.x + s_1.y))))) + ((8.0 * h4_) * xz)) + (h5_ * difference));
    metal::float3 _e318 = sum_1;
    return _e318;
}

bool is_free(
    float channel
) {
    bool local_10 = {};
    bool local_11 = {};
    if (channel > 0.0) {
        local_10 = channel < MAX_CHANNEL;
    } else {
        local_10 = false;
    }
    bool _e8 = local_10;
    if (_e8) {
        bool _e11 = is_nan(channel);
        local_11 = !(_e11);
    } else {
        local_11 = false;
    }
    bool _e14 = local_11;
    return _e14;
}

type_13 seen_backward(
    uint splat_1,
    uint at_5,
    constant Frame& frame,
    thread metal::float3& staged_dc,
    constant SplatCount& splats,
    threadgroup type_8& staged_rest,
    device type_10 const& sh_dc,
    device type_10 const& positions,
    device type_11 const& sums,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::float3 by_position = metal::float3(0.0);
    bool local_12 = {};
    metal::float3 _e3 = load_dc(splat_1, sh_dc, _buffer_sizes);
    staged_dc = _e3;
    float _e8 = positions[3u * splat_1];
    float _e15 = positions[(3u * splat_1) + 1u];
    float _e22 = positions[(3u * splat_1) + 2u];
    metal::float3 position_3 = metal::float3(_e8, _e15, _e22);
    metal::float3 _e24 = from_camera(position_3, frame);
    metal::float3 _e25 = direction(_e24);
    uint _e28 = splats.degree;
    metal::float3 _e29 = view_color(at_5, _e28, _e25, staged_dc, splats, staged_rest);
    bool _e31 = is_free(_e29.x);
    bool _e33 = is_free(_e29.y);
    bool _e35 = is_free(_e29.z);
    metal::bool3 free = metal::bool3(_e31, _e33, _e35);
    metal::float4 _e43 = sums[3u * splat_1];
    metal::float3 by_color_3 = metal::select(metal::float3(0.0), _e43.xyz, free);
    metal::float3 _e46 = bands_backward(at_5, _e25, by_color_3, staged_dc, splats, staged_rest);
    float length = metal::dot(_e24, _e25);
    if (length > 0.0) {
        bool _e55 = is_finite(length);
        local_12 = _e55;
    } else {
        local_12 = false;
    }
    bool _e57 = local_12;
    if (_e57) {
        by_position = (_e46 - (metal::dot(_e25, _e46) * _e25)) / metal::float3(length);
    }
    metal::float3 _e65 = by_position;
    return type_13 {{SH_C0_ * by_color_3, _e65}};
}

void unstage_rest(
    uint group_2,
    uint thread_2,
    constant SplatCount& splats,
    threadgroup type_8& staged_rest,
    threadgroup type_9& staged_wanted,
    device type_10& by_sh_rest,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint i_1 = {};
    float value = {};
    bool local_13 = {};
    uint _e4 = splats.degree;
    uint _e5 = rest_floats(_e4);
    uint _e8 = splats.stored_degree;
    uint _e9 = rest_floats(_e8);
    uint first_3 = (group_2 * STAGED_SPLATS) * _e9;
    uint _e16 = splats.count;
    uint _e19 = splats.count;
    uint here = metal::min(STAGED_SPLATS, _e16 - metal::min(_e19, group_2 * STAGED_SPLATS));
    i_1 = thread_2;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e55 = i_1;
            i_1 = _e55 + STAGED_SPLATS;
        }
        loop_init_2 = false;
        uint _e26 = i_1;
        if (_e26 < (here * _e9)) {
        } else {
            break;
        }
        {
            uint _e29 = i_1;
            uint at_7 = naga_div(_e29, _e9);
            uint _e31 = i_1;
            uint float_ = naga_mod(_e31, _e9);
            value = 0.0;
            uint _e37 = staged_wanted.inner[at_7];
            if (_e37 != 0u) {
                local_13 = float_ < _e5;
            } else {
                local_13 = false;
            }
            bool _e44 = local_13;
            if (_e44) {
                float _e49 = staged_rest.inner[(at_7 * _e5) + float_];
                value = _e49;
            }
            uint _e51 = i_1;
            float _e54 = value;
            by_sh_rest[first_3 + _e51] = _e54;
        }
    }
    return;
}

struct color_backwardInput {
};
[[max_total_threads_per_threadgroup(64)]] kernel void color_backward(
  metal::uint3 group_id [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Frame& frame [[user(fake0)]]
, constant SplatCount& splats [[user(fake0)]]
, threadgroup type_8& staged_rest
, threadgroup type_9& staged_wanted
, device type_10 const& sh_rest [[user(fake0)]]
, device type_10 const& sh_dc [[user(fake0)]]
, device type_10 const& positions [[user(fake0)]]
, device type_10 const& opacity_logits [[user(fake0)]]
, device type_11 const& sums [[user(fake0)]]
, device type_10& by_positions [[user(fake0)]]
, device type_10& by_sh_dc [[user(fake0)]]
, device type_10& by_sh_rest [[user(fake0)]]
, device type_10& by_opacity_logits [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    metal::float3 staged_dc = {};
    bool seen = false;
    metal::float3 by_dc = metal::float3(0.0);
    float by_logit = 0.0;
    uint _e3 = flat_group(group_id, groups);
    uint splat_2 = (_e3 * STAGED_SPLATS) + thread_;
    uint _e9 = splats.count;
    bool inside = splat_2 < _e9;
    if (inside) {
        float _e20 = sums[(3u * splat_2) + 2u].z;
        seen = _e20 != 0.0;
    }
    bool _e23 = seen;
    stage_rest(_e3, thread_, _e23, splats, staged_rest, staged_wanted, sh_rest, _buffer_sizes);
    bool _e29 = seen;
    if (_e29) {
        type_13 _e30 = seen_backward(splat_2, thread_, frame, staged_dc, splats, staged_rest, sh_dc, positions, sums, _buffer_sizes);
        by_dc = _e30.inner[0];
        float _e36 = by_positions[3u * splat_2];
        by_positions[3u * splat_2] = _e36 + _e30.inner[1].x;
        float _e46 = by_positions[(3u * splat_2) + 1u];
        by_positions[(3u * splat_2) + 1u] = _e46 + _e30.inner[1].y;
        float _e56 = by_positions[(3u * splat_2) + 2u];
        by_positions[(3u * splat_2) + 2u] = _e56 + _e30.inner[1].z;
        float _e67 = sums[(3u * splat_2) + 1u].x;
        float _e70 = opacity_logits[splat_2];
        float _e71 = transparency_of(_e70);
        by_logit = _e67 * _e71;
    }
    if (inside) {
        float _e78 = by_dc.x;
        by_sh_dc[3u * splat_2] = _e78;
        float _e86 = by_dc.y;
        by_sh_dc[(3u * splat_2) + 1u] = _e86;
        float _e94 = by_dc.z;
        by_sh_dc[(3u * splat_2) + 2u] = _e94;
        float _e97 = by_logit;
        by_opacity_logits[splat_2] = _e97;
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    unstage_rest(_e3, thread_, splats, staged_rest, staged_wanted, by_sh_rest, _buffer_sizes);
    return;
}
