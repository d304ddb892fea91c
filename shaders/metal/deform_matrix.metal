// Made from shaders/deform_matrix.wgsl by scripts/export-msl.

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
struct type_7 {
    metal::float4 inner[24];
};
struct Deformation {
    metal::float4 origin;
    type_7 origin_turns;
    uint splats;
    uint masked;
    float threshold;
    uint octaves;
    uint depth;
    uint skip_layer;
    uint input_rows;
    uint screw;
    uint as_trained;
    uint zero;
    uint padding_1_;
    uint padding_2_;
};
typedef uint type_8[1];
struct Waves {
    metal::float4 sine;
    metal::float4 cosine;
};
typedef Pose type_9[1];
typedef half type_11[1];
typedef float type_12[1];
struct type_13 {
    half inner[16896];
};
struct type_14 {
    float inner[2048];
};
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint VISIBLE = 0u;
constant uint ENTRIES = 1u;
constant uint SORTED_ENTRIES = 2u;
constant uint DYNAMIC = 3u;
constant uint MOST_ENTRIES = 4u;
constant uint HALTED = 5u;
constant uint DRAWN_FRAMES = 6u;
constant float TAU = 6.2831855;
constant float INVERSE_TAU_1_ = 0.15911865;
constant float INVERSE_TAU_2_ = 0.000036284328;
constant float INVERSE_TAU_3_ = 0.0000000064206382;
constant float MIN_ROTATION_NORM = 0.000001;
constant float MIN_DEFORMED_SCALE = 0.000001;
constant float MAX_SCALE = 1000000000000.0;
constant uint WIDTH = 256u;
constant uint SPLATS = 64u;
constant uint THREADS = 256u;
constant uint HEAD_OUTPUTS = 16u;
constant uint STRIDE = 264u;

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

metal::float4 turns_of(
    float x_4
) {
    float high = as_type<float>(as_type<uint>(x_4) & 4294963200u);
    float low = x_4 - high;
    return metal::float4(high * INVERSE_TAU_1_, low * INVERSE_TAU_1_, high * INVERSE_TAU_2_, (low * INVERSE_TAU_2_) + (x_4 * INVERSE_TAU_3_));
}

float without_whole(
    float x_5
) {
    return x_5 - metal::rint(x_5);
}

int naga_f2i32(float value) {
    return static_cast<int>(metal::clamp(value, -2147483600.0, 2147483500.0));
}

metal::float2 sin_cos_of_turns(
    metal::float4 turns,
    float scale,
    float offset
) {
    metal::float2 pair = {};
    metal::float4 scaled = turns * scale;
    metal::float4 parts = scaled - metal::rint(scaled);
    float _e14 = without_whole(((parts.x + offset) + (parts.y + parts.z)) + parts.w);
    float quarters = metal::rint(_e14 * 4.0);
    float r = (_e14 - (0.25 * quarters)) * TAU;
    float r2_ = r * r;
    float sine = r + ((r * r2_) * (-0.16666655 + (r2_ * (0.008332161 + (r2_ * -0.00019515296)))));
    float cosine = (1.0 - (0.5 * r2_)) + ((r2_ * r2_) * (0.041666646 + (r2_ * (-0.0013887316 + (r2_ * 0.000024433157)))));
    int quadrant = naga_f2i32(quarters) & 3;
    pair = metal::float2(sine, cosine);
    if ((quadrant & 1) == 1) {
        pair = metal::float2(cosine, -(sine));
    }
    if (quadrant >= 2) {
        metal::float2 _e61 = pair;
        pair = -(_e61);
    }
    metal::float2 _e63 = pair;
    return _e63;
}

uint evaluated_splats(
    constant Deformation& deformation,
    device type_8 const& counts,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e2 = deformation.masked;
    if (_e2 != 0u) {
        uint _e7 = counts[3];
        return _e7;
    }
    uint _e10 = deformation.splats;
    return _e10;
}

uint listed_splat(
    uint i,
    constant Deformation& deformation,
    device type_8 const& counts,
    device type_8 const& dynamic_splats,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e1 = evaluated_splats(deformation, counts, _buffer_sizes);
    uint last = _e1 - 1u;
    uint at = metal::min(i, last);
    uint _e7 = deformation.masked;
    if (_e7 != 0u) {
        uint _e12 = dynamic_splats[at];
        return _e12;
    }
    return at;
}

Waves waves_of(
    metal::float4 coordinates,
    uint axis,
    uint octave,
    constant Deformation& deformation
) {
    float scale_2 = static_cast<float>(1u << octave);
    float offset_1 = deformation.origin_turns.inner[octave][axis];
    metal::float4 _e12 = turns_of(coordinates.x);
    metal::float2 _e13 = sin_cos_of_turns(_e12, scale_2, offset_1);
    metal::float4 _e15 = turns_of(coordinates.y);
    metal::float2 _e16 = sin_cos_of_turns(_e15, scale_2, offset_1);
    metal::float4 _e18 = turns_of(coordinates.z);
    metal::float2 _e19 = sin_cos_of_turns(_e18, scale_2, offset_1);
    metal::float4 _e21 = turns_of(coordinates.w);
    metal::float2 _e22 = sin_cos_of_turns(_e21, scale_2, offset_1);
    return Waves {metal::float4(_e13.x, _e16.x, _e19.x, _e22.x), metal::float4(_e13.y, _e16.y, _e19.y, _e22.y)};
}

metal::float4 four_coordinates(
    uint first,
    uint axis_1,
    constant Deformation& deformation,
    device type_8 const& counts,
    device type_8 const& dynamic_splats,
    device type_9 const& canonical_poses,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e3 = listed_splat(first, deformation, counts, dynamic_splats, _buffer_sizes);
    float _e7 = canonical_poses[_e3].position[axis_1];
    uint _e11 = listed_splat(first + 1u, deformation, counts, dynamic_splats, _buffer_sizes);
    float _e15 = canonical_poses[_e11].position[axis_1];
    uint _e19 = listed_splat(first + 2u, deformation, counts, dynamic_splats, _buffer_sizes);
    float _e23 = canonical_poses[_e19].position[axis_1];
    uint _e27 = listed_splat(first + 3u, deformation, counts, dynamic_splats, _buffer_sizes);
    float _e31 = canonical_poses[_e27].position[axis_1];
    return metal::float4(_e7, _e15, _e23, _e31);
}

metal::float3 screw_displacement(
    metal::float3 w,
    metal::float3 v,
    metal::float3 x_6
) {
    float theta_minus_sine = {};
    float theta = metal::sqrt(metal::dot(w, w));
    if (theta < 0.000000000000000000000000000000000000012) {
        return v;
    }
    metal::float3 axis_2 = (w / metal::float3(theta)) + metal::float3(0.00001);
    metal::float3 pitch = (v / metal::float3(theta)) + metal::float3(0.00001);
    metal::float4 _e17 = turns_of(theta);
    metal::float2 _e20 = sin_cos_of_turns(_e17, 1.0, 0.0);
    float sine_1 = _e20.x;
    metal::float2 _e24 = sin_cos_of_turns(_e17, 0.5, 0.0);
    float half_sine = _e24.x;
    float one_minus_cosine = (2.0 * half_sine) * half_sine;
    float t2_ = theta * theta;
    theta_minus_sine = theta - sine_1;
    if (theta < 0.5) {
        theta_minus_sine = (theta * t2_) * (0.16666667 - (t2_ * (0.008333334 - (t2_ / 5040.0))));
    }
    metal::float3 turned = (sine_1 * metal::cross(axis_2, x_6)) + (one_minus_cosine * metal::cross(axis_2, metal::cross(axis_2, x_6)));
    float _e53 = theta_minus_sine;
    metal::float3 moved = ((theta * pitch) + (one_minus_cosine * metal::cross(axis_2, pitch))) + (_e53 * metal::cross(axis_2, metal::cross(axis_2, pitch)));
    return turned + moved;
}

metal::float4 combined_rotation(
    metal::float4 sum,
    constant Deformation& deformation
) {
    bool local_2 = {};
    bool local_3 = {};
    bool local_4 = {};
    bool local_5 = {};
    float largest = metal::max(metal::max(metal::abs(sum.x), metal::abs(sum.y)), metal::max(metal::abs(sum.z), metal::abs(sum.w)));
    bool _e13 = is_finite(sum.x);
    if (_e13) {
        bool _e17 = is_finite(sum.y);
        local_2 = _e17;
    } else {
        local_2 = false;
    }
    bool _e19 = local_2;
    if (_e19) {
        bool _e23 = is_finite(sum.z);
        local_3 = _e23;
    } else {
        local_3 = false;
    }
    bool _e25 = local_3;
    if (_e25) {
        bool _e29 = is_finite(sum.w);
        local_4 = _e29;
    } else {
        local_4 = false;
    }
    bool finite = local_4;
    metal::float4 identity = metal::float4(1.0, 0.0, 0.0, 0.0);
    if (!(!(finite))) {
        local_5 = largest == 0.0;
    } else {
        local_5 = true;
    }
    bool _e44 = local_5;
    if (_e44) {
        return identity;
    }
    metal::float4 scaled_1 = sum / metal::float4(largest);
    float norm = metal::sqrt(metal::dot(scaled_1, scaled_1));
    if ((norm * largest) < MIN_ROTATION_NORM) {
        return identity;
    }
    uint _e56 = deformation.as_trained;
    return (_e56 != 0u) ? sum : (scaled_1 / metal::float4(norm));
}

float deformed_scale(
    float scale_1
) {
    bool _e1 = is_nan(scale_1);
    if (_e1) {
        return scale_1;
    }
    return metal::clamp(scale_1, MIN_DEFORMED_SCALE, MAX_SCALE);
}

Pose apply_outputs(
    Pose canonical,
    metal::float4 a_4,
    metal::float4 b_4,
    metal::float4 c,
    metal::float4 d,
    constant Deformation& deformation
) {
    metal::float3 displacement = {};
    metal::float4 d_rotation = {};
    metal::float3 d_scale = {};
    Pose pose = {};
    displacement = a_4.xyz;
    d_rotation = metal::float4(a_4.w, b_4.xyz);
    d_scale = metal::float3(b_4.w, c.xy);
    uint _e17 = deformation.screw;
    if (_e17 != 0u) {
        metal::float4 _e23 = deformation.origin;
        metal::float3 world = canonical.position + _e23.xyz;
        metal::float3 _e30 = screw_displacement(a_4.xyz, metal::float3(a_4.w, b_4.xy), world);
        displacement = _e30;
        d_rotation = metal::float4(b_4.zw, c.xy);
        d_scale = metal::float3(c.zw, d.x);
    }
    pose = canonical;
    metal::float3 _e40 = displacement;
    pose.position = canonical.position + _e40;
    metal::float4 _e44 = d_rotation;
    metal::float4 _e46 = combined_rotation(canonical.rotation + _e44, deformation);
    pose.rotation = _e46;
    metal::float3 _e48 = d_scale;
    metal::float3 scale_3 = canonical.scale + _e48;
    float _e52 = deformed_scale(scale_3.x);
    float _e54 = deformed_scale(scale_3.y);
    float _e56 = deformed_scale(scale_3.z);
    pose.scale = metal::float3(_e52, _e54, _e56);
    Pose _e58 = pose;
    return _e58;
}

void encode(
    uint first_1,
    uint thread_1,
    constant Deformation& deformation,
    device type_8 const& counts,
    device type_8 const& dynamic_splats,
    device type_9 const& canonical_poses,
    threadgroup type_13& hidden,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint task = {};
    uint i_1 = {};
    uint task_1 = {};
    uint task_2 = {};
    uint _e6 = deformation.octaves;
    uint waves = 3u * _e6;
    task = thread_1;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e67 = task;
            task = _e67 + THREADS;
        }
        loop_init = false;
        uint _e9 = task;
        if (_e9 < (16u * waves)) {
        } else {
            break;
        }
        {
            uint _e12 = task;
            uint quad_ = naga_mod(_e12, 16u);
            uint _e14 = task;
            uint axis_3 = naga_mod(naga_div(_e14, 16u), 3u);
            uint _e18 = task;
            uint octave_1 = naga_div(_e18, 16u * 3u);
            metal::float4 _e25 = four_coordinates(first_1 + (4u * quad_), axis_3, deformation, counts, dynamic_splats, canonical_poses, _buffer_sizes);
            Waves _e26 = waves_of(_e25, axis_3, octave_1, deformation);
            uint at_1 = ((((4u * quad_) * STRIDE) + 3u) + (6u * octave_1)) + axis_3;
            i_1 = 0u;
            bool loop_init_1 = true;
            while(true) {
                if (!loop_init_1) {
                    uint _e65 = i_1;
                    i_1 = _e65 + 1u;
                }
                loop_init_1 = false;
                uint _e39 = i_1;
                if (_e39 < 4u) {
                } else {
                    break;
                }
                {
                    uint _e43 = i_1;
                    uint _e49 = i_1;
                    hidden.inner[at_1 + (_e43 * STRIDE)] = static_cast<half>(_e26.sine[_e49]);
                    uint _e53 = i_1;
                    uint _e61 = i_1;
                    hidden.inner[(at_1 + (_e53 * STRIDE)) + 3u] = static_cast<half>(_e26.cosine[_e61]);
                }
            }
        }
    }
    task_1 = thread_1;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e98 = task_1;
            task_1 = _e98 + THREADS;
        }
        loop_init_2 = false;
        uint _e71 = task_1;
        if (_e71 < 192u) {
        } else {
            break;
        }
        {
            uint _e74 = task_1;
            uint splat_1 = naga_div(_e74, 3u);
            uint _e77 = task_1;
            uint axis_4 = naga_mod(_e77, 3u);
            uint _e82 = listed_splat(first_1 + splat_1, deformation, counts, dynamic_splats, _buffer_sizes);
            float position = canonical_poses[_e82].position[axis_4];
            float _e95 = deformation.origin[axis_4];
            hidden.inner[(splat_1 * STRIDE) + axis_4] = static_cast<half>(position + _e95);
        }
    }
    uint _e105 = deformation.octaves;
    uint used = 3u + (6u * _e105);
    uint _e110 = deformation.input_rows;
    uint unused = _e110 - used;
    task_2 = thread_1;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e128 = task_2;
            task_2 = _e128 + THREADS;
        }
        loop_init_3 = false;
        uint _e113 = task_2;
        if (_e113 < (SPLATS * unused)) {
        } else {
            break;
        }
        {
            uint _e118 = task_2;
            uint _e123 = task_2;
            hidden.inner[((naga_div(_e118, unused) * STRIDE) + used) + naga_mod(_e123, unused)] = 0.0h;
        }
    }
    return;
}

void finish_tile(
    uint splat_tile,
    uint feature,
    uint bias_at,
    uint group_1,
    uint lane,
    device type_12 const& biases,
    threadgroup type_13& hidden,
    threadgroup type_14& scratch,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint i_2 = 0u;
    uint splat_2 = naga_div(lane, 2u);
    uint column = 8u * naga_mod(lane, 2u);
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e51 = i_2;
            i_2 = _e51 + 1u;
        }
        loop_init_4 = false;
        uint _e13 = i_2;
        if (_e13 < 8u) {
        } else {
            break;
        }
        {
            uint _e23 = i_2;
            float _e26 = scratch.inner[(((group_1 * 256u) + (splat_2 * 16u)) + column) + _e23];
            uint _e30 = i_2;
            float _e33 = biases[((bias_at + feature) + column) + _e30];
            float sum_1 = _e26 + _e33;
            uint _e42 = i_2;
            uint at_2 = (((((16u * splat_tile) + splat_2) * STRIDE) + feature) + column) + _e42;
            hidden.inner[at_2] = static_cast<half>(metal::clamp(sum_1, 0.0, 65504.0));
        }
    }
    return;
}

metal::float4 four_outputs(
    uint splat,
    uint output,
    constant Deformation& deformation,
    device type_12 const& biases,
    threadgroup type_14& scratch,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint at_3 = (splat * HEAD_OUTPUTS) + output;
    uint _e7 = deformation.depth;
    uint bias = (_e7 * WIDTH) + output;
    float _e13 = scratch.inner[at_3];
    float _e16 = biases[bias];
    float _e22 = scratch.inner[at_3 + 1u];
    float _e27 = biases[bias + 1u];
    float _e33 = scratch.inner[at_3 + 2u];
    float _e38 = biases[bias + 2u];
    float _e44 = scratch.inner[at_3 + 3u];
    float _e49 = biases[bias + 3u];
    return metal::float4(_e13 + _e16, _e22 + _e27, _e33 + _e38, _e44 + _e49);
}
metal::simdgroup_half16x16 NagaCooperativeLoad(const device half* ptr, int stride, bool is_row_major) {
    metal::simdgroup_half16x16 m;
    simdgroup_load(m, ptr, stride, 0, is_row_major);
    return m;
}

metal::simdgroup_half16x16 NagaCooperativeLoad(const threadgroup half* ptr, int stride, bool is_row_major) {
    metal::simdgroup_half16x16 m;
    simdgroup_load(m, ptr, stride, 0, is_row_major);
    return m;
}

metal::simdgroup_float16x16 NagaCooperativeMultiplyAdd(const thread metal::simdgroup_half16x16& a, const thread metal::simdgroup_half16x16& b, const thread metal::simdgroup_float16x16& c) {
    metal::simdgroup_float16x16 d;
    simdgroup_multiply_accumulate(d,a,b,c);
    return d;
}


struct deform_matrixInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void deform_matrix(
  metal::uint3 group_id [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Deformation& deformation [[user(fake0)]]
, device type_8 const& counts [[user(fake0)]]
, device type_8 const& dynamic_splats [[user(fake0)]]
, device type_9 const& canonical_poses [[user(fake0)]]
, device type_9& poses [[user(fake0)]]
, device type_11 const& weights [[user(fake0)]]
, device type_12 const& biases [[user(fake0)]]
, threadgroup type_13& hidden
, threadgroup type_14& scratch
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint row = 0u;
    uint layer = 0u;
    metal::simdgroup_float16x16 c00_ = {};
    metal::simdgroup_float16x16 c10_ = {};
    metal::simdgroup_float16x16 c20_ = {};
    metal::simdgroup_float16x16 c30_ = {};
    metal::simdgroup_float16x16 c01_ = {};
    metal::simdgroup_float16x16 c11_ = {};
    metal::simdgroup_float16x16 c21_ = {};
    metal::simdgroup_float16x16 c31_ = {};
    uint turn = {};
    bool local = {};
    uint k = {};
    metal::simdgroup_float16x16 outputs = metal::simdgroup_float16x16 {};
    uint k_1 = 0u;
    bool local_1 = {};
    uint _e3 = flat_group(group_id, groups);
    uint first_2 = _e3 * SPLATS;
    uint group_2 = naga_div(thread_, 32u);
    uint lane_1 = naga_mod(thread_, 32u);
    uint feature_1 = 32u * group_2;
    encode(first_2, thread_, deformation, counts, dynamic_splats, canonical_poses, hidden, _buffer_sizes);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e192 = layer;
            layer = _e192 + 1u;
        }
        loop_init_5 = false;
        uint _e16 = layer;
        uint _e19 = deformation.depth;
        if (_e16 < _e19) {
        } else {
            break;
        }
        {
            c00_ = metal::simdgroup_float16x16 {};
            c10_ = metal::simdgroup_float16x16 {};
            c20_ = metal::simdgroup_float16x16 {};
            c30_ = metal::simdgroup_float16x16 {};
            c01_ = metal::simdgroup_float16x16 {};
            c11_ = metal::simdgroup_float16x16 {};
            c21_ = metal::simdgroup_float16x16 {};
            c31_ = metal::simdgroup_float16x16 {};
            uint _e39 = layer;
            uint _e42 = deformation.skip_layer;
            uint turns_1 = (_e39 == _e42) ? 2u : 1u;
            turn = 0u;
            bool loop_init_6 = true;
            while(true) {
                if (!loop_init_6) {
                    uint _e136 = turn;
                    turn = _e136 + 1u;
                }
                loop_init_6 = false;
                uint _e47 = turn;
                if (_e47 < turns_1) {
                } else {
                    break;
                }
                {
                    uint _e49 = turn;
                    if (_e49 == 1u) {
                        metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
                        encode(first_2, thread_, deformation, counts, dynamic_splats, canonical_poses, hidden, _buffer_sizes);
                        metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
                    }
                    uint _e55 = deformation.input_rows;
                    uint _e56 = layer;
                    if (!((_e56 == 0u))) {
                        uint _e62 = turn;
                        local = _e62 == 1u;
                    } else {
                        local = true;
                    }
                    bool _e66 = local;
                    uint rows_1 = _e66 ? _e55 : WIDTH;
                    k = 0u;
                    bool loop_init_7 = true;
                    while(true) {
                        if (!loop_init_7) {
                            uint _e130 = k;
                            k = _e130 + 16u;
                        }
                        loop_init_7 = false;
                        uint _e70 = k;
                        if (_e70 < rows_1) {
                        } else {
                            break;
                        }
                        {
                            uint _e72 = row;
                            uint _e73 = k;
                            uint weight_at = ((_e72 + _e73) * WIDTH) + feature_1;
                            metal::simdgroup_half16x16 b0_ = NagaCooperativeLoad(&weights[weight_at], WIDTH, false);
                            metal::simdgroup_half16x16 b1_ = NagaCooperativeLoad(&weights[weight_at + 16u], WIDTH, false);
                            uint _e89 = k;
                            metal::simdgroup_half16x16 a0_ = NagaCooperativeLoad(&hidden.inner[_e89], STRIDE, false);
                            metal::simdgroup_float16x16 _e93 = c00_;
                            c00_ = NagaCooperativeMultiplyAdd(a0_, b0_, _e93);
                            metal::simdgroup_float16x16 _e95 = c01_;
                            c01_ = NagaCooperativeMultiplyAdd(a0_, b1_, _e95);
                            uint _e99 = k;
                            metal::simdgroup_half16x16 a1_ = NagaCooperativeLoad(&hidden.inner[4224u + _e99], STRIDE, false);
                            metal::simdgroup_float16x16 _e104 = c10_;
                            c10_ = NagaCooperativeMultiplyAdd(a1_, b0_, _e104);
                            metal::simdgroup_float16x16 _e106 = c11_;
                            c11_ = NagaCooperativeMultiplyAdd(a1_, b1_, _e106);
                            uint _e110 = k;
                            metal::simdgroup_half16x16 a2_ = NagaCooperativeLoad(&hidden.inner[8448u + _e110], STRIDE, false);
                            metal::simdgroup_float16x16 _e115 = c20_;
                            c20_ = NagaCooperativeMultiplyAdd(a2_, b0_, _e115);
                            metal::simdgroup_float16x16 _e117 = c21_;
                            c21_ = NagaCooperativeMultiplyAdd(a2_, b1_, _e117);
                            uint _e121 = k;
                            metal::simdgroup_half16x16 a3_ = NagaCooperativeLoad(&hidden.inner[12672u + _e121], STRIDE, false);
                            metal::simdgroup_float16x16 _e126 = c30_;
                            c30_ = NagaCooperativeMultiplyAdd(a3_, b0_, _e126);
                            metal::simdgroup_float16x16 _e128 = c31_;
                            c31_ = NagaCooperativeMultiplyAdd(a3_, b1_, _e128);
                        }
                    }
                    uint _e133 = row;
                    row = _e133 + rows_1;
                }
            }
            uint _e138 = layer;
            uint bias_at_1 = _e138 * WIDTH;
            uint scratch_at = group_2 * 256u;
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            metal::simdgroup_float16x16 _e143 = c00_;
            simdgroup_store(_e143, &scratch.inner[scratch_at], 16u);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            finish_tile(0u, feature_1, bias_at_1, group_2, lane_1, biases, hidden, scratch, _buffer_sizes);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            metal::simdgroup_float16x16 _e148 = c10_;
            simdgroup_store(_e148, &scratch.inner[scratch_at], 16u);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            finish_tile(1u, feature_1, bias_at_1, group_2, lane_1, biases, hidden, scratch, _buffer_sizes);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            metal::simdgroup_float16x16 _e153 = c20_;
            simdgroup_store(_e153, &scratch.inner[scratch_at], 16u);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            finish_tile(2u, feature_1, bias_at_1, group_2, lane_1, biases, hidden, scratch, _buffer_sizes);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            metal::simdgroup_float16x16 _e158 = c30_;
            simdgroup_store(_e158, &scratch.inner[scratch_at], 16u);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            finish_tile(3u, feature_1, bias_at_1, group_2, lane_1, biases, hidden, scratch, _buffer_sizes);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            metal::simdgroup_float16x16 _e163 = c01_;
            simdgroup_store(_e163, &scratch.inner[scratch_at], 16u);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            finish_tile(0u, feature_1 + 16u, bias_at_1, group_2, lane_1, biases, hidden, scratch, _buffer_sizes);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            metal::simdgroup_float16x16 _e170 = c11_;
            simdgroup_store(_e170, &scratch.inner[scratch_at], 16u);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            finish_tile(1u, feature_1 + 16u, bias_at_1, group_2, lane_1, biases, hidden, scratch, _buffer_sizes);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            metal::simdgroup_float16x16 _e177 = c21_;
            simdgroup_store(_e177, &scratch.inner[scratch_at], 16u);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            finish_tile(2u, feature_1 + 16u, bias_at_1, group_2, lane_1, biases, hidden, scratch, _buffer_sizes);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            metal::simdgroup_float16x16 _e184 = c31_;
            simdgroup_store(_e184, &scratch.inner[scratch_at], 16u);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            finish_tile(3u, feature_1 + 16u, bias_at_1, group_2, lane_1, biases, hidden, scratch, _buffer_sizes);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
        }
    }
    uint splat_tile_1 = metal::min(group_2, 3u);
    bool loop_init_8 = true;
    while(true) {
        if (!loop_init_8) {
            uint _e226 = k_1;
            k_1 = _e226 + 16u;
        }
        loop_init_8 = false;
        uint _e200 = k_1;
        if (_e200 < WIDTH) {
        } else {
            break;
        }
        {
            uint _e203 = row;
            uint _e206 = k_1;
            uint at_4 = (_e203 * WIDTH) + (_e206 * HEAD_OUTPUTS);
            metal::simdgroup_half16x16 b_5 = NagaCooperativeLoad(&weights[at_4], HEAD_OUTPUTS, false);
            uint _e219 = k_1;
            metal::simdgroup_half16x16 a_5 = NagaCooperativeLoad(&hidden.inner[((16u * splat_tile_1) * STRIDE) + _e219], STRIDE, false);
            metal::simdgroup_float16x16 _e224 = outputs;
            outputs = NagaCooperativeMultiplyAdd(a_5, b_5, _e224);
        }
    }
    metal::simdgroup_float16x16 _e229 = outputs;
    simdgroup_store(_e229, &scratch.inner[group_2 * 256u], 16u);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    if (thread_ < SPLATS) {
        uint _e240 = evaluated_splats(deformation, counts, _buffer_sizes);
        local_1 = (first_2 + thread_) < _e240;
    } else {
        local_1 = false;
    }
    bool _e243 = local_1;
    if (_e243) {
        uint _e245 = listed_splat(first_2 + thread_, deformation, counts, dynamic_splats, _buffer_sizes);
        Pose _e250 = canonical_poses[_e245];
        metal::float4 _e252 = four_outputs(thread_, 0u, deformation, biases, scratch, _buffer_sizes);
        metal::float4 _e254 = four_outputs(thread_, 4u, deformation, biases, scratch, _buffer_sizes);
        metal::float4 _e256 = four_outputs(thread_, 8u, deformation, biases, scratch, _buffer_sizes);
        metal::float4 _e258 = four_outputs(thread_, 12u, deformation, biases, scratch, _buffer_sizes);
        Pose _e259 = apply_outputs(_e250, _e252, _e254, _e256, _e258, deformation);
        poses[_e245] = _e259;
        return;
    } else {
        return;
    }
}
