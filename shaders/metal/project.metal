// Made from shaders/project.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size1;
    uint size3;
    uint size4;
    uint size5;
    uint size6;
    uint size7;
    uint size8;
    uint size9;
    uint size10;
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
typedef uint type_8[1];
struct Window {
    uint first;
    uint count;
    uint padding_1_;
    uint padding_2_;
};
struct Cluster {
    metal::packed_float3 color;
    uint shown;
};
typedef Pose type_9[1];
typedef Cluster type_10[1];
typedef float type_11[1];
typedef metal::float4 type_12[1];
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
constant uint HARMONICS_STORAGE = 0u;
constant uint STORED_SH_DEGREE = 0u;
constant uint HEADER_WORDS = 2u;

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
    float x_5 = q.y;
    float y = q.z;
    float z = q.w;
    return metal::float3x3(metal::float3(1.0 - (2.0 * ((y * y) + (z * z))), 2.0 * ((x_5 * y) + (w * z)), 2.0 * ((x_5 * z) - (w * y))), metal::float3(2.0 * ((x_5 * y) - (w * z)), 1.0 - (2.0 * ((x_5 * x_5) + (z * z))), 2.0 * ((y * z) + (w * x_5))), metal::float3(2.0 * ((x_5 * z) + (w * y)), 2.0 * ((y * z) - (w * x_5)), 1.0 - (2.0 * ((x_5 * x_5) + (y * y)))));
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

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

uint harmonics_word(
    uint local_10,
    uint index,
    device type_8 const& harmonics,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint words = {};
    words = 3u;
    if (false) {
        words = 2u;
    } else {
        if (false) {
            words = 2u;
        }
    }
    uint _e34 = words;
    uint _e43 = harmonics[(((naga_div(local_10, 32u) * _e34) + index) * 32u) + naga_mod(local_10, 32u)];
    return _e43;
}

float half_coefficient(
    uint local_11,
    uint index_1,
    device type_8 const& harmonics,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e4 = harmonics_word(local_11, naga_div(index_1, 2u), harmonics, _buffer_sizes);
    return float2(as_type<half2>(_e4))[naga_mod(index_1, 2u)];
}

float byte_coefficient(
    uint local_12,
    uint index_2,
    constant Frame& frame,
    device type_8 const& harmonics,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e8 = harmonics_word(local_12, HEADER_WORDS + naga_div(index_2 - 3u, 4u), harmonics, _buffer_sizes);
    int steps = as_type<int>(_e8 << (24u - (8u * naga_mod(index_2 - 3u, 4u)))) >> 24u;
    if (steps == -128) {
        uint _e26 = frame.zero;
        return as_type<float>(2143289344u + _e26);
    }
    uint band = (1u + static_cast<uint>(index_2 >= 12u)) + static_cast<uint>(index_2 >= 27u);
    float _e41 = half_coefficient(local_12, 2u + band, harmonics, _buffer_sizes);
    return static_cast<float>(steps) * _e41;
}

float coefficient(
    uint local_13,
    uint index_3,
    constant Frame& frame,
    device type_8 const& harmonics,
    constant _mslBufferSizes& _buffer_sizes
) {
    bool local_14 = {};
    if (true) {
        uint _e6 = harmonics_word(local_13, index_3, harmonics, _buffer_sizes);
        return as_type<float>(_e6);
    }
    if (true) {
        local_14 = index_3 < 3u;
    } else {
        local_14 = true;
    }
    bool _e18 = local_14;
    if (_e18) {
        float _e19 = half_coefficient(local_13, index_3, harmonics, _buffer_sizes);
        return _e19;
    }
    float _e20 = byte_coefficient(local_13, index_3, frame, harmonics, _buffer_sizes);
    return _e20;
}

metal::float3 coefficients(
    uint local_15,
    uint k,
    constant Frame& frame,
    device type_8 const& harmonics,
    constant _mslBufferSizes& _buffer_sizes
) {
    float _e4 = coefficient(local_15, 3u * k, frame, harmonics, _buffer_sizes);
    float _e9 = coefficient(local_15, (3u * k) + 1u, frame, harmonics, _buffer_sizes);
    float _e14 = coefficient(local_15, (3u * k) + 2u, frame, harmonics, _buffer_sizes);
    return metal::float3(_e4, _e9, _e14);
}

metal::float3 view_color(
    uint at,
    uint degree,
    metal::float3 d,
    constant Frame& frame,
    device type_8 const& harmonics,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::float3 color_1 = {};
    metal::float3 _e5 = coefficients(at, 0u, frame, harmonics, _buffer_sizes);
    color_1 = metal::float3(0.5) + (SH_C0_ * _e5);
    if (degree == 0u) {
        metal::float3 _e13 = color_1;
        return _e13;
    }
    metal::float3 _e14 = color_1;
    metal::float3 _e19 = coefficients(at, 1u, frame, harmonics, _buffer_sizes);
    color_1 = _e14 + ((-0.4886025 * d.y) * _e19);
    metal::float3 _e22 = color_1;
    metal::float3 _e27 = coefficients(at, 2u, frame, harmonics, _buffer_sizes);
    color_1 = _e22 + ((SH_C1_ * d.z) * _e27);
    metal::float3 _e30 = color_1;
    metal::float3 _e35 = coefficients(at, 3u, frame, harmonics, _buffer_sizes);
    color_1 = _e30 + ((-0.4886025 * d.x) * _e35);
    if (degree == 1u) {
        metal::float3 _e40 = color_1;
        return _e40;
    }
    metal::float3 s = d * d;
    metal::float3 _e42 = color_1;
    metal::float3 _e49 = coefficients(at, 4u, frame, harmonics, _buffer_sizes);
    color_1 = _e42 + (((1.0925485 * d.x) * d.y) * _e49);
    metal::float3 _e52 = color_1;
    metal::float3 _e59 = coefficients(at, 5u, frame, harmonics, _buffer_sizes);
    color_1 = _e52 + (((-1.0925485 * d.y) * d.z) * _e59);
    metal::float3 _e62 = color_1;
    metal::float3 _e73 = coefficients(at, 6u, frame, harmonics, _buffer_sizes);
    color_1 = _e62 + ((0.31539157 * (((2.0 * s.z) - s.x) - s.y)) * _e73);
    metal::float3 _e76 = color_1;
    metal::float3 _e83 = coefficients(at, 7u, frame, harmonics, _buffer_sizes);
    color_1 = _e76 + (((-1.0925485 * d.x) * d.z) * _e83);
    metal::float3 _e86 = color_1;
    metal::float3 _e93 = coefficients(at, 8u, frame, harmonics, _buffer_sizes);
    color_1 = _e86 + ((0.54627424 * (s.x - s.y)) * _e93);
    if (degree == 2u) {
        metal::float3 _e98 = color_1;
        return _e98;
    }
    metal::float3 _e99 = color_1;
    metal::float3 _e110 = coefficients(at, 9u, frame, harmonics, _buffer_sizes);
    color_1 = _e99 + (((-0.5900436 * d.y) * ((3.0 * s.x) - s.y)) * _e110);
    metal::float3 _e113 = color_1;
    metal::float3 _e122 = coefficients(at, 10u, frame, harmonics, _buffer_sizes);
    color_1 = _e113 + ((((2.8906114 * d.x) * d.y) * d.z) * _e122);
    metal::float3 _e125 = color_1;
    metal::float3 _e138 = coefficients(at, 11u, frame, harmonics, _buffer_sizes);
    color_1 = _e125 + (((-0.4570458 * d.y) * (((4.0 * s.z) - s.x) - s.y)) * _e138);
    metal::float3 _e141 = color_1;
    metal::float3 _e158 = coefficients(at, 12u, frame, harmonics, _buffer_sizes);
    color_1 = _e141 + (((0.37317634 * d.z) * (((2.0 * s.z) - (3.0 * s.x)) - (3.0 * s.y))) * _e158);
    metal::float3 _e161 = color_1;
    metal::float3 _e174 = coefficients(at, 13u, frame, harmonics, _buffer_sizes);
    color_1 = _e161 + (((-0.4570458 * d.x) * (((4.0 * s.z) - s.x) - s.y)) * _e174);
    metal::float3 _e177 = color_1;
    metal::float3 _e186 = coefficients(at, 14u, frame, harmonics, _buffer_sizes);
    color_1 = _e177 + (((1.4453057 * d.z) * (s.x - s.y)) * _e186);
    metal::float3 _e189 = color_1;
    metal::float3 _e200 = coefficients(at, 15u, frame, harmonics, _buffer_sizes);
    color_1 = _e189 + (((-0.5900436 * d.x) * (s.x - (3.0 * s.y))) * _e200);
    metal::float3 _e203 = color_1;
    return _e203;
}

metal::float3 motion_heat(
    float relative
) {
    bool _e4 = is_nan(relative);
    float x_6 = (_e4 ? 1.0 : metal::clamp(relative, 0.0, 1.0)) * 3.0;
    metal::float3 black = metal::float3(0.0);
    metal::float3 purple = metal::float3(0.47, 0.11, 0.43);
    metal::float3 orange = metal::float3(0.93, 0.41, 0.15);
    metal::float3 white = metal::float3(0.99, 1.0, 0.64);
    if (x_6 < 1.0) {
        return black + (x_6 * metal::float3(0.47, 0.11, 0.43));
    }
    if (x_6 < 2.0) {
        return purple + ((x_6 - 1.0) * metal::float3(0.46, 0.3, -0.28));
    }
    return orange + ((x_6 - 2.0) * metal::float3(0.060000002, 0.59000003, 0.48999998));
}

metal::float3 splat_color(
    uint local_16,
    uint label,
    metal::float3 to_splat_1,
    float depth_1,
    constant Frame& frame,
    device type_8 const& harmonics,
    device type_10 const& clusters,
    device type_11 const& motion,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e6 = frame.color_source;
    if (_e6 == 1u) {
        metal::float3 _e12 = clusters[label].color;
        return _e12;
    }
    uint _e15 = frame.color_source;
    if (_e15 == 2u) {
        float _e25 = motion[metal::min(local_16, (1 + (_buffer_sizes.size5 - 0 - 4) / 4) - 1u)];
        float _e28 = frame.heat_scale;
        metal::float3 _e30 = motion_heat(_e25 * _e28);
        return _e30;
    }
    uint _e33 = frame.color_source;
    if (_e33 == 3u) {
        float _e38 = frame.depth_near;
        float _e42 = frame.depth_slope;
        return metal::float3(metal::clamp(1.0 - ((depth_1 - _e38) * _e42), 0.0, 1.0));
    }
    uint _e53 = frame.sh_degree;
    uint degree_1 = metal::min(STORED_SH_DEGREE, _e53);
    metal::float3 _e55 = direction(to_splat_1);
    metal::float3 _e56 = view_color(local_16, degree_1, _e55, frame, harmonics, _buffer_sizes);
    metal::float3 _e57 = limited_color(_e56);
    return _e57;
}

struct projectInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void project(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Frame& frame [[user(fake0)]]
, device type_8 const& harmonics [[user(fake0)]]
, constant Window& window [[user(fake0)]]
, device type_9 const& poses [[user(fake0)]]
, device type_10 const& clusters [[user(fake0)]]
, device type_11 const& motion [[user(fake0)]]
, device type_12& centres [[user(fake0)]]
, device type_12& extents [[user(fake0)]]
, device type_12& colors [[user(fake0)]]
, device type_8& sort_keys [[user(fake0)]]
, device type_8& sort_keys_low [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint _e3 = flat_group(group, groups);
    uint local_17 = (_e3 * 256u) + thread_;
    uint _e9 = window.count;
    if (local_17 >= _e9) {
        return;
    }
    uint _e13 = window.first;
    uint splat = _e13 + local_17;
    sort_keys[splat] = NOT_DRAWN;
    sort_keys_low[splat] = 0u;
    Pose pose = poses[local_17];
    uint _e28 = clusters[pose.label].shown;
    if (_e28 == 0u) {
        return;
    }
    Ellipse _e35 = project_ellipse(pose.position, pose.rotation, pose.scale, pose.log2_opacity, frame);
    if (!(_e35.drawn)) {
        return;
    }
    metal::float3 _e40 = from_camera(pose.position, frame);
    metal::float3 _e43 = splat_color(local_17, pose.label, _e40, _e35.depth.x, frame, harmonics, clusters, motion, _buffer_sizes);
    centres[splat] = metal::float4(_e35.centre, metal::float3(_e35.factor).xy);
    extents[splat] = metal::float4(_e35.factor[2], pose.log2_opacity, _e35.depth.x, _e35.half_height);
    colors[splat] = metal::float4(_e43, as_type<float>(pose.label));
    sort_keys[splat] = as_type<uint>(_e35.depth.x);
    uint _e72 = low_key(_e35.depth);
    sort_keys_low[splat] = _e72;
    return;
}
