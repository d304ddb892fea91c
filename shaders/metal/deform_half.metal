// Made from shaders/deform_half.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size1;
    uint size2;
    uint size3;
    uint size6;
    uint size7;
    uint size8;
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
typedef metal::half4 Stored;
struct type_10 {
    Stored inner[1024];
};
struct type_11 {
    metal::float4 inner[64];
};
typedef Stored type_12[1];
typedef metal::float4 type_13[1];
struct Block {
    metal::float4 s0_;
    metal::float4 s1_;
    metal::float4 s2_;
    metal::float4 s3_;
    metal::float4 s4_;
    metal::float4 s5_;
    metal::float4 s6_;
    metal::float4 s7_;
    metal::float4 s8_;
    metal::float4 s9_;
    metal::float4 s10_;
    metal::float4 s11_;
    metal::float4 s12_;
    metal::float4 s13_;
    metal::float4 s14_;
    metal::float4 s15_;
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
constant uint HIDDEN_VECTORS = 1024u;
constant uint SPLATS = 16u;
constant uint OUTPUT_VECTORS = 64u;
constant uint WIDTH = 256u;
constant uint THREADS = 64u;

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

metal::float4 turns_of(
    float x_2
) {
    float high = as_type<float>(as_type<uint>(x_2) & 4294963200u);
    float low = x_2 - high;
    return metal::float4(high * INVERSE_TAU_1_, low * INVERSE_TAU_1_, high * INVERSE_TAU_2_, (low * INVERSE_TAU_2_) + (x_2 * INVERSE_TAU_3_));
}

float without_whole(
    float x_3
) {
    return x_3 - metal::rint(x_3);
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
    uint i_1,
    constant Deformation& deformation,
    device type_8 const& counts,
    device type_8 const& dynamic_splats,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e1 = evaluated_splats(deformation, counts, _buffer_sizes);
    uint last = _e1 - 1u;
    uint at_3 = metal::min(i_1, last);
    uint _e7 = deformation.masked;
    if (_e7 != 0u) {
        uint _e12 = dynamic_splats[at_3];
        return _e12;
    }
    return at_3;
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
    metal::float3 x_4
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
    metal::float3 turned = (sine_1 * metal::cross(axis_2, x_4)) + (one_minus_cosine * metal::cross(axis_2, metal::cross(axis_2, x_4)));
    float _e53 = theta_minus_sine;
    metal::float3 moved = ((theta * pitch) + (one_minus_cosine * metal::cross(axis_2, pitch))) + (_e53 * metal::cross(axis_2, metal::cross(axis_2, pitch)));
    return turned + moved;
}

metal::float4 combined_rotation(
    metal::float4 sum,
    constant Deformation& deformation
) {
    bool local_1 = {};
    bool local_2 = {};
    bool local_3 = {};
    bool local_4 = {};
    float largest = metal::max(metal::max(metal::abs(sum.x), metal::abs(sum.y)), metal::max(metal::abs(sum.z), metal::abs(sum.w)));
    bool _e13 = is_finite(sum.x);
    if (_e13) {
        bool _e17 = is_finite(sum.y);
        local_1 = _e17;
    } else {
        local_1 = false;
    }
    bool _e19 = local_1;
    if (_e19) {
        bool _e23 = is_finite(sum.z);
        local_2 = _e23;
    } else {
        local_2 = false;
    }
    bool _e25 = local_2;
    if (_e25) {
        bool _e29 = is_finite(sum.w);
        local_3 = _e29;
    } else {
        local_3 = false;
    }
    bool finite = local_3;
    metal::float4 identity = metal::float4(1.0, 0.0, 0.0, 0.0);
    if (!(!(finite))) {
        local_4 = largest == 0.0;
    } else {
        local_4 = true;
    }
    bool _e44 = local_4;
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
    metal::float4 a,
    metal::float4 b,
    metal::float4 c,
    metal::float4 d,
    constant Deformation& deformation
) {
    metal::float3 displacement = {};
    metal::float4 d_rotation = {};
    metal::float3 d_scale = {};
    Pose pose = {};
    displacement = a.xyz;
    d_rotation = metal::float4(a.w, b.xyz);
    d_scale = metal::float3(b.w, c.xy);
    uint _e17 = deformation.screw;
    if (_e17 != 0u) {
        metal::float4 _e23 = deformation.origin;
        metal::float3 world = canonical.position + _e23.xyz;
        metal::float3 _e30 = screw_displacement(a.xyz, metal::float3(a.w, b.xy), world);
        displacement = _e30;
        d_rotation = metal::float4(b.zw, c.xy);
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

void keep_outputs(
    uint task,
    metal::float4 outputs,
    threadgroup type_11& outputs_of_splats
) {
    outputs_of_splats.inner[task] = outputs;
    return;
}

metal::float4 kept_outputs(
    uint task_1,
    threadgroup type_11& outputs_of_splats
) {
    metal::float4 _e3 = outputs_of_splats.inner[task_1];
    return _e3;
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

void encode(
    uint first_1,
    uint thread_1,
    constant Deformation& deformation,
    device type_8 const& counts,
    device type_8 const& dynamic_splats,
    device type_9 const& canonical_poses,
    threadgroup type_10& hidden,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint task_2 = {};
    uint task_3 = {};
    uint at = {};
    uint _e9 = deformation.octaves;
    uint waves = 3u * _e9;
    task_2 = thread_1;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e49 = task_2;
            task_2 = _e49 + THREADS;
        }
        loop_init = false;
        uint _e12 = task_2;
        if (_e12 < (4u * waves)) {
        } else {
            break;
        }
        {
            uint _e15 = task_2;
            uint quad_2 = naga_mod(_e15, 4u);
            uint _e17 = task_2;
            uint axis_3 = naga_mod(naga_div(_e17, 4u), 3u);
            uint _e21 = task_2;
            uint octave_1 = naga_div(_e21, 12u);
            metal::float4 _e28 = four_coordinates(first_1 + (4u * quad_2), axis_3, deformation, counts, dynamic_splats, canonical_poses, _buffer_sizes);
            Waves _e29 = waves_of(_e28, axis_3, octave_1, deformation);
            uint row_3 = (3u + (6u * octave_1)) + axis_3;
            hidden.inner[(row_3 * 4u) + quad_2] = static_cast<metal::half4>(_e29.sine);
            hidden.inner[((row_3 + 3u) * 4u) + quad_2] = static_cast<metal::half4>(_e29.cosine);
        }
    }
    task_3 = thread_1;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e76 = task_3;
            task_3 = _e76 + THREADS;
        }
        loop_init_1 = false;
        uint _e53 = task_3;
        if (_e53 < 12u) {
        } else {
            break;
        }
        {
            uint _e57 = task_3;
            uint quad_3 = naga_mod(_e57, 4u);
            uint _e59 = task_3;
            uint axis_4 = naga_div(_e59, 4u);
            metal::float4 _e64 = four_coordinates(first_1 + (4u * quad_3), axis_4, deformation, counts, dynamic_splats, canonical_poses, _buffer_sizes);
            float _e68 = deformation.origin[axis_4];
            metal::float4 world_1 = _e64 + metal::float4(_e68);
            hidden.inner[(axis_4 * 4u) + quad_3] = static_cast<metal::half4>(world_1);
        }
    }
    uint _e83 = deformation.octaves;
    uint used = (3u + (6u * _e83)) * 4u;
    at = used + thread_1;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e99 = at;
            at = _e99 + THREADS;
        }
        loop_init_2 = false;
        uint _e89 = at;
        uint _e92 = deformation.input_rows;
        if (_e89 < (_e92 * 4u)) {
        } else {
            break;
        }
        {
            uint _e96 = at;
            hidden.inner[_e96] = Stored {};
        }
    }
    return;
}

void multiply_add(
    thread Block& block_1,
    metal::float4 w_1,
    uint at_1,
    threadgroup type_10& hidden
) {
    Stored _e5 = hidden.inner[at_1];
    metal::float4 a_2 = static_cast<metal::float4>(_e5);
    Stored _e11 = hidden.inner[at_1 + 1u];
    metal::float4 b_2 = static_cast<metal::float4>(_e11);
    Stored _e17 = hidden.inner[at_1 + 2u];
    metal::float4 c_2 = static_cast<metal::float4>(_e17);
    Stored _e23 = hidden.inner[at_1 + 3u];
    metal::float4 d_2 = static_cast<metal::float4>(_e23);
    metal::float4 _e29 = block_1.s0_;
    block_1.s0_ = metal::fma(w_1, metal::float4(a_2.x), _e29);
    metal::float4 _e35 = block_1.s1_;
    block_1.s1_ = metal::fma(w_1, metal::float4(a_2.y), _e35);
    metal::float4 _e41 = block_1.s2_;
    block_1.s2_ = metal::fma(w_1, metal::float4(a_2.z), _e41);
    metal::float4 _e47 = block_1.s3_;
    block_1.s3_ = metal::fma(w_1, metal::float4(a_2.w), _e47);
    metal::float4 _e53 = block_1.s4_;
    block_1.s4_ = metal::fma(w_1, metal::float4(b_2.x), _e53);
    metal::float4 _e59 = block_1.s5_;
    block_1.s5_ = metal::fma(w_1, metal::float4(b_2.y), _e59);
    metal::float4 _e65 = block_1.s6_;
    block_1.s6_ = metal::fma(w_1, metal::float4(b_2.z), _e65);
    metal::float4 _e71 = block_1.s7_;
    block_1.s7_ = metal::fma(w_1, metal::float4(b_2.w), _e71);
    metal::float4 _e77 = block_1.s8_;
    block_1.s8_ = metal::fma(w_1, metal::float4(c_2.x), _e77);
    metal::float4 _e83 = block_1.s9_;
    block_1.s9_ = metal::fma(w_1, metal::float4(c_2.y), _e83);
    metal::float4 _e89 = block_1.s10_;
    block_1.s10_ = metal::fma(w_1, metal::float4(c_2.z), _e89);
    metal::float4 _e95 = block_1.s11_;
    block_1.s11_ = metal::fma(w_1, metal::float4(c_2.w), _e95);
    metal::float4 _e101 = block_1.s12_;
    block_1.s12_ = metal::fma(w_1, metal::float4(d_2.x), _e101);
    metal::float4 _e107 = block_1.s13_;
    block_1.s13_ = metal::fma(w_1, metal::float4(d_2.y), _e107);
    metal::float4 _e113 = block_1.s14_;
    block_1.s14_ = metal::fma(w_1, metal::float4(d_2.z), _e113);
    metal::float4 _e119 = block_1.s15_;
    block_1.s15_ = metal::fma(w_1, metal::float4(d_2.w), _e119);
    return;
}

void accumulate(
    thread Block& block_2,
    uint first_row,
    uint rows,
    uint features,
    uint quad_,
    threadgroup type_10& hidden,
    device type_12 const& weights,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint weight_at = {};
    uint hidden_at = {};
    Stored w0_ = {};
    Stored w1_ = {};
    Stored w2_ = {};
    Stored w3_ = {};
    uint row_1 = 0u;
    weight_at = (first_row * 64u) + features;
    hidden_at = quad_;
    uint _e14 = weight_at;
    Stored _e16 = weights[_e14];
    w0_ = _e16;
    uint _e19 = weight_at;
    Stored _e26 = weights[_e19 + 64u];
    w1_ = _e26;
    uint _e29 = weight_at;
    Stored _e38 = weights[_e29 + 128u];
    w2_ = _e38;
    uint _e41 = weight_at;
    Stored _e50 = weights[_e41 + 192u];
    w3_ = _e50;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e128 = row_1;
            row_1 = _e128 + 4u;
        }
        loop_init_3 = false;
        uint _e54 = row_1;
        if (_e54 < rows) {
        } else {
            break;
        }
        {
            uint _e56 = weight_at;
            weight_at = _e56 + WIDTH;
            uint _e60 = weight_at;
            Stored next0_ = weights[_e60];
            uint _e64 = weight_at;
            Stored next1_ = weights[_e64 + 64u];
            uint _e73 = weight_at;
            Stored next2_ = weights[_e73 + 128u];
            uint _e84 = weight_at;
            Stored next3_ = weights[_e84 + 192u];
            Stored _e94 = w0_;
            uint _e96 = hidden_at;
            multiply_add(block_2, static_cast<metal::float4>(_e94), _e96, hidden);
            Stored _e97 = w1_;
            uint _e99 = hidden_at;
            multiply_add(block_2, static_cast<metal::float4>(_e97), _e99 + 4u, hidden);
            Stored _e105 = w2_;
            uint _e107 = hidden_at;
            multiply_add(block_2, static_cast<metal::float4>(_e105), _e107 + 8u, hidden);
            Stored _e115 = w3_;
            uint _e117 = hidden_at;
            multiply_add(block_2, static_cast<metal::float4>(_e115), _e117 + 12u, hidden);
            uint _e125 = hidden_at;
            hidden_at = _e125 + SPLATS;
            w0_ = next0_;
            w1_ = next1_;
            w2_ = next2_;
            w3_ = next3_;
        }
    }
    return;
}

void store_quad(
    uint at_2,
    metal::float4 a_1,
    metal::float4 b_1,
    metal::float4 c_1,
    metal::float4 d_1,
    threadgroup type_10& hidden
) {
    metal::float4 zero = metal::float4(0.0);
    metal::float4x4 rows_1 = metal::transpose(metal::float4x4(metal::max(a_1, zero), metal::max(b_1, zero), metal::max(c_1, zero), metal::max(d_1, zero)));
    hidden.inner[at_2] = static_cast<metal::half4>(rows_1[0]);
    hidden.inner[at_2 + 4u] = static_cast<metal::half4>(rows_1[1]);
    hidden.inner[at_2 + 8u] = static_cast<metal::half4>(rows_1[2]);
    hidden.inner[at_2 + 12u] = static_cast<metal::half4>(rows_1[3]);
    return;
}

void store(
    Block block_3,
    uint features_1,
    uint quad_1,
    threadgroup type_10& hidden
) {
    uint at_4 = ((4u * features_1) * 4u) + quad_1;
    store_quad(at_4, block_3.s0_, block_3.s1_, block_3.s2_, block_3.s3_, hidden);
    store_quad(at_4 + 1u, block_3.s4_, block_3.s5_, block_3.s6_, block_3.s7_, hidden);
    store_quad(at_4 + 2u, block_3.s8_, block_3.s9_, block_3.s10_, block_3.s11_, hidden);
    store_quad(at_4 + 3u, block_3.s12_, block_3.s13_, block_3.s14_, block_3.s15_, hidden);
    return;
}

metal::float4 head(
    uint task_4,
    uint head_weights,
    uint head_biases,
    threadgroup type_10& hidden,
    device type_12 const& weights,
    device type_13 const& biases,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::float4 sum_1 = {};
    uint row_2 = 0u;
    uint quarter = naga_div(task_4, SPLATS);
    if (quarter >= 4u) {
        return metal::float4(0.0);
    }
    uint splat = naga_mod(task_4, SPLATS);
    metal::float4 _e14 = biases[head_biases + quarter];
    sum_1 = _e14;
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e50 = row_2;
            row_2 = _e50 + 1u;
        }
        loop_init_4 = false;
        uint _e18 = row_2;
        if (_e18 < WIDTH) {
        } else {
            break;
        }
        {
            uint _e22 = row_2;
            half _e35 = hidden.inner[(_e22 * 4u) + naga_div(splat, 4u)][naga_mod(splat, 4u)];
            float feature = static_cast<float>(_e35);
            metal::float4 _e37 = sum_1;
            uint _e40 = row_2;
            Stored _e45 = weights[(head_weights + (4u * _e40)) + quarter];
            sum_1 = _e37 + (static_cast<metal::float4>(_e45) * feature);
        }
    }
    metal::float4 _e52 = sum_1;
    return _e52;
}

void store_head(
    uint task_5,
    metal::float4 outputs_1,
    threadgroup type_11& outputs_of_splats
) {
    if (task_5 < 64u) {
        keep_outputs(task_5, outputs_1, outputs_of_splats);
        return;
    } else {
        return;
    }
}

struct deformInput {
};
[[max_total_threads_per_threadgroup(64)]] kernel void deform(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Deformation& deformation [[user(fake0)]]
, device type_8 const& counts [[user(fake0)]]
, device type_8 const& dynamic_splats [[user(fake0)]]
, device type_9 const& canonical_poses [[user(fake0)]]
, threadgroup type_10& hidden
, threadgroup type_11& outputs_of_splats
, device type_9& poses [[user(fake0)]]
, device type_12 const& weights [[user(fake0)]]
, device type_13 const& biases [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint row = 0u;
    uint layer = 0u;
    Block block = {};
    uint i = {};
    bool local = {};
    uint _e3 = flat_group(group, groups);
    uint first_2 = _e3 * SPLATS;
    uint features_2 = naga_mod(thread_, 64u);
    uint quad_4 = 4u * naga_div(thread_, 64u);
    encode(first_2, thread_, deformation, counts, dynamic_splats, canonical_poses, hidden, _buffer_sizes);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e66 = layer;
            layer = _e66 + 1u;
        }
        loop_init_5 = false;
        uint _e22 = layer;
        uint _e25 = deformation.depth;
        if (_e22 < _e25) {
        } else {
            break;
        }
        {
            uint _e28 = layer;
            metal::float4 bias = biases[(_e28 * 64u) + features_2];
            block = Block {bias, bias, bias, bias, bias, bias, bias, bias, bias, bias, bias, bias, bias, bias, bias, bias};
            uint _e42 = deformation.input_rows;
            uint _e43 = layer;
            uint rows_2 = (_e43 == 0u) ? _e42 : WIDTH;
            uint _e47 = row;
            accumulate(block, _e47, rows_2, features_2, quad_4, hidden, weights, _buffer_sizes);
            uint _e48 = row;
            row = _e48 + rows_2;
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e50 = layer;
            uint _e53 = deformation.skip_layer;
            if (_e50 == _e53) {
                encode(first_2, thread_, deformation, counts, dynamic_splats, canonical_poses, hidden, _buffer_sizes);
                metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
                uint _e55 = row;
                uint _e58 = deformation.input_rows;
                accumulate(block, _e55, _e58, features_2, quad_4, hidden, weights, _buffer_sizes);
                uint _e59 = row;
                uint _e62 = deformation.input_rows;
                row = _e59 + _e62;
                metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            }
            Block _e64 = block;
            store(_e64, features_2, quad_4, hidden);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
        }
    }
    uint _e68 = row;
    uint head_weights_1 = _e68 * 64u;
    uint _e76 = deformation.depth;
    uint head_biases_1 = _e76 * 64u;
    metal::float4 _e82 = head(thread_, head_weights_1, head_biases_1, hidden, weights, biases, _buffer_sizes);
    metal::float4 _e85 = head(thread_ + THREADS, head_weights_1, head_biases_1, hidden, weights, biases, _buffer_sizes);
    metal::float4 _e91 = head(thread_ + 128u, head_weights_1, head_biases_1, hidden, weights, biases, _buffer_sizes);
    metal::float4 _e97 = head(thread_ + 192u, head_weights_1, head_biases_1, hidden, weights, biases, _buffer_sizes);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    store_head(thread_, _e82, outputs_of_splats);
    store_head(thread_ + THREADS, _e85, outputs_of_splats);
    store_head(thread_ + 128u, _e91, outputs_of_splats);
    store_head(thread_ + 192u, _e97, outputs_of_splats);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    i = thread_;
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e151 = i;
            i = _e151 + THREADS;
        }
        loop_init_6 = false;
        uint _e111 = i;
        if (_e111 < SPLATS) {
            uint _e116 = i;
            uint _e118 = evaluated_splats(deformation, counts, _buffer_sizes);
            local = (first_2 + _e116) < _e118;
        } else {
            local = false;
        }
        bool _e121 = local;
        if (_e121) {
        } else {
            break;
        }
        {
            uint _e122 = i;
            uint _e124 = listed_splat(first_2 + _e122, deformation, counts, dynamic_splats, _buffer_sizes);
            Pose _e129 = canonical_poses[_e124];
            uint _e130 = i;
            metal::float4 _e131 = kept_outputs(_e130, outputs_of_splats);
            uint _e133 = i;
            metal::float4 _e135 = kept_outputs(SPLATS + _e133, outputs_of_splats);
            uint _e140 = i;
            metal::float4 _e142 = kept_outputs(32u + _e140, outputs_of_splats);
            uint _e147 = i;
            metal::float4 _e149 = kept_outputs(48u + _e147, outputs_of_splats);
            Pose _e150 = apply_outputs(_e129, _e131, _e135, _e142, _e149, deformation);
            poses[_e124] = _e150;
        }
    }
    return;
}
