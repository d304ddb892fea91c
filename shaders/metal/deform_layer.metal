// Made from shaders/deform_layer.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size2;
    uint size3;
};

struct type_2 {
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
    type_2 time;
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
typedef metal::float4 type_5[1];
struct type_7 {
    metal::float4 inner[512];
};
struct Tile {
    metal::float4 a0_;
    metal::float4 b0_;
    metal::float4 a1_;
    metal::float4 b1_;
    metal::float4 a2_;
    metal::float4 b2_;
    metal::float4 a3_;
    metal::float4 b3_;
    metal::float4 a4_;
    metal::float4 b4_;
    metal::float4 a5_;
    metal::float4 b5_;
    metal::float4 a6_;
    metal::float4 b6_;
    metal::float4 a7_;
    metal::float4 b7_;
    metal::float4 loaded;
};
constant uint TILE = 128u;
constant uint TILE_VECTORS = 32u;
constant uint STEP = 16u;

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
    return metal::uint2(naga_mod(naga_div(t, 2u), 16u) + (16u * naga_div(t, 64u)), naga_mod(t, 2u) + (2u * naga_mod(naga_div(t, 32u), 2u)));
}

Block weight_block(
    uint output,
    uint input,
    constant NetworkLayer& layer,
    device type_5 const& parameters,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e4 = layer.inputs;
    uint stride = naga_div(_e4, 4u);
    uint _e9 = layer.weights;
    uint at = (_e9 + (output * stride)) + naga_div(input, 4u);
    metal::float4 _e17 = parameters[at];
    metal::float4 _e21 = parameters[at + stride];
    metal::float4 _e27 = parameters[at + (2u * stride)];
    metal::float4 _e33 = parameters[at + (3u * stride)];
    return Block {_e17, _e21, _e27, _e33};
}

Block load_left(
    uint input_1,
    uint row,
    thread uint& first_output,
    constant NetworkLayer& layer,
    device type_5 const& parameters,
    constant _mslBufferSizes& _buffer_sizes
) {
    bool local = {};
    uint _e3 = first_output;
    uint output_1 = _e3 + row;
    uint _e7 = layer.inputs;
    if (!((input_1 >= _e7))) {
        uint _e14 = layer.outputs;
        local = output_1 >= _e14;
    } else {
        local = true;
    }
    bool _e17 = local;
    if (_e17) {
        return Block {};
    }
    Block _e19 = weight_block(output_1, input_1, layer, parameters, _buffer_sizes);
    Block _e20 = transposed(_e19);
    return _e20;
}

Block activation_block(
    uint row_1,
    uint column,
    constant NetworkLayer& layer,
    device type_5 const& activations,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint stride_1 = layer.row_vectors;
    uint at_1 = (row_1 * stride_1) + naga_div(column, 4u);
    metal::float4 _e11 = activations[at_1];
    metal::float4 _e15 = activations[at_1 + stride_1];
    metal::float4 _e21 = activations[at_1 + (2u * stride_1)];
    metal::float4 _e27 = activations[at_1 + (3u * stride_1)];
    return Block {_e11, _e15, _e21, _e27};
}

Block load_right(
    uint input_2,
    uint column_1,
    constant NetworkLayer& layer,
    device type_5 const& activations,
    thread uint& first_column,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e4 = layer.inputs;
    if (input_2 >= _e4) {
        return Block {};
    }
    uint _e9 = layer.input_row;
    uint _e12 = first_column;
    Block _e14 = activation_block(_e9 + input_2, _e12 + column_1, layer, activations, _buffer_sizes);
    return _e14;
}

Block load_step(
    uint step,
    uint thread_2,
    thread uint& first_output,
    constant NetworkLayer& layer,
    device type_5 const& parameters,
    device type_5 const& activations,
    thread uint& first_column,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::uint2 _e2 = loaded_block(thread_2);
    uint contraction = (step * STEP) + (4u * _e2.y);
    if (thread_2 < 128u) {
        Block _e14 = load_left(contraction, 4u * _e2.x, first_output, layer, parameters, _buffer_sizes);
        return _e14;
    }
    Block _e18 = load_right(contraction, 4u * _e2.x, layer, activations, first_column, _buffer_sizes);
    return _e18;
}

void store_step(
    Block block,
    uint thread_3,
    threadgroup type_7& left,
    threadgroup type_7& right
) {
    metal::uint2 _e2 = loaded_block(thread_3);
    uint at_2 = ((4u * _e2.y) * TILE_VECTORS) + _e2.x;
    if (thread_3 < 128u) {
        left.inner[at_2] = block.k0_;
        left.inner[at_2 + TILE_VECTORS] = block.k1_;
        left.inner[at_2 + 64u] = block.k2_;
        left.inner[at_2 + 96u] = block.k3_;
        return;
    } else {
        right.inner[at_2] = block.k0_;
        right.inner[at_2 + TILE_VECTORS] = block.k1_;
        right.inner[at_2 + 64u] = block.k2_;
        right.inner[at_2 + 96u] = block.k3_;
        return;
    }
}

metal::uint2 tile_place(
    uint thread_4
) {
    return metal::uint2(naga_div(thread_4, 16u), naga_mod(thread_4, 16u));
}

void multiply_add(
    thread Tile& tile,
    metal::uint2 place,
    threadgroup type_7& left,
    threadgroup type_7& right
) {
    uint k = 0u;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e140 = k;
            k = _e140 + 1u;
        }
        loop_init = false;
        uint _e4 = k;
        if (_e4 < STEP) {
        } else {
            break;
        }
        {
            uint _e8 = k;
            metal::float4 l = left.inner[(_e8 * TILE_VECTORS) + place.x];
            uint _e16 = k;
            metal::float4 m = left.inner[((_e16 * TILE_VECTORS) + place.x) + 16u];
            uint _e26 = k;
            metal::float4 a = right.inner[(_e26 * TILE_VECTORS) + place.y];
            uint _e34 = k;
            metal::float4 b = right.inner[((_e34 * TILE_VECTORS) + place.y) + 16u];
            metal::float4 _e47 = tile.a0_;
            tile.a0_ = metal::fma(metal::float4(l.x), a, _e47);
            metal::float4 _e53 = tile.b0_;
            tile.b0_ = metal::fma(metal::float4(l.x), b, _e53);
            metal::float4 _e59 = tile.a1_;
            tile.a1_ = metal::fma(metal::float4(l.y), a, _e59);
            metal::float4 _e65 = tile.b1_;
            tile.b1_ = metal::fma(metal::float4(l.y), b, _e65);
            metal::float4 _e71 = tile.a2_;
            tile.a2_ = metal::fma(metal::float4(l.z), a, _e71);
            metal::float4 _e77 = tile.b2_;
            tile.b2_ = metal::fma(metal::float4(l.z), b, _e77);
            metal::float4 _e83 = tile.a3_;
            tile.a3_ = metal::fma(metal::float4(l.w), a, _e83);
            metal::float4 _e89 = tile.b3_;
            tile.b3_ = metal::fma(metal::float4(l.w), b, _e89);
            metal::float4 _e95 = tile.a4_;
            tile.a4_ = metal::fma(metal::float4(m.x), a, _e95);
            metal::float4 _e101 = tile.b4_;
            tile.b4_ = metal::fma(metal::float4(m.x), b, _e101);
            metal::float4 _e107 = tile.a5_;
            tile.a5_ = metal::fma(metal::float4(m.y), a, _e107);
            metal::float4 _e113 = tile.b5_;
            tile.b5_ = metal::fma(metal::float4(m.y), b, _e113);
            metal::float4 _e119 = tile.a6_;
            tile.a6_ = metal::fma(metal::float4(m.z), a, _e119);
            metal::float4 _e125 = tile.b6_;
            tile.b6_ = metal::fma(metal::float4(m.z), b, _e125);
            metal::float4 _e131 = tile.a7_;
            tile.a7_ = metal::fma(metal::float4(m.w), a, _e131);
            metal::float4 _e137 = tile.b7_;
            tile.b7_ = metal::fma(metal::float4(m.w), b, _e137);
        }
    }
    return;
}

Tile product(
    uint first,
    uint end,
    uint thread_5,
    thread uint& first_output,
    constant NetworkLayer& layer,
    device type_5 const& parameters,
    device type_5 const& activations,
    thread uint& first_column,
    threadgroup type_7& left,
    threadgroup type_7& right,
    constant _mslBufferSizes& _buffer_sizes
) {
    Tile tile_1 = Tile {};
    Block next = {};
    uint step_1 = {};
    metal::uint2 _e3 = tile_place(thread_5);
    Block _e6 = load_step(first, thread_5, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    next = _e6;
    step_1 = first;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e35 = step_1;
            step_1 = _e35 + 1u;
        }
        loop_init_1 = false;
        uint _e9 = step_1;
        if (_e9 < end) {
        } else {
            break;
        }
        {
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            Block _e11 = next;
            store_step(_e11, thread_5, left, right);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            metal::float4 _e13 = tile_1.loaded;
            metal::float4 _e15 = next.k0_;
            metal::float4 _e17 = next.k1_;
            metal::float4 _e20 = next.k2_;
            metal::float4 _e22 = next.k3_;
            tile_1.loaded = _e13 + ((_e15 + _e17) + (_e20 + _e22));
            uint _e26 = step_1;
            if ((_e26 + 1u) < end) {
                uint _e30 = step_1;
                Block _e33 = load_step(_e30 + 1u, thread_5, first_output, layer, parameters, activations, first_column, _buffer_sizes);
                next = _e33;
            }
            multiply_add(tile_1, _e3, left, right);
        }
    }
    Tile _e37 = tile_1;
    return _e37;
}

void store_row(
    uint row_2,
    uint column_2,
    metal::float4 value,
    thread uint& first_output,
    constant NetworkLayer& layer,
    device type_5 const& parameters,
    device type_5& activations,
    thread uint& first_column,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint _e4 = first_output;
    uint output_2 = _e4 + row_2;
    uint _e8 = layer.outputs;
    if (output_2 >= _e8) {
        return;
    }
    uint _e13 = layer.weights;
    uint _e16 = layer.outputs;
    uint _e19 = layer.inputs;
    float bias = parameters[_e13 + naga_div((_e16 * _e19) + output_2, 4u)][naga_mod(output_2, 4u)];
    uint _e32 = layer.output_row;
    uint _e36 = layer.row_vectors;
    uint _e39 = first_column;
    uint at_3 = ((_e32 + output_2) * _e36) + naga_div(_e39 + column_2, 4u);
    activations[at_3] = metal::max(value + metal::float4(bias), metal::float4(0.0));
    return;
}

void store_pair(
    uint row_3,
    uint column_vector,
    metal::float4 first_1,
    metal::float4 second,
    thread uint& first_output,
    constant NetworkLayer& layer,
    device type_5 const& parameters,
    device type_5& activations,
    thread uint& first_column,
    constant _mslBufferSizes& _buffer_sizes
) {
    store_row(row_3, 4u * column_vector, first_1, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    store_row(row_3, (4u * column_vector) + 64u, second, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    return;
}

void store_tile(
    Tile tile_2,
    uint thread_6,
    thread uint& first_output,
    constant NetworkLayer& layer,
    device type_5 const& parameters,
    device type_5& activations,
    thread uint& first_column,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::uint2 _e2 = tile_place(thread_6);
    store_pair(4u * _e2.x, _e2.y, tile_2.a0_, tile_2.b0_, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    store_pair((4u * _e2.x) + 1u, _e2.y, tile_2.a1_, tile_2.b1_, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    store_pair((4u * _e2.x) + 2u, _e2.y, tile_2.a2_, tile_2.b2_, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    store_pair((4u * _e2.x) + 3u, _e2.y, tile_2.a3_, tile_2.b3_, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    store_pair((4u * _e2.x) + 64u, _e2.y, tile_2.a4_, tile_2.b4_, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    store_pair((4u * _e2.x) + 65u, _e2.y, tile_2.a5_, tile_2.b5_, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    store_pair((4u * _e2.x) + 66u, _e2.y, tile_2.a6_, tile_2.b6_, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    store_pair((4u * _e2.x) + 67u, _e2.y, tile_2.a7_, tile_2.b7_, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    return;
}

metal::float4 multiply(
    uint first_2,
    uint end_1,
    uint thread_7,
    thread uint& first_output,
    constant NetworkLayer& layer,
    device type_5 const& parameters,
    device type_5& activations,
    thread uint& first_column,
    threadgroup type_7& left,
    threadgroup type_7& right,
    constant _mslBufferSizes& _buffer_sizes
) {
    Tile _e3 = product(first_2, end_1, thread_7, first_output, layer, parameters, activations, first_column, left, right, _buffer_sizes);
    store_tile(_e3, thread_7, first_output, layer, parameters, activations, first_column, _buffer_sizes);
    return _e3.loaded;
}

metal::float4 sum_of_rows(
    metal::float4 loaded,
    uint thread_8,
    threadgroup type_7& left
) {
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    metal::uint2 _e2 = loaded_block(thread_8);
    if (thread_8 < 128u) {
        left.inner[(4u * _e2.x) + _e2.y] = loaded;
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    uint first_3 = 4u * naga_mod(thread_8, TILE_VECTORS);
    metal::float4 _e18 = left.inner[first_3];
    metal::float4 _e23 = left.inner[first_3 + 1u];
    metal::float4 _e29 = left.inner[first_3 + 2u];
    metal::float4 _e34 = left.inner[first_3 + 3u];
    return (_e18 + _e23) + (_e29 + _e34);
}

struct deform_layerInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void deform_layer(
  metal::uint3 group [[threadgroup_position_in_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant NetworkLayer& layer [[user(fake0)]]
, device type_5 const& parameters [[user(fake0)]]
, device type_5& activations [[user(fake0)]]
, threadgroup type_7& left
, threadgroup type_7& right
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint first_output = {};
    uint first_column = {};
    first_output = group.x * TILE;
    first_column = group.y * TILE;
    uint _e12 = layer.inputs;
    uint steps_1 = naga_div((_e12 + STEP) - 1u, STEP);
    metal::float4 _e20 = multiply(0u, steps_1, thread_, first_output, layer, parameters, activations, first_column, left, right, _buffer_sizes);
    return;
}
