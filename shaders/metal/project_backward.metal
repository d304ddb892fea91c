// Made from shaders/project_backward.wgsl by scripts/export-msl.

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
struct UnitRotation {
    metal::float4 rotation;
    float length;
    char _pad2[12];
};
struct SplatCount {
    uint count;
    uint capacity;
    uint stored_degree;
    uint degree;
};
typedef float type_8[1];
typedef metal::float4 type_9[1];
struct Geometry {
    metal::float3 position;
    metal::float3 log_scale;
    metal::float4 rotation;
};
struct Sums {
    float q;
    float q_dy;
    float q_dy_dy;
    float q_v;
    float q_v_dy;
    float q_v_v;
    float depth;
};
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint NOT_DRAWN = 4294967295u;
constant float NEAR_PLANE = 0.01;
constant float LOW_PASS = 0.3;
constant float LOG2_255_ = 7.9943533;
constant float FACTOR_SCALE = 0.8493218;
constant float LOG2_E = 1.442695;
constant float MAX_SCALE = 1000000000000.0;
constant float MIN_TRAINED_ROTATION_LENGTH = 0.000000000001;
constant float LN_2_ = 0.6931472;

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

int naga_f2i32(float value) {
    return static_cast<int>(metal::clamp(value, -2147483600.0, 2147483500.0));
}

float natural_exp(
    float x_4
) {
    float p = 0.00019875691;
    float limited_1 = metal::clamp(x_4, -87.0, 87.0);
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
    return (x_4 < -87.0) ? 0.0 : power;
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

UnitRotation unit_rotation(
    metal::float4 q_1
) {
    bool local_8 = {};
    bool local_9 = {};
    bool local_10 = {};
    bool local_11 = {};
    float largest = metal::max(metal::max(metal::abs(q_1.x), metal::abs(q_1.y)), metal::max(metal::abs(q_1.z), metal::abs(q_1.w)));
    bool _e13 = is_finite(q_1.x);
    if (_e13) {
        bool _e17 = is_finite(q_1.y);
        local_8 = _e17;
    } else {
        local_8 = false;
    }
    bool _e19 = local_8;
    if (_e19) {
        bool _e23 = is_finite(q_1.z);
        local_9 = _e23;
    } else {
        local_9 = false;
    }
    bool _e25 = local_9;
    if (_e25) {
        bool _e29 = is_finite(q_1.w);
        local_10 = _e29;
    } else {
        local_10 = false;
    }
    bool finite_1 = local_10;
    if (!(!(finite_1))) {
        local_11 = !((largest > 0.0));
    } else {
        local_11 = true;
    }
    bool _e40 = local_11;
    if (_e40) {
        return UnitRotation {metal::float4(1.0, 0.0, 0.0, 0.0), 0.0};
    }
    metal::float4 scaled = q_1 / metal::float4(largest);
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

uint rest_floats(
    uint degree
) {
    return 3u * (((degree + 1u) * (degree + 1u)) - 1u);
}

metal::float4 rotation_backward(
    metal::float4 q_2,
    metal::float3 tx,
    metal::float3 ty,
    metal::float3 sx,
    metal::float3 sy
) {
    metal::float3 g0_ = (tx.x * sx) + (ty.x * sy);
    metal::float3 g1_ = (tx.y * sx) + (ty.y * sy);
    metal::float3 g2_ = (tx.z * sx) + (ty.z * sy);
    float w_1 = q_2.x;
    float x_6 = q_2.y;
    float y_1 = q_2.z;
    float z_1 = q_2.w;
    metal::float3 turn = metal::float3(g2_.y - g1_.z, g0_.z - g2_.x, g1_.x - g0_.y);
    metal::float3 shear = metal::float3(g2_.y + g1_.z, g0_.z + g2_.x, g1_.x + g0_.y);
    return 2.0 * metal::float4(((x_6 * turn.x) + (y_1 * turn.y)) + (z_1 * turn.z), (((y_1 * shear.z) + (z_1 * shear.y)) + (w_1 * turn.x)) - ((2.0 * x_6) * (g1_.y + g2_.z)), (((x_6 * shear.z) + (z_1 * shear.x)) + (w_1 * turn.y)) - ((2.0 * y_1) * (g0_.x + g2_.z)), (((x_6 * shear.y) + (y_1 * shear.x)) + (w_1 * turn.z)) - ((2.0 * z_1) * (g0_.x + g1_.y)));
}

Geometry geometry_backward(
    uint splat,
    Sums s,
    constant Frame& frame,
    device type_8 const& positions,
    device type_8 const& log_scales,
    device type_9 const& rotations,
    device type_9 const& centres,
    device type_9 const& extents,
    constant _mslBufferSizes& _buffer_sizes
) {
    Geometry gradient_1 = {};
    float _e6 = positions[3u * splat];
    float _e13 = positions[(3u * splat) + 1u];
    float _e20 = positions[(3u * splat) + 2u];
    metal::float3 position_3 = metal::float3(_e6, _e13, _e20);
    float _e26 = log_scales[3u * splat];
    float _e27 = linear_scale(_e26);
    float _e34 = log_scales[(3u * splat) + 1u];
    float _e35 = linear_scale(_e34);
    float _e42 = log_scales[(3u * splat) + 2u];
    float _e43 = linear_scale(_e42);
    metal::float3 scale_1 = metal::float3(_e27, _e35, _e43);
    metal::float4 _e47 = rotations[splat];
    UnitRotation _e48 = unit_rotation(_e47);
    metal::float3x3 _e50 = rotation_matrix(_e48.rotation);
    metal::float3 _e51 = from_camera(position_3, frame);
    float _e55 = extents[splat].z;
    float inverse_z_2 = 1.0 / _e55;
    metal::float2 _e58 = view_slope(_e51, inverse_z_2, frame);
    metal::float2 _e61 = frame.slope_min;
    metal::float2 _e64 = frame.slope_max;
    metal::float2 limited_2 = metal::clamp(_e58, _e61, _e64);
    metal::float2 _e68 = frame.focal;
    metal::float2 gain_1 = _e68 * inverse_z_2;
    metal::float4 _e73 = frame.rotation_x;
    metal::float4 _e78 = frame.rotation_z;
    metal::float3 tx_1 = gain_1.x * (_e73.xyz - (limited_2.x * _e78.xyz));
    metal::float4 _e86 = frame.rotation_y;
    metal::float4 _e91 = frame.rotation_z;
    metal::float3 ty_1 = gain_1.y * (_e86.xyz - (limited_2.y * _e91.xyz));
    metal::float3 local_x = tx_1 * _e50;
    metal::float3 local_y = ty_1 * _e50;
    metal::float3 mx_1 = local_x * scale_1;
    metal::float3 my_1 = local_y * scale_1;
    float u11_ = centres[splat].z;
    float u12_ = centres[splat].w;
    float u22_ = extents[splat].x;
    float lean_1 = -(u12_) / u11_;
    float by_d = (0.960906 * (u11_ * u11_)) * s.q_v_v;
    float by_lean = (1.921812 * (u11_ * s.q_v_dy)) * (u22_ * u22_);
    float by_c = (0.960906 * (u22_ * u22_)) * ((u22_ * u22_) * s.q_dy_dy);
    metal::float3 r_1 = mx_1 - (lean_1 * my_1);
    metal::float3 by_mx = ((2.0 * by_d) * r_1) + (by_lean * my_1);
    metal::float3 by_my = ((by_lean * (r_1 - (lean_1 * my_1))) - (((2.0 * lean_1) * by_d) * r_1)) + ((2.0 * by_c) * my_1);
    metal::float2 by_centre = 1.3862944 * metal::float2(u11_ * s.q_v, (u12_ * s.q_v) + ((u22_ * u22_) * s.q_dy));
    metal::bool3 is_free = (scale_1 > metal::float3(0.0)) & (scale_1 < metal::float3(1000000000000.0));
    metal::float3 by_scale = metal::select(metal::float3(0.0), (by_mx * local_x) + (by_my * local_y), is_free);
    metal::float3 scaled_x = by_mx * scale_1;
    metal::float3 scaled_y = by_my * scale_1;
    metal::float3 by_tx = _e50 * scaled_x;
    metal::float3 by_ty = _e50 * scaled_y;
    metal::float4 _e181 = frame.rotation_z;
    metal::float4 _e186 = frame.rotation_z;
    metal::float2 along = gain_1 * metal::float2(metal::dot(by_tx, _e181.xyz), metal::dot(by_ty, _e186.xyz));
    metal::float2 _e193 = frame.slope_min;
    metal::float2 _e197 = frame.slope_max;
    metal::bool2 follows = (_e58 > _e193) & (_e58 < _e197);
    metal::float2 _e202 = frame.focal;
    metal::float2 by_slope = (_e202 * by_centre) - metal::select(metal::float2(0.0), along, follows);
    float turned = (metal::dot(by_tx, tx_1) + metal::dot(by_ty, ty_1)) + metal::dot(by_slope, _e58);
    metal::float3 by_view = metal::float3(by_slope * inverse_z_2, s.depth - (turned * inverse_z_2));
    metal::float4 _e223 = frame.rotation_x;
    metal::float4 _e229 = frame.rotation_y;
    metal::float4 _e236 = frame.rotation_z;
    gradient_1.position = ((by_view.x * _e223.xyz) + (by_view.y * _e229.xyz)) + (by_view.z * _e236.xyz);
    gradient_1.log_scale = by_scale * scale_1;
    metal::float4 _e244 = rotation_backward(_e48.rotation, tx_1, ty_1, scaled_x, scaled_y);
    metal::float4 _e245 = unit_backward(_e48, _e244);
    gradient_1.rotation = _e245;
    Geometry _e246 = gradient_1;
    return _e246;
}

struct project_backwardInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void project_backward(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Frame& frame [[user(fake0)]]
, constant SplatCount& splats [[user(fake0)]]
, device type_8 const& positions [[user(fake0)]]
, device type_8 const& log_scales [[user(fake0)]]
, device type_9 const& rotations [[user(fake0)]]
, device type_9 const& centres [[user(fake0)]]
, device type_9 const& extents [[user(fake0)]]
, device type_9 const& sums [[user(fake0)]]
, device type_8& by_positions [[user(fake0)]]
, device type_8& by_log_scales [[user(fake0)]]
, device type_9& by_rotations [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    Geometry gradient = Geometry {metal::float3(0.0), metal::float3(0.0), metal::float4(0.0)};
    uint _e3 = flat_group(group, groups);
    uint splat_1 = (_e3 * 256u) + thread_;
    uint _e9 = splats.count;
    if (splat_1 >= _e9) {
        return;
    }
    metal::float4 last = sums[(3u * splat_1) + 2u];
    if (last.z != 0.0) {
        metal::float4 middle = sums[(3u * splat_1) + 1u];
        float depth_1 = sums[3u * splat_1].w;
        Geometry _e49 = geometry_backward(splat_1, Sums {middle.x, middle.y, middle.z, middle.w, last.x, last.y, depth_1}, frame, positions, log_scales, rotations, centres, extents, _buffer_sizes);
        gradient = _e49;
    }
    float _e56 = gradient.position.x;
    by_positions[3u * splat_1] = _e56;
    float _e65 = gradient.position.y;
    by_positions[(3u * splat_1) + 1u] = _e65;
    float _e74 = gradient.position.z;
    by_positions[(3u * splat_1) + 2u] = _e74;
    float _e81 = gradient.log_scale.x;
    by_log_scales[3u * splat_1] = _e81;
    float _e90 = gradient.log_scale.y;
    by_log_scales[(3u * splat_1) + 1u] = _e90;
    float _e99 = gradient.log_scale.z;
    by_log_scales[(3u * splat_1) + 2u] = _e99;
    metal::float4 _e103 = gradient.rotation;
    by_rotations[splat_1] = _e103;
    return;
}
