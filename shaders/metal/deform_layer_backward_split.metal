// Made from shaders/deform_layer_backward_split.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size2;
    uint size3;
};

struct type_3 {
    metal::float4 inner[13];
};
struct NetworkChunk {
    uint first;
    uint splats;
    uint steps;
    uint starts_sum;
    uint octaves;
    uint time_features;
    uint encoding_row;
    uint row_vectors;
    type_3 time;
};
struct NetworkLayer {
    uint inputs;
    uint outputs;
    uint input_row;
    uint output_row;
    uint weights;
    uint encoded_inputs;
    uint row_vectors;
    uint most_parts;
    uint head_row;
};
struct Block {
    metal::float4 k0_;
    metal::float4 k1_;
    metal::float4 k2_;
    metal::float4 k3_;
};
typedef metal::float4 type_6[1];
struct type_9 {
    metal::half4 inner[768];
};
struct type_10 {
    metal::float4 inner[1024];
};
constant uint TILE = 128u;
constant uint TILE_VECTORS = 32u;
constant uint STEP = 16u;
constant uint SPLIT_STRIDE = 6u;
constant uint TILE_OF_ROWS = 96u;
constant uint SUMS = 128u;
constant float WEIGHT_SCALE = 64.0;
constant uint HEAD_OUTPUTS = 12u;
constant float FEATURE_SCALE = 0.0625;
constant float MOST_FEATURE = 1048064.0;

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

uint sum_parts(
    uint steps,
    uint most_parts
) {
    return metal::clamp(naga_div(steps, 4u), 1u, most_parts);
}

Block transposed(
    Block rows
) {
    metal::float4x4 columns = metal::transpose(metal::float4x4(rows.k0_, rows.k1_, rows.k2_, rows.k3_));
    return Block {columns[0], columns[1], columns[2], columns[3]};
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

metal::uint2 loaded_block(
    uint thread_1
) {
    uint t = naga_mod(thread_1, 128u);
    return metal::uint2(naga_div(t, 4u), naga_mod(t, 4u));
}

Block weight_block(
    uint output,
    uint input,
    constant NetworkLayer& layer,
    device type_6 const& parameters,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e4 = layer.inputs;
    uint stride_1 = naga_div(_e4, 4u);
    uint _e9 = layer.weights;
    uint at_2 = (_e9 + (output * stride_1)) + naga_div(input, 4u);
    metal::float4 _e17 = parameters[at_2];
    metal::float4 _e21 = parameters[at_2 + stride_1];
    metal::float4 _e27 = parameters[at_2 + (2u * stride_1)];
    metal::float4 _e33 = parameters[at_2 + (3u * stride_1)];
    return Block {_e17, _e21, _e27, _e33};
}

Block load_left(
    uint output_1,
    uint row,
    thread uint& first_input,
    constant NetworkLayer& layer,
    device type_6 const& parameters,
    constant _mslBufferSizes& _buffer_sizes
) {
    bool local = {};
    uint _e3 = first_input;
    uint input_1 = _e3 + row;
    uint _e7 = layer.outputs;
    if (!((output_1 >= _e7))) {
        uint _e14 = layer.inputs;
        local = input_1 >= _e14;
    } else {
        local = true;
    }
    bool _e17 = local;
    if (_e17) {
        return Block {};
    }
    Block _e19 = weight_block(output_1, input_1, layer, parameters, _buffer_sizes);
    return _e19;
}

Block activation_block(
    uint row_1,
    uint column,
    constant NetworkLayer& layer,
    device type_6 const& activations,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint stride_2 = layer.row_vectors;
    uint at_3 = (row_1 * stride_2) + naga_div(column, 4u);
    metal::float4 _e11 = activations[at_3];
    metal::float4 _e15 = activations[at_3 + stride_2];
    metal::float4 _e21 = activations[at_3 + (2u * stride_2)];
    metal::float4 _e27 = activations[at_3 + (3u * stride_2)];
    return Block {_e11, _e15, _e21, _e27};
}

Block load_right(
    uint output_2,
    uint column_1,
    constant NetworkLayer& layer,
    device type_6 const& activations,
    thread uint& first_column,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e4 = layer.outputs;
    if (output_2 >= _e4) {
        return Block {};
    }
    uint _e9 = layer.output_row;
    uint _e12 = first_column;
    Block _e14 = activation_block(_e9 + output_2, _e12 + column_1, layer, activations, _buffer_sizes);
    return _e14;
}

Block load_step(
    uint step,
    uint thread_2,
    thread uint& first_input,
    constant NetworkLayer& layer,
    device type_6 const& parameters,
    device type_6 const& activations,
    thread uint& first_column,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::uint2 _e2 = loaded_block(thread_2);
    uint contraction = (step * STEP) + (4u * _e2.y);
    if (thread_2 < 128u) {
        Block _e14 = load_left(contraction, 4u * _e2.x, first_input, layer, parameters, _buffer_sizes);
        return _e14;
    }
    Block _e18 = load_right(contraction, 4u * _e2.x, layer, activations, first_column, _buffer_sizes);
    return _e18;
}

metal::float4 high_part(
    metal::float4 value
) {
    metal::uint4 bits = as_type<metal::uint4>(value) + metal::uint4(4096u);
    return as_type<metal::float4>(bits & metal::uint4(4294959104u));
}

void store_left(
    uint at,
    metal::float4 value_1,
    threadgroup type_9& left_high,
    threadgroup type_9& left_low
) {
    metal::float4 _e2 = high_part(value_1);
    left_high.inner[at] = static_cast<metal::half4>(_e2);
    left_low.inner[at] = static_cast<metal::half4>(value_1 - _e2);
    return;
}

void store_right(
    uint at_1,
    metal::float4 value_2,
    threadgroup type_9& right_high,
    threadgroup type_9& right_low
) {
    metal::float4 _e2 = high_part(value_2);
    right_high.inner[at_1] = static_cast<metal::half4>(_e2);
    right_low.inner[at_1] = static_cast<metal::half4>(value_2 - _e2);
    return;
}

metal::float4 limited_right(
    metal::float4 gradients
) {
    return gradients;
}

void store_step(
    Block block,
    metal::float2 scales,
    uint thread_3,
    threadgroup type_9& left_high,
    threadgroup type_9& left_low,
    threadgroup type_9& right_high,
    threadgroup type_9& right_low
) {
    metal::uint2 _e3 = loaded_block(thread_3);
    uint at_4 = ((4u * _e3.x) * SPLIT_STRIDE) + _e3.y;
    Block _e11 = transposed(block);
    if (thread_3 < 128u) {
        store_left(at_4, scales.x * _e11.k0_, left_high, left_low);
        store_left(at_4 + SPLIT_STRIDE, scales.x * _e11.k1_, left_high, left_low);
        store_left(at_4 + 12u, scales.x * _e11.k2_, left_high, left_low);
        store_left(at_4 + 18u, scales.x * _e11.k3_, left_high, left_low);
        return;
    } else {
        metal::float4 _e34 = limited_right(_e11.k0_);
        store_right(at_4, scales.y * _e34, right_high, right_low);
        metal::float4 _e40 = limited_right(_e11.k1_);
        store_right(at_4 + SPLIT_STRIDE, scales.y * _e40, right_high, right_low);
        metal::float4 _e46 = limited_right(_e11.k2_);
        store_right(at_4 + 12u, scales.y * _e46, right_high, right_low);
        metal::float4 _e52 = limited_right(_e11.k3_);
        store_right(at_4 + 18u, scales.y * _e52, right_high, right_low);
        return;
    }
}

void store_row(
    uint row_2,
    uint column_2,
    metal::float4 value_3,
    thread uint& first_input,
    constant NetworkLayer& layer,
    device type_6& activations,
    thread uint& first_column,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e4 = first_input;
    uint input_2 = _e4 + row_2;
    uint _e8 = layer.inputs;
    if (input_2 >= _e8) {
        return;
    }
    uint _e12 = layer.input_row;
    uint _e16 = layer.row_vectors;
    uint _e19 = first_column;
    uint at_5 = ((_e12 + input_2) * _e16) + naga_div(_e19 + column_2, 4u);
    metal::float4 _e30 = activations[at_5];
    activations[at_5] = metal::select(metal::float4(0.0), value_3, _e30 > metal::float4(0.0));
    return;
}

void store_sums(
    uint row_3,
    uint column_3,
    float unscale,
    uint thread_4,
    thread uint& first_input,
    constant NetworkLayer& layer,
    device type_6& activations,
    thread uint& first_column,
    threadgroup type_10& sums,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint i = 0u;
    uint lane = naga_mod(thread_4, 32u);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e36 = i;
            i = _e36 + 1u;
        }
        loop_init = false;
        uint _e8 = i;
        if (_e8 < 4u) {
        } else {
            break;
        }
        {
            uint _e14 = i;
            uint tile_row = naga_div(lane, 8u) + (4u * _e14);
            uint vector = naga_mod(lane, 8u);
            metal::float4 sum = sums.inner[((naga_div(thread_4, 32u) * SUMS) + (8u * tile_row)) + vector];
            store_row(row_3 + tile_row, column_3 + (4u * vector), unscale * sum, first_input, layer, activations, first_column, _buffer_sizes);
        }
    }
    return;
}

float largest_of_sixteen(
    uint first,
    uint stride,
    threadgroup type_10& sums
) {
    float largest = 0.0;
    uint i_1 = 0u;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e19 = i_1;
            i_1 = _e19 + 1u;
        }
        loop_init_1 = false;
        uint _e6 = i_1;
        if (_e6 < 16u) {
        } else {
            break;
        }
        {
            float _e9 = largest;
            uint _e11 = i_1;
            float _e16 = sums.inner[first + (_e11 * stride)].x;
            largest = metal::max(_e9, _e16);
        }
    }
    float _e21 = largest;
    return _e21;
}

float gradient_scale(
    uint first_vector,
    uint vectors,
    uint thread_5,
    constant NetworkLayer& layer,
    device type_6 const& activations,
    threadgroup type_10& sums,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::float4 largest_1 = metal::float4(0.0);
    uint i_2 = {};
    i_2 = thread_5;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e31 = i_2;
            i_2 = _e31 + 256u;
        }
        loop_init_2 = false;
        uint _e7 = i_2;
        if (_e7 < (HEAD_OUTPUTS * vectors)) {
        } else {
            break;
        }
        {
            uint _e13 = layer.head_row;
            uint _e14 = i_2;
            uint _e19 = layer.row_vectors;
            uint _e22 = i_2;
            uint at_6 = (((_e13 + naga_div(_e14, vectors)) * _e19) + first_vector) + naga_mod(_e22, vectors);
            metal::float4 _e25 = largest_1;
            metal::float4 _e28 = activations[at_6];
            largest_1 = metal::max(_e25, metal::abs(_e28));
        }
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    float _e38 = largest_1.x;
    float _e40 = largest_1.y;
    float _e43 = largest_1.z;
    float _e45 = largest_1.w;
    sums.inner[thread_5].x = metal::max(metal::max(_e38, _e40), metal::max(_e43, _e45));
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    float _e53 = largest_of_sixteen(naga_div(thread_5, 16u) * 16u, 1u, sums);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    sums.inner[thread_5].x = _e53;
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    float _e59 = largest_of_sixteen(0u, 16u, sums);
    uint exponent = as_type<uint>(_e59) >> 23u;
    return as_type<float>(metal::clamp(258u - exponent, 3u, 227u) << 23u);
}

metal::float2 factor_scales(
    uint first_1,
    uint end,
    uint thread_6,
    constant NetworkLayer& layer,
    device type_6 const& activations,
    thread uint& first_column,
    threadgroup type_10& sums,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e5 = first_column;
    float _e9 = gradient_scale(naga_div(_e5, 4u), TILE_VECTORS, thread_6, layer, activations, sums, _buffer_sizes);
    return metal::float2(WEIGHT_SCALE, _e9);
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

metal::float4 multiply(
    uint first_2,
    uint end_1,
    uint thread_7,
    thread uint& first_input,
    constant NetworkLayer& layer,
    device type_6 const& parameters,
    device type_6& activations,
    thread uint& first_column,
    threadgroup type_9& left_high,
    threadgroup type_9& left_low,
    threadgroup type_9& right_high,
    threadgroup type_9& right_low,
    threadgroup type_10& sums,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::simdgroup_float16x16 c00_ = metal::simdgroup_float16x16 {};
    metal::simdgroup_float16x16 c01_ = metal::simdgroup_float16x16 {};
    metal::simdgroup_float16x16 c02_ = metal::simdgroup_float16x16 {};
    metal::simdgroup_float16x16 c03_ = metal::simdgroup_float16x16 {};
    metal::simdgroup_float16x16 c10_ = metal::simdgroup_float16x16 {};
    metal::simdgroup_float16x16 c11_ = metal::simdgroup_float16x16 {};
    metal::simdgroup_float16x16 c12_ = metal::simdgroup_float16x16 {};
    metal::simdgroup_float16x16 c13_ = metal::simdgroup_float16x16 {};
    metal::float4 loaded = metal::float4(0.0);
    Block next = {};
    uint step_1 = {};
    uint group_1 = naga_div(thread_7, 32u);
    uint row_4 = 32u * naga_mod(group_1, 4u);
    uint column_4 = 64u * naga_div(group_1, 4u);
    uint left_at = row_4 * SPLIT_STRIDE;
    uint right_at = column_4 * SPLIT_STRIDE;
    metal::float2 _e17 = factor_scales(first_2, end_1, thread_7, layer, activations, first_column, sums, _buffer_sizes);
    Block _e37 = load_step(first_2, thread_7, first_input, layer, parameters, activations, first_column, _buffer_sizes);
    next = _e37;
    step_1 = first_2;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e161 = step_1;
            step_1 = _e161 + 1u;
        }
        loop_init_3 = false;
        uint _e40 = step_1;
        if (_e40 < end_1) {
        } else {
            break;
        }
        {
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            Block _e42 = next;
            store_step(_e42, _e17, thread_7, left_high, left_low, right_high, right_low);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            metal::float4 _e43 = loaded;
            metal::float4 _e45 = next.k0_;
            metal::float4 _e47 = next.k1_;
            metal::float4 _e50 = next.k2_;
            metal::float4 _e52 = next.k3_;
            loaded = _e43 + ((_e45 + _e47) + (_e50 + _e52));
            uint _e56 = step_1;
            if ((_e56 + 1u) < end_1) {
                uint _e60 = step_1;
                Block _e63 = load_step(_e60 + 1u, thread_7, first_input, layer, parameters, activations, first_column, _buffer_sizes);
                next = _e63;
            }
            metal::simdgroup_half16x16 h0_ = NagaCooperativeLoad(&left_high.inner[left_at], SPLIT_STRIDE, false);
            metal::simdgroup_half16x16 l0_ = NagaCooperativeLoad(&left_low.inner[left_at], SPLIT_STRIDE, false);
            metal::simdgroup_half16x16 h1_ = NagaCooperativeLoad(&left_high.inner[left_at + TILE_OF_ROWS], SPLIT_STRIDE, false);
            metal::simdgroup_half16x16 l1_ = NagaCooperativeLoad(&left_low.inner[left_at + TILE_OF_ROWS], SPLIT_STRIDE, false);
            metal::simdgroup_half16x16 g0_ = NagaCooperativeLoad(&right_high.inner[right_at], SPLIT_STRIDE, true);
            metal::simdgroup_half16x16 m0_ = NagaCooperativeLoad(&right_low.inner[right_at], SPLIT_STRIDE, true);
            metal::simdgroup_float16x16 _e92 = c00_;
            c00_ = NagaCooperativeMultiplyAdd(h0_, g0_, NagaCooperativeMultiplyAdd(h0_, m0_, NagaCooperativeMultiplyAdd(l0_, g0_, _e92)));
            metal::simdgroup_float16x16 _e96 = c10_;
            c10_ = NagaCooperativeMultiplyAdd(h1_, g0_, NagaCooperativeMultiplyAdd(h1_, m0_, NagaCooperativeMultiplyAdd(l1_, g0_, _e96)));
            metal::simdgroup_half16x16 g1_ = NagaCooperativeLoad(&right_high.inner[right_at + TILE_OF_ROWS], SPLIT_STRIDE, true);
            metal::simdgroup_half16x16 m1_ = NagaCooperativeLoad(&right_low.inner[right_at + TILE_OF_ROWS], SPLIT_STRIDE, true);
            metal::simdgroup_float16x16 _e112 = c01_;
            c01_ = NagaCooperativeMultiplyAdd(h0_, g1_, NagaCooperativeMultiplyAdd(h0_, m1_, NagaCooperativeMultiplyAdd(l0_, g1_, _e112)));
            metal::simdgroup_float16x16 _e116 = c11_;
            c11_ = NagaCooperativeMultiplyAdd(h1_, g1_, NagaCooperativeMultiplyAdd(h1_, m1_, NagaCooperativeMultiplyAdd(l1_, g1_, _e116)));
            metal::simdgroup_half16x16 g2_ = NagaCooperativeLoad(&right_high.inner[right_at + 192u], SPLIT_STRIDE, true);
            metal::simdgroup_half16x16 m2_ = NagaCooperativeLoad(&right_low.inner[right_at + 192u], SPLIT_STRIDE, true);
            metal::simdgroup_float16x16 _e132 = c02_;
            c02_ = NagaCooperativeMultiplyAdd(h0_, g2_, NagaCooperativeMultiplyAdd(h0_, m2_, NagaCooperativeMultiplyAdd(l0_, g2_, _e132)));
            metal::simdgroup_float16x16 _e136 = c12_;
            c12_ = NagaCooperativeMultiplyAdd(h1_, g2_, NagaCooperativeMultiplyAdd(h1_, m2_, NagaCooperativeMultiplyAdd(l1_, g2_, _e136)));
            metal::simdgroup_half16x16 g3_ = NagaCooperativeLoad(&right_high.inner[right_at + 288u], SPLIT_STRIDE, true);
            metal::simdgroup_half16x16 m3_ = NagaCooperativeLoad(&right_low.inner[right_at + 288u], SPLIT_STRIDE, true);
            metal::simdgroup_float16x16 _e152 = c03_;
            c03_ = NagaCooperativeMultiplyAdd(h0_, g3_, NagaCooperativeMultiplyAdd(h0_, m3_, NagaCooperativeMultiplyAdd(l0_, g3_, _e152)));
            metal::simdgroup_float16x16 _e156 = c13_;
            c13_ = NagaCooperativeMultiplyAdd(h1_, g3_, NagaCooperativeMultiplyAdd(h1_, m3_, NagaCooperativeMultiplyAdd(l1_, g3_, _e156)));
        }
    }
    float unscale_1 = 1.0 / (_e17.x * _e17.y);
    uint at_7 = group_1 * SUMS;
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    metal::simdgroup_float16x16 _e170 = c00_;
    simdgroup_store(_e170, &sums.inner[at_7], 8u);
    metal::simdgroup_float16x16 _e174 = c01_;
    simdgroup_store(_e174, &sums.inner[at_7 + 4u], 8u);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    store_sums(row_4, column_4, unscale_1, thread_7, first_input, layer, activations, first_column, sums, _buffer_sizes);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    metal::simdgroup_float16x16 _e180 = c02_;
    simdgroup_store(_e180, &sums.inner[at_7], 8u);
    metal::simdgroup_float16x16 _e184 = c03_;
    simdgroup_store(_e184, &sums.inner[at_7 + 4u], 8u);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    store_sums(row_4, column_4 + 32u, unscale_1, thread_7, first_input, layer, activations, first_column, sums, _buffer_sizes);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    metal::simdgroup_float16x16 _e192 = c10_;
    simdgroup_store(_e192, &sums.inner[at_7], 8u);
    metal::simdgroup_float16x16 _e196 = c11_;
    simdgroup_store(_e196, &sums.inner[at_7 + 4u], 8u);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    store_sums(row_4 + 16u, column_4, unscale_1, thread_7, first_input, layer, activations, first_column, sums, _buffer_sizes);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    metal::simdgroup_float16x16 _e204 = c12_;
    simdgroup_store(_e204, &sums.inner[at_7], 8u);
    metal::simdgroup_float16x16 _e208 = c13_;
    simdgroup_store(_e208, &sums.inner[at_7 + 4u], 8u);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    store_sums(row_4 + 16u, column_4 + 32u, unscale_1, thread_7, first_input, layer, activations, first_column, sums, _buffer_sizes);
    metal::float4 _e218 = loaded;
    return _e218;
}

metal::float4 sum_of_rows(
    metal::float4 loaded_1,
    uint thread_8,
    threadgroup type_10& sums
) {
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    metal::uint2 _e2 = loaded_block(thread_8);
    if (thread_8 < 128u) {
        sums.inner[(4u * _e2.x) + _e2.y] = loaded_1;
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    uint first_3 = 4u * naga_mod(thread_8, TILE_VECTORS);
    metal::float4 _e18 = sums.inner[first_3];
    metal::float4 _e23 = sums.inner[first_3 + 1u];
    metal::float4 _e29 = sums.inner[first_3 + 2u];
    metal::float4 _e34 = sums.inner[first_3 + 3u];
    return (_e18 + _e23) + (_e29 + _e34);
}

metal::float4 limited_features(
    metal::float4 features
) {
    return metal::clamp(features, metal::float4(-1048064.0), metal::float4(1048064.0));
}

struct deform_layer_backwardInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void deform_layer_backward(
  metal::uint3 group [[threadgroup_position_in_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant NetworkLayer& layer [[user(fake0)]]
, device type_6 const& parameters [[user(fake0)]]
, device type_6& activations [[user(fake0)]]
, threadgroup type_9& left_high
, threadgroup type_9& left_low
, threadgroup type_9& right_high
, threadgroup type_9& right_low
, threadgroup type_10& sums
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint first_input = {};
    uint first_column = {};
    uint _e5 = layer.encoded_inputs;
    first_input = _e5 + (group.x * TILE);
    first_column = group.y * TILE;
    uint _e16 = layer.outputs;
    uint steps_1 = naga_div((_e16 + STEP) - 1u, STEP);
    metal::float4 _e24 = multiply(0u, steps_1, thread_, first_input, layer, parameters, activations, first_column, left_high, left_low, right_high, right_low, sums, _buffer_sizes);
    return;
}
