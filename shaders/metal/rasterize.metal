// Made from shaders/rasterize.wgsl by scripts/export-msl.

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
    uint size7;
};

struct Region {
    metal::uint2 first_tile;
    metal::uint2 tiles;
    metal::uint2 image;
    metal::uint2 output_origin;
    uint output_stride;
    uint capacity;
    uint sort_keys_per_thread;
    uint halts;
};
struct Place {
    float v1_;
    float power;
};
typedef uint type_7[1];
typedef metal::float4 type_8[1];
typedef metal::uint4 type_10[1];
struct type_11 {
    metal::float4 inner[256];
};
struct type_12 {
    uint inner[256];
};
struct type_14 {
    metal::atomic_uint inner[2];
};
struct Pixel {
    float transmittance;
    char _pad1[12];
    metal::packed_float3 color;
    float weight;
    float weighted_depth;
    uint median_depth;
    float top_weight;
    uint top;
    uint top_label;
    char _pad8[12];
};
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint TILE = 16u;
constant float LOG2_255_ = 7.9943533;
constant float ALPHA_MAX = 0.99;
constant float TRANSMITTANCE_MIN = 0.0001;
constant float MAX_IMAGE_ALPHA = 0.9999;
constant float MAX_FLOAT = 340282350000000000000000000000000000000.0;
constant uint NAN_BITS = 2143289344u;
constant uint NO_SPLAT = 4294967295u;
constant bool DEPTH = false;
constant bool TOP_CONTRIBUTOR = false;

uint flat_group(
    metal::uint3 group_1,
    metal::uint3 groups_1
) {
    return (group_1.y * groups_1.x) + group_1.x;
}

Place place_of(
    metal::float4 centre,
    float u22_,
    metal::float2 d
) {
    float v1_ = metal::fma(centre.z, d.x, centre.w * d.y);
    float v2_ = u22_ * d.y;
    return Place {v1_, metal::fma(v1_, v1_, v2_ * v2_)};
}

bool is_seen(
    float power,
    float log2_opacity
) {
    return power <= (log2_opacity + LOG2_255_);
}

float free_alpha(
    float power_1,
    float log2_opacity_1
) {
    return metal::exp2(log2_opacity_1 - power_1);
}

float transmittance_after(
    float before,
    float alpha
) {
    return metal::fma(-(alpha), before, before);
}

bool fills(
    float after
) {
    return !((after > TRANSMITTANCE_MIN));
}

void blend(
    thread Pixel& pixel,
    uint i_1,
    metal::float2 point,
    threadgroup type_11& batch_centres,
    threadgroup type_11& batch_extents,
    threadgroup type_11& batch_colors,
    threadgroup type_12& batch_splats
) {
    bool local_3 = {};
    metal::float4 centre_1 = batch_centres.inner[i_1];
    metal::float4 extent = batch_extents.inner[i_1];
    Place _e12 = place_of(centre_1, extent.x, point - centre_1.xy);
    float power_2 = _e12.power;
    bool _e15 = is_seen(power_2, extent.y);
    if (!(_e15)) {
        return;
    }
    float before_1 = pixel.transmittance;
    float _e20 = free_alpha(power_2, extent.y);
    float alpha_1 = metal::min(_e20, ALPHA_MAX);
    float full = alpha_1 * before_1;
    float _e24 = transmittance_after(before_1, alpha_1);
    bool _e25 = fills(_e24);
    if (_e25) {
        pixel.transmittance = 0.0;
        return;
    }
    metal::float4 color = batch_colors.inner[i_1];
    metal::float3 _e32 = pixel.color;
    pixel.color = _e32 + (full * color.xyz);
    float _e37 = pixel.weight;
    pixel.weight = _e37 + full;
    if (DEPTH) {
        float _e41 = pixel.weighted_depth;
        pixel.weighted_depth = _e41 + (full * extent.z);
        if (before_1 > 0.5) {
            local_3 = _e24 <= 0.5;
        } else {
            local_3 = false;
        }
        bool _e52 = local_3;
        if (_e52) {
            pixel.median_depth = as_type<uint>(extent.z);
        }
    }
    if (TOP_CONTRIBUTOR) {
        float _e58 = pixel.top_weight;
        if (full > _e58) {
            pixel.top_weight = full;
            uint _e64 = batch_splats.inner[i_1];
            pixel.top = _e64;
            pixel.top_label = as_type<uint>(color.w);
        }
    }
    pixel.transmittance = _e24;
    return;
}
uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}


struct rasterizeInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void rasterize(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Region& region [[user(fake0)]]
, device type_7 const& tile_starts [[user(fake0)]]
, device type_7 const& entry_splats [[user(fake0)]]
, device type_8 const& centres [[user(fake0)]]
, device type_8 const& extents [[user(fake0)]]
, device type_8 const& colors [[user(fake0)]]
, device type_8& image [[user(fake0)]]
, device type_10& layers [[user(fake0)]]
, threadgroup type_11& batch_centres
, threadgroup type_11& batch_extents
, threadgroup type_11& batch_colors
, threadgroup type_12& batch_splats
, threadgroup type_14& open_pixels
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    bool local = {};
    uint first = 0u;
    uint end = 0u;
    Pixel state = {};
    uint parity = 0u;
    uint batch = {};
    uint i = {};
    bool local_1 = {};
    bool local_2 = {};
    uint expected = NAN_BITS;
    uint _e3 = flat_group(group, groups);
    uint _e7 = region.tiles.x;
    uint _e11 = region.tiles.y;
    bool inside_region = _e3 < (_e7 * _e11);
    uint _e17 = region.first_tile.x;
    uint _e21 = region.tiles.x;
    uint column = _e17 + naga_mod(_e3, _e21);
    uint _e27 = region.first_tile.y;
    uint _e31 = region.tiles.x;
    uint row = _e27 + naga_div(_e3, _e31);
    metal::uint2 pixel_1 = (metal::uint2(column, row) * TILE) + metal::uint2(naga_mod(thread_, TILE), naga_div(thread_, TILE));
    if (inside_region) {
        metal::uint2 _e47 = region.image;
        local = metal::all(pixel_1 < _e47);
    } else {
        local = false;
    }
    bool inside = local;
    metal::float2 point_1 = static_cast<metal::float2>(pixel_1) + metal::float2(0.5);
    if (inside_region) {
        uint _e62 = tile_starts[_e3];
        first = _e62;
        uint _e67 = tile_starts[_e3 + 1u];
        end = _e67;
    }
    state = Pixel {inside ? 1.0 : 0.0, {}, metal::float3(0.0), 0.0, 0.0, NAN_BITS, 0.0, NO_SPLAT, 0u};
    if (thread_ < 2u) {
        metal::atomic_store_explicit(&open_pixels.inner[thread_], 0u, metal::memory_order_relaxed);
    }
    uint _e88 = first;
    batch = _e88;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e183 = batch;
            batch = _e183 + 256u;
        }
        loop_init = false;
        uint _e90 = batch;
        uint _e91 = end;
        if (_e90 < _e91) {
        } else {
            break;
        }
        {
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e93 = batch;
            uint entry = _e93 + thread_;
            uint _e95 = end;
            if (entry < _e95) {
                uint splat = entry_splats[entry];
                metal::float4 _e104 = centres[splat];
                batch_centres.inner[thread_] = _e104;
                metal::float4 _e109 = extents[splat];
                batch_extents.inner[thread_] = _e109;
                metal::float4 _e114 = colors[splat];
                batch_colors.inner[thread_] = _e114;
                if (TOP_CONTRIBUTOR) {
                    batch_splats.inner[thread_] = splat;
                }
            } else {
                batch_centres.inner[thread_] = metal::float4(0.0);
                batch_extents.inner[thread_] = metal::float4(0.0, -1000.0, 0.0, 0.0);
            }
            float _e130 = state.transmittance;
            if (_e130 > 0.0) {
                uint _e134 = parity;
                uint _e137 = metal::atomic_fetch_or_explicit(&open_pixels.inner[_e134], 1u, metal::memory_order_relaxed);
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e139 = parity;
            uint _e141 = metal::atomic_load_explicit(&open_pixels.inner[_e139], metal::memory_order_relaxed);
            if (_e141 == 0u) {
                break;
            }
            uint _e145 = parity;
            parity = 1u - _e145;
            if (thread_ == 0u) {
                uint _e150 = parity;
                metal::atomic_store_explicit(&open_pixels.inner[_e150], 0u, metal::memory_order_relaxed);
            }
            uint _e154 = end;
            uint _e155 = batch;
            uint size = metal::min(256u, _e154 - _e155);
            i = 0u;
            bool loop_init_1 = true;
            while(true) {
                if (!loop_init_1) {
                    uint _e180 = i;
                    i = _e180 + 4u;
                }
                loop_init_1 = false;
                uint _e160 = i;
                if (_e160 < size) {
                    float _e165 = state.transmittance;
                    local_1 = _e165 > 0.0;
                } else {
                    local_1 = false;
                }
                bool _e169 = local_1;
                if (_e169) {
                } else {
                    break;
                }
                {
                    uint _e170 = i;
                    blend(state, _e170, point_1, batch_centres, batch_extents, batch_colors, batch_splats);
                    uint _e171 = i;
                    blend(state, _e171 + 1u, point_1, batch_centres, batch_extents, batch_colors, batch_splats);
                    uint _e174 = i;
                    blend(state, _e174 + 2u, point_1, batch_centres, batch_extents, batch_colors, batch_splats);
                    uint _e177 = i;
                    blend(state, _e177 + 3u, point_1, batch_centres, batch_extents, batch_colors, batch_splats);
                }
            }
        }
    }
    if (inside) {
        metal::uint2 _e188 = region.output_origin;
        metal::uint2 at = pixel_1 - _e188;
        uint _e193 = region.output_stride;
        uint index = (at.y * _e193) + at.x;
        metal::float3 _e200 = state.color;
        float _e202 = state.weight;
        image[index] = metal::float4(_e200, metal::min(_e202, MAX_IMAGE_ALPHA));
        if (true) {
            local_2 = TOP_CONTRIBUTOR;
        } else {
            local_2 = true;
        }
        bool _e213 = local_2;
        if (_e213) {
            float _e217 = state.weight;
            if (_e217 > 0.0) {
                float _e221 = state.weighted_depth;
                float _e223 = state.weight;
                expected = as_type<uint>(metal::min(_e221 / _e223, MAX_FLOAT));
            }
            uint _e230 = expected;
            uint _e232 = state.median_depth;
            uint _e234 = state.top;
            uint _e236 = state.top_label;
            layers[index] = metal::uint4(_e230, _e232, _e234, _e236);
            return;
        } else {
            return;
        }
    } else {
        return;
    }
}
