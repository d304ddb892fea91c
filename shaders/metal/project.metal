// Made from shaders/project.wgsl by scripts/export-msl.

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
    uint padding_1_;
    uint padding_2_;
};
struct Pose {
    metal::packed_float3 position;
    float log2_opacity;
    metal::float4 rotation;
    metal::packed_float3 scale;
    uint label;
};
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
typedef Pose type_7[1];
typedef uint type_8[1];
typedef Cluster type_9[1];
typedef float type_10[1];
typedef metal::float4 type_11[1];
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
constant uint STORED_SH_DEGREE = 0u;
constant bool HALF_HARMONICS = false;

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

metal::float2 view_depth(
    metal::float3 position,
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
            metal::float2 _e20 = two_sum(position[_e9], -(_e15), _e19);
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

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

uint harmonics_word(
    uint local_9,
    uint index,
    device type_8 const& harmonics,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e31 = harmonics[(((naga_div(local_9, 32u) * 3u) + index) * 32u) + naga_mod(local_9, 32u)];
    return _e31;
}

float coefficient(
    uint local_10,
    uint index_1,
    device type_8 const& harmonics,
    constant _mslBufferSizes& _buffer_sizes
) {
    if (HALF_HARMONICS) {
        uint _e5 = harmonics_word(local_10, naga_div(index_1, 2u), harmonics, _buffer_sizes);
        return float2(as_type<half2>(_e5))[naga_mod(index_1, 2u)];
    }
    uint _e10 = harmonics_word(local_10, index_1, harmonics, _buffer_sizes);
    return as_type<float>(_e10);
}

metal::float3 coefficients(
    uint local_11,
    uint k,
    device type_8 const& harmonics,
    constant _mslBufferSizes& _buffer_sizes
) {
    float _e4 = coefficient(local_11, 3u * k, harmonics, _buffer_sizes);
    float _e9 = coefficient(local_11, (3u * k) + 1u, harmonics, _buffer_sizes);
    float _e14 = coefficient(local_11, (3u * k) + 2u, harmonics, _buffer_sizes);
    return metal::float3(_e4, _e9, _e14);
}

metal::float3 view_color(
    uint local_12,
    metal::float3 d,
    constant Frame& frame,
    device type_8 const& harmonics,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::float3 color_1 = {};
    metal::float3 _e4 = coefficients(local_12, 0u, harmonics, _buffer_sizes);
    color_1 = metal::float3(0.5) + (SH_C0_ * _e4);
    uint _e13 = frame.sh_degree;
    uint degree = metal::min(STORED_SH_DEGREE, _e13);
    if (degree == 0u) {
        metal::float3 _e17 = color_1;
        return _e17;
    }
    metal::float3 _e18 = color_1;
    metal::float3 _e23 = coefficients(local_12, 1u, harmonics, _buffer_sizes);
    color_1 = _e18 + ((-0.4886025 * d.y) * _e23);
    metal::float3 _e26 = color_1;
    metal::float3 _e31 = coefficients(local_12, 2u, harmonics, _buffer_sizes);
    color_1 = _e26 + ((SH_C1_ * d.z) * _e31);
    metal::float3 _e34 = color_1;
    metal::float3 _e39 = coefficients(local_12, 3u, harmonics, _buffer_sizes);
    color_1 = _e34 + ((-0.4886025 * d.x) * _e39);
    if (degree == 1u) {
        metal::float3 _e44 = color_1;
        return _e44;
    }
    metal::float3 s = d * d;
    metal::float3 _e46 = color_1;
    metal::float3 _e53 = coefficients(local_12, 4u, harmonics, _buffer_sizes);
    color_1 = _e46 + (((1.0925485 * d.x) * d.y) * _e53);
    metal::float3 _e56 = color_1;
    metal::float3 _e63 = coefficients(local_12, 5u, harmonics, _buffer_sizes);
    color_1 = _e56 + (((-1.0925485 * d.y) * d.z) * _e63);
    metal::float3 _e66 = color_1;
    metal::float3 _e77 = coefficients(local_12, 6u, harmonics, _buffer_sizes);
    color_1 = _e66 + ((0.31539157 * (((2.0 * s.z) - s.x) - s.y)) * _e77);
    metal::float3 _e80 = color_1;
    metal::float3 _e87 = coefficients(local_12, 7u, harmonics, _buffer_sizes);
    color_1 = _e80 + (((-1.0925485 * d.x) * d.z) * _e87);
    metal::float3 _e90 = color_1;
    metal::float3 _e97 = coefficients(local_12, 8u, harmonics, _buffer_sizes);
    color_1 = _e90 + ((0.54627424 * (s.x - s.y)) * _e97);
    if (degree == 2u) {
        metal::float3 _e102 = color_1;
        return _e102;
    }
    metal::float3 _e103 = color_1;
    metal::float3 _e114 = coefficients(local_12, 9u, harmonics, _buffer_sizes);
    color_1 = _e103 + (((-0.5900436 * d.y) * ((3.0 * s.x) - s.y)) * _e114);
    metal::float3 _e117 = color_1;
    metal::float3 _e126 = coefficients(local_12, 10u, harmonics, _buffer_sizes);
    color_1 = _e117 + ((((2.8906114 * d.x) * d.y) * d.z) * _e126);
    metal::float3 _e129 = color_1;
    metal::float3 _e142 = coefficients(local_12, 11u, harmonics, _buffer_sizes);
    color_1 = _e129 + (((-0.4570458 * d.y) * (((4.0 * s.z) - s.x) - s.y)) * _e142);
    metal::float3 _e145 = color_1;
    metal::float3 _e162 = coefficients(local_12, 12u, harmonics, _buffer_sizes);
    color_1 = _e145 + (((0.37317634 * d.z) * (((2.0 * s.z) - (3.0 * s.x)) - (3.0 * s.y))) * _e162);
    metal::float3 _e165 = color_1;
    metal::float3 _e178 = coefficients(local_12, 13u, harmonics, _buffer_sizes);
    color_1 = _e165 + (((-0.4570458 * d.x) * (((4.0 * s.z) - s.x) - s.y)) * _e178);
    metal::float3 _e181 = color_1;
    metal::float3 _e190 = coefficients(local_12, 14u, harmonics, _buffer_sizes);
    color_1 = _e181 + (((1.4453057 * d.z) * (s.x - s.y)) * _e190);
    metal::float3 _e193 = color_1;
    metal::float3 _e204 = coefficients(local_12, 15u, harmonics, _buffer_sizes);
    color_1 = _e193 + (((-0.5900436 * d.x) * (s.x - (3.0 * s.y))) * _e204);
    metal::float3 _e207 = color_1;
    return _e207;
}

metal::float3 direction(
    metal::float3 v
) {
    bool local_13 = {};
    bool local_14 = {};
    float squared = metal::dot(v, v);
    if (squared > MIN_NORMAL) {
        bool _e6 = is_finite(squared);
        local_13 = _e6;
    } else {
        local_13 = false;
    }
    bool _e8 = local_13;
    if (_e8) {
        return v / metal::float3(metal::sqrt(squared));
    }
    float largest = metal::max(metal::abs(v.x), metal::max(metal::abs(v.y), metal::abs(v.z)));
    if (largest > 0.0) {
        bool _e24 = is_finite(largest);
        local_14 = _e24;
    } else {
        local_14 = false;
    }
    bool _e26 = local_14;
    if (!(_e26)) {
        return metal::float3(0.0, 0.0, 1.0);
    }
    metal::float3 scaled = v / metal::float3(largest);
    return scaled / metal::float3(metal::sqrt(metal::dot(scaled, scaled)));
}

metal::float3 splat_color(
    uint local_15,
    uint label,
    metal::float3 to_splat,
    constant Frame& frame,
    device type_8 const& harmonics,
    device type_9 const& clusters,
    device type_10 const& motion,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e5 = frame.color_source;
    if (_e5 == 1u) {
        metal::float3 _e11 = clusters[label].color;
        return _e11;
    }
    uint _e14 = frame.color_source;
    if (_e14 == 2u) {
        float _e24 = motion[metal::min(local_15, (1 + (_buffer_sizes.size5 - 0 - 4) / 4) - 1u)];
        float _e27 = frame.heat_scale;
        metal::float3 _e29 = motion_heat(_e24 * _e27);
        return _e29;
    }
    metal::float3 _e30 = direction(to_splat);
    metal::float3 _e31 = view_color(local_15, _e30, frame, harmonics, _buffer_sizes);
    metal::float3 _e32 = limited_color(_e31);
    return _e32;
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

struct projectInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void project(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Frame& frame [[user(fake0)]]
, constant Window& window [[user(fake0)]]
, device type_7 const& poses [[user(fake0)]]
, device type_8 const& harmonics [[user(fake0)]]
, device type_9 const& clusters [[user(fake0)]]
, device type_10 const& motion [[user(fake0)]]
, device type_11& centres [[user(fake0)]]
, device type_11& extents [[user(fake0)]]
, device type_11& colors [[user(fake0)]]
, device type_8& sort_keys [[user(fake0)]]
, device type_8& sort_keys_low [[user(fake0)]]
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
    uint _e3 = flat_group(group, groups);
    uint local_16 = (_e3 * 256u) + thread_;
    uint _e9 = window.count;
    if (local_16 >= _e9) {
        return;
    }
    uint _e13 = window.first;
    uint splat = _e13 + local_16;
    sort_keys[splat] = NOT_DRAWN;
    sort_keys_low[splat] = 0u;
    Pose pose = poses[local_16];
    if (!(!((pose.log2_opacity >= -7.9943533)))) {
        uint _e35 = clusters[pose.label].shown;
        local = _e35 == 0u;
    } else {
        local = true;
    }
    bool _e39 = local;
    if (_e39) {
        return;
    }
    metal::float4 _e43 = frame.centre_high;
    metal::float4 _e48 = frame.centre_low;
    metal::float3 to_splat_1 = (pose.position - _e43.xyz) - _e48.xyz;
    metal::float2 _e52 = view_depth(pose.position, frame);
    if (_e52.x > NEAR_PLANE) {
        bool _e59 = is_finite(_e52.x);
        local_1 = _e59;
    } else {
        local_1 = false;
    }
    bool _e61 = local_1;
    if (!(_e61)) {
        return;
    }
    float inverse_z = 1.0 / _e52.x;
    metal::float4 _e68 = frame.rotation_x;
    metal::float4 _e73 = frame.rotation_y;
    metal::float2 slope = metal::float2(metal::dot(_e68.xyz, to_splat_1), metal::dot(_e73.xyz, to_splat_1)) * inverse_z;
    metal::float2 _e80 = frame.focal;
    metal::float2 _e84 = frame.principal;
    metal::float2 centre = (_e80 * slope) + _e84;
    metal::float2 _e88 = frame.slope_min;
    metal::float2 _e91 = frame.slope_max;
    metal::float2 limited = metal::clamp(slope, _e88, _e91);
    metal::float2 _e95 = frame.focal;
    metal::float2 gain = _e95 * inverse_z;
    metal::float4 _e100 = frame.rotation_x;
    metal::float4 _e105 = frame.rotation_z;
    metal::float3 row_x = gain.x * (_e100.xyz - (limited.x * _e105.xyz));
    metal::float4 _e113 = frame.rotation_y;
    metal::float4 _e118 = frame.rotation_z;
    metal::float3 row_y = gain.y * (_e113.xyz - (limited.y * _e118.xyz));
    metal::float3x3 _e124 = rotation_matrix(pose.rotation);
    metal::float3 mx = (row_x * _e124) * pose.scale;
    metal::float3 my = (row_y * _e124) * pose.scale;
    float xx = metal::dot(mx, mx);
    float yy = metal::dot(my, my);
    float inverse_deviation_y = 1.0 / metal::sqrt(yy + LOW_PASS);
    metal::float3 minors = metal::cross(mx, my) * inverse_deviation_y;
    float rest_1 = (LOW_PASS * inverse_deviation_y) * (((xx + yy) + LOW_PASS) * inverse_deviation_y);
    float inverse_deviation_x = 1.0 / metal::sqrt(metal::dot(minors, minors) + rest_1);
    float lean = (metal::dot(mx, my) * inverse_deviation_y) * inverse_deviation_y;
    float reach = metal::sqrt(metal::max(pose.log2_opacity + LOG2_255_, 0.0)) / FACTOR_SCALE;
    metal::float2 half_size = reach * metal::sqrt(metal::float2(xx, yy) + metal::float2(0.3));
    metal::float3 factor = metal::float3(inverse_deviation_x, -(lean) * inverse_deviation_x, inverse_deviation_y) * FACTOR_SCALE;
    bool _e175 = is_finite(centre.x);
    if (_e175) {
        bool _e179 = is_finite(centre.y);
        local_2 = _e179;
    } else {
        local_2 = false;
    }
    bool _e181 = local_2;
    if (_e181) {
        bool _e185 = is_finite(factor.x);
        local_3 = _e185;
    } else {
        local_3 = false;
    }
    bool _e187 = local_3;
    if (_e187) {
        bool _e191 = is_finite(factor.y);
        local_4 = _e191;
    } else {
        local_4 = false;
    }
    bool _e193 = local_4;
    if (_e193) {
        bool _e197 = is_finite(half_size.x);
        local_5 = _e197;
    } else {
        local_5 = false;
    }
    bool _e199 = local_5;
    if (_e199) {
        bool _e203 = is_finite(half_size.y);
        local_6 = _e203;
    } else {
        local_6 = false;
    }
    bool finite = local_6;
    if (!(!(finite))) {
        local_7 = metal::any((centre + half_size) <= metal::float2(0.0));
    } else {
        local_7 = true;
    }
    bool _e216 = local_7;
    if (!(_e216)) {
        metal::float2 _e223 = frame.image;
        local_8 = metal::any((centre - half_size) >= _e223);
    } else {
        local_8 = true;
    }
    bool _e227 = local_8;
    if (_e227) {
        return;
    }
    centres[splat] = metal::float4(centre, factor.xy);
    extents[splat] = metal::float4(factor.z, pose.log2_opacity, _e52.x, half_size.y);
    metal::float3 _e242 = splat_color(local_16, pose.label, to_splat_1, frame, harmonics, clusters, motion, _buffer_sizes);
    colors[splat] = metal::float4(_e242, as_type<float>(pose.label));
    sort_keys[splat] = as_type<uint>(_e52.x);
    uint _e252 = low_key(_e52);
    sort_keys_low[splat] = _e252;
    return;
}
