// Made from shaders/rasterize_backward.wgsl by scripts/export-msl.

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
    uint size8;
    uint size9;
    uint size10;
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
typedef metal::float2 type_9[1];
typedef float type_10[1];
struct type_11 {
    metal::float4 inner[64];
};
struct type_12 {
    uint inner[64];
};
struct type_13 {
    float inner[1856];
};
struct type_14 {
    float inner[680];
};
struct type_16 {
    metal::atomic_uint inner[2];
};
struct Pixels {
    metal::float4 transmittance;
    metal::float4 behind;
    metal::float4 by_red;
    metal::float4 by_green;
    metal::float4 by_blue;
    metal::float4 by_weight;
    metal::float4 by_weighted_depth;
};
struct Pixel {
    float transmittance;
    float behind;
    char _pad2[8];
    metal::float4 by;
    float by_weighted_depth;
    char _pad4[12];
};
struct Terms {
    metal::float3 color;
    metal::float3 q;
    metal::packed_float3 q_v;
    float depth;
};
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint TILE = 16u;
constant float LOG2_255_ = 7.9943533;
constant float ALPHA_MAX = 0.99;
constant float TRANSMITTANCE_MIN = 0.0001;
constant uint THREADS = 64u;
constant uint BATCH = 64u;
constant uint ROUND = 4u;
constant uint PARTS = 7u;
constant uint PART_STRIDE = 464u;
constant uint ADDERS = 16u;
constant uint TERM_STRIDE = 17u;
constant bool DEPTH = false;

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

uint sum_count(
) {
    return 9u;
}

Pixel load_pixel(
    metal::uint2 pixel,
    bool inside_region,
    constant Region& region,
    device type_8 const& image,
    device type_8 const& by_image,
    device type_9 const& by_depth_sums,
    constant _mslBufferSizes& _buffer_sizes
) {
    bool local = {};
    metal::float4 by = {};
    float by_weighted_depth = 0.0;
    if (!(!(inside_region))) {
        metal::uint2 _e8 = region.image;
        local = metal::any(pixel >= _e8);
    } else {
        local = true;
    }
    bool _e12 = local;
    if (_e12) {
        return Pixel {0.0, 0.0, {}, metal::float4(0.0), 0.0};
    }
    metal::uint2 _e21 = region.output_origin;
    metal::uint2 at = pixel - _e21;
    uint _e26 = region.output_stride;
    uint index = (at.y * _e26) + at.x;
    metal::float4 _e32 = by_image[index];
    by = _e32;
    metal::float4 _e34 = by;
    metal::float4 _e37 = image[index];
    float behind = metal::dot(_e34, _e37);
    if (DEPTH) {
        metal::float2 by_sums = by_depth_sums[index];
        by_weighted_depth = by_sums.x;
        float _e47 = by.w;
        by.w = _e47 + by_sums.y;
    }
    metal::float4 _e50 = by;
    float _e51 = by_weighted_depth;
    return Pixel {1.0, behind, {}, _e50, _e51};
}

Pixels load_pixels(
    metal::uint2 first_1,
    bool inside_region_1,
    constant Region& region,
    device type_8 const& image,
    device type_8 const& by_image,
    device type_9 const& by_depth_sums,
    constant _mslBufferSizes& _buffer_sizes
) {
    Pixel _e2 = load_pixel(first_1, inside_region_1, region, image, by_image, by_depth_sums, _buffer_sizes);
    Pixel _e7 = load_pixel(first_1 + metal::uint2(1u, 0u), inside_region_1, region, image, by_image, by_depth_sums, _buffer_sizes);
    Pixel _e12 = load_pixel(first_1 + metal::uint2(2u, 0u), inside_region_1, region, image, by_image, by_depth_sums, _buffer_sizes);
    Pixel _e17 = load_pixel(first_1 + metal::uint2(3u, 0u), inside_region_1, region, image, by_image, by_depth_sums, _buffer_sizes);
    return Pixels {metal::float4(_e2.transmittance, _e7.transmittance, _e12.transmittance, _e17.transmittance), metal::float4(_e2.behind, _e7.behind, _e12.behind, _e17.behind), metal::float4(_e2.by.x, _e7.by.x, _e12.by.x, _e17.by.x), metal::float4(_e2.by.y, _e7.by.y, _e12.by.y, _e17.by.y), metal::float4(_e2.by.z, _e7.by.z, _e12.by.z, _e17.by.z), metal::float4(_e2.by.w, _e7.by.w, _e12.by.w, _e17.by.w), metal::float4(_e2.by_weighted_depth, _e7.by_weighted_depth, _e12.by_weighted_depth, _e17.by_weighted_depth)};
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

void blend_backward(
    thread Pixels& pixels_1,
    uint i_1,
    metal::float4 x,
    float y,
    uint thread_1,
    threadgroup type_11& batch_centres,
    threadgroup type_11& batch_extents,
    threadgroup type_11& batch_colors,
    threadgroup type_13& parts
) {
    metal::float4 value = {};
    metal::float4 centre_1 = batch_centres.inner[i_1];
    metal::float4 extent = batch_extents.inner[i_1];
    uint part_1 = (naga_mod(i_1, ROUND) * PART_STRIDE) + thread_1;
    metal::float4 dx = x - metal::float4(centre_1.x);
    float dy_1 = y - centre_1.y;
    Place _e24 = place_of(centre_1, extent.x, metal::float2(dx.x, dy_1));
    Place _e28 = place_of(centre_1, extent.x, metal::float2(dx.y, dy_1));
    Place _e32 = place_of(centre_1, extent.x, metal::float2(dx.z, dy_1));
    Place _e36 = place_of(centre_1, extent.x, metal::float2(dx.w, dy_1));
    metal::float4 before_1 = pixels_1.transmittance;
    bool _e41 = is_seen(_e24.power, extent.y);
    bool _e44 = is_seen(_e28.power, extent.y);
    bool _e47 = is_seen(_e32.power, extent.y);
    bool _e50 = is_seen(_e36.power, extent.y);
    metal::bool4 seen = metal::bool4(_e41, _e44, _e47, _e50) & (before_1 > metal::float4(0.0));
    if (!(metal::any(seen))) {
        parts.inner[part_1] = 0.0;
        parts.inner[part_1 + THREADS] = 0.0;
        parts.inner[part_1 + 128u] = 0.0;
        parts.inner[part_1 + 192u] = 0.0;
        parts.inner[part_1 + 256u] = 0.0;
        parts.inner[part_1 + 320u] = 0.0;
        if (DEPTH) {
            parts.inner[part_1 + 384u] = 0.0;
        }
        return;
    }
    metal::float4 zero = metal::float4(0.0);
    float _e96 = free_alpha(_e24.power, extent.y);
    float _e99 = free_alpha(_e28.power, extent.y);
    float _e102 = free_alpha(_e32.power, extent.y);
    float _e105 = free_alpha(_e36.power, extent.y);
    metal::float4 free = metal::float4(_e96, _e99, _e102, _e105);
    metal::float4 alpha_1 = metal::select(zero, metal::min(free, metal::float4(0.99)), seen);
    float _e113 = transmittance_after(before_1.x, alpha_1.x);
    float _e116 = transmittance_after(before_1.y, alpha_1.y);
    float _e119 = transmittance_after(before_1.z, alpha_1.z);
    float _e122 = transmittance_after(before_1.w, alpha_1.w);
    metal::float4 after_1 = metal::float4(_e113, _e116, _e119, _e122);
    bool _e125 = fills(after_1.x);
    bool _e127 = fills(after_1.y);
    bool _e129 = fills(after_1.z);
    bool _e131 = fills(after_1.w);
    metal::bool4 stays_open = !(metal::bool4(_e125, _e127, _e129, _e131));
    metal::float4 weight = metal::select(zero, alpha_1 * before_1, stays_open);
    pixels_1.transmittance = metal::select(zero, after_1, stays_open);
    metal::float4 color = batch_colors.inner[i_1];
    metal::float4 _e142 = pixels_1.by_weight;
    metal::float4 _e144 = pixels_1.by_red;
    value = _e142 + (_e144 * color.x);
    metal::float4 _e149 = value;
    metal::float4 _e151 = pixels_1.by_green;
    value = _e149 + (_e151 * color.y);
    metal::float4 _e155 = value;
    metal::float4 _e157 = pixels_1.by_blue;
    value = _e155 + (_e157 * color.z);
    if (DEPTH) {
        metal::float4 _e162 = value;
        metal::float4 _e164 = pixels_1.by_weighted_depth;
        value = _e162 + (_e164 * extent.z);
    }
    metal::float4 _e169 = pixels_1.behind;
    metal::float4 _e170 = value;
    metal::float4 behind_1 = _e169 - (weight * _e170);
    pixels_1.behind = behind_1;
    metal::bool4 counts = (seen & stays_open) & (free < metal::float4(0.99));
    metal::float4 left = metal::select(metal::float4(1.0), after_1, counts);
    metal::float4 _e182 = value;
    metal::float4 q = metal::select(zero, weight * (_e182 - (behind_1 / left)), counts);
    metal::float4 v1_1 = metal::float4(_e24.v1_, _e28.v1_, _e32.v1_, _e36.v1_);
    metal::float4 q_v = q * v1_1;
    metal::float4 one = metal::float4(1.0);
    metal::float4 _e198 = pixels_1.by_red;
    parts.inner[part_1] = metal::dot(weight, _e198);
    metal::float4 _e205 = pixels_1.by_green;
    parts.inner[part_1 + THREADS] = metal::dot(weight, _e205);
    metal::float4 _e212 = pixels_1.by_blue;
    parts.inner[part_1 + 128u] = metal::dot(weight, _e212);
    parts.inner[part_1 + 192u] = metal::dot(q, one);
    parts.inner[part_1 + 256u] = metal::dot(q_v, one);
    parts.inner[part_1 + 320u] = metal::dot(q_v, v1_1);
    if (DEPTH) {
        metal::float4 _e235 = pixels_1.by_weighted_depth;
        parts.inner[part_1 + 384u] = metal::dot(weight, _e235);
        return;
    } else {
        return;
    }
}

void add_part(
    thread Terms& sum,
    uint part,
    float dy,
    threadgroup type_13& parts
) {
    float q_1 = parts.inner[part + 192u];
    float q_v_1 = parts.inner[part + 256u];
    metal::float3 _e14 = sum.color;
    float _e17 = parts.inner[part];
    float _e22 = parts.inner[part + THREADS];
    float _e27 = parts.inner[part + 128u];
    sum.color = _e14 + metal::float3(_e17, _e22, _e27);
    metal::float3 _e31 = sum.q;
    sum.q = _e31 + metal::float3(q_1, q_1 * dy, (q_1 * dy) * dy);
    metal::float3 _e38 = sum.q_v;
    float _e44 = parts.inner[part + 320u];
    sum.q_v = _e38 + metal::float3(q_v_1, q_v_1 * dy, _e44);
    if (DEPTH) {
        float _e49 = sum.depth;
        float _e54 = parts.inner[part + 384u];
        sum.depth = _e49 + _e54;
        return;
    } else {
        return;
    }
}

float four_terms(
    uint first_2,
    threadgroup type_14& terms
) {
    float _e3 = terms.inner[first_2];
    float _e8 = terms.inner[first_2 + 1u];
    float _e14 = terms.inner[first_2 + 2u];
    float _e19 = terms.inner[first_2 + 3u];
    return (_e3 + _e8) + (_e14 + _e19);
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

void store_sums(
    uint first_splat,
    uint entries,
    float first_row,
    uint thread_2,
    device type_10& slots,
    threadgroup type_11& batch_centres,
    threadgroup type_12& batch_slots,
    threadgroup type_13& parts,
    threadgroup type_14& terms,
    constant _mslBufferSizes& _buffer_sizes
) {
    Terms sum_1 = Terms {metal::float3(0.0), metal::float3(0.0), metal::float3(0.0), 0.0};
    bool local_1 = {};
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    {
        uint splat = naga_div(thread_2, ADDERS);
        uint adder = naga_mod(thread_2, ADDERS);
        float _e16 = batch_centres.inner[first_splat + splat].y;
        float dy_2 = (first_row + static_cast<float>(naga_div(adder, 4u))) - _e16;
        uint part_2 = (splat * PART_STRIDE) + adder;
        add_part(sum_1, part_2, dy_2, parts);
        add_part(sum_1, part_2 + ADDERS, dy_2 + 4.0, parts);
        add_part(sum_1, part_2 + 32u, dy_2 + 8.0, parts);
        add_part(sum_1, part_2 + 48u, dy_2 + 12.0, parts);
        uint _e42 = sum_count();
        uint term = ((splat * _e42) * TERM_STRIDE) + adder;
        float _e51 = sum_1.color.x;
        terms.inner[term] = _e51;
        float _e58 = sum_1.color.y;
        terms.inner[term + TERM_STRIDE] = _e58;
        float _e65 = sum_1.color.z;
        terms.inner[term + 34u] = _e65;
        float _e72 = sum_1.q.x;
        terms.inner[term + 51u] = _e72;
        float _e79 = sum_1.q.y;
        terms.inner[term + 68u] = _e79;
        float _e86 = sum_1.q.z;
        terms.inner[term + 85u] = _e86;
        float _e93 = sum_1.q_v[0];
        terms.inner[term + 102u] = _e93;
        float _e100 = sum_1.q_v[1];
        terms.inner[term + 119u] = _e100;
        float _e107 = sum_1.q_v[2];
        terms.inner[term + 136u] = _e107;
        if (DEPTH) {
            float _e114 = sum_1.depth;
            terms.inner[term + 153u] = _e114;
        }
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    uint _e115 = sum_count();
    uint splat_1 = first_splat + naga_div(thread_2, _e115);
    uint _e119 = sum_count();
    if (thread_2 < (ROUND * _e119)) {
        local_1 = splat_1 < entries;
    } else {
        local_1 = false;
    }
    bool _e126 = local_1;
    if (_e126) {
        uint term_1 = thread_2 * TERM_STRIDE;
        float _e129 = four_terms(term_1, terms);
        float _e132 = four_terms(term_1 + 4u, terms);
        float _e136 = four_terms(term_1 + 8u, terms);
        float _e139 = four_terms(term_1 + 12u, terms);
        float sum_2 = (_e129 + _e132) + (_e136 + _e139);
        uint _e145 = batch_slots.inner[splat_1];
        uint _e146 = sum_count();
        uint _e148 = sum_count();
        slots[(_e145 * _e146) + naga_mod(thread_2, _e148)] = sum_2;
        return;
    } else {
        return;
    }
}

void clear_slots(
    uint first_3,
    uint end_1,
    uint thread_3,
    device type_7 const& entry_slots,
    device type_10& slots,
    constant _mslBufferSizes& _buffer_sizes
) {
    uint entry = {};
    entry = first_3 + thread_3;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e62 = entry;
            entry = _e62 + THREADS;
        }
        loop_init = false;
        uint _e5 = entry;
        if (_e5 < end_1) {
        } else {
            break;
        }
        {
            uint _e8 = entry;
            uint _e10 = entry_slots[_e8];
            uint _e11 = sum_count();
            uint slot = _e10 * _e11;
            slots[slot] = 0.0;
            slots[slot + 1u] = 0.0;
            slots[slot + 2u] = 0.0;
            slots[slot + 3u] = 0.0;
            slots[slot + 4u] = 0.0;
            slots[slot + 5u] = 0.0;
            slots[slot + 6u] = 0.0;
            slots[slot + 7u] = 0.0;
            slots[slot + 8u] = 0.0;
            if (DEPTH) {
                slots[slot + 9u] = 0.0;
            }
        }
    }
    return;
}

struct rasterize_backwardInput {
};
[[max_total_threads_per_threadgroup(64)]] kernel void rasterize_backward(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant Region& region [[user(fake0)]]
, device type_7 const& tile_starts [[user(fake0)]]
, device type_7 const& entry_splats [[user(fake0)]]
, device type_7 const& entry_slots [[user(fake0)]]
, device type_8 const& centres [[user(fake0)]]
, device type_8 const& extents [[user(fake0)]]
, device type_8 const& colors [[user(fake0)]]
, device type_8 const& image [[user(fake0)]]
, device type_8 const& by_image [[user(fake0)]]
, device type_9 const& by_depth_sums [[user(fake0)]]
, device type_10& slots [[user(fake0)]]
, threadgroup type_11& batch_centres
, threadgroup type_11& batch_extents
, threadgroup type_11& batch_colors
, threadgroup type_12& batch_slots
, threadgroup type_13& parts
, threadgroup type_14& terms
, threadgroup type_16& open_pixels
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint first = 0u;
    uint end = 0u;
    Pixels pixels = {};
    uint parity = 0u;
    uint batch = {};
    uint i = {};
    uint _e3 = flat_group(group, groups);
    uint _e7 = region.tiles.x;
    uint _e11 = region.tiles.y;
    bool inside_region_2 = _e3 < (_e7 * _e11);
    uint _e17 = region.first_tile.x;
    uint _e21 = region.tiles.x;
    uint column = _e17 + naga_mod(_e3, _e21);
    uint _e27 = region.first_tile.y;
    uint _e31 = region.tiles.x;
    uint row = _e27 + naga_div(_e3, _e31);
    metal::uint2 corner = metal::uint2(column, row) * TILE;
    metal::uint2 first_pixel = corner + metal::uint2(naga_mod(thread_, 4u) * 4u, naga_div(thread_, 4u));
    metal::float4 x_1 = metal::float4(static_cast<float>(first_pixel.x)) + metal::float4(0.5, 1.5, 2.5, 3.5);
    float y_1 = static_cast<float>(first_pixel.y) + 0.5;
    float first_row_1 = static_cast<float>(corner.y) + 0.5;
    if (inside_region_2) {
        uint _e68 = tile_starts[_e3];
        first = _e68;
        uint _e73 = tile_starts[_e3 + 1u];
        end = _e73;
    }
    Pixels _e74 = load_pixels(first_pixel, inside_region_2, region, image, by_image, by_depth_sums, _buffer_sizes);
    pixels = _e74;
    if (thread_ < 2u) {
        metal::atomic_store_explicit(&open_pixels.inner[thread_], 0u, metal::memory_order_relaxed);
    }
    uint _e83 = first;
    batch = _e83;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e175 = batch;
            batch = _e175 + BATCH;
        }
        loop_init_1 = false;
        uint _e85 = batch;
        uint _e86 = end;
        if (_e85 < _e86) {
        } else {
            break;
        }
        {
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e88 = batch;
            uint entry_1 = _e88 + thread_;
            uint _e90 = end;
            if (entry_1 < _e90) {
                uint splat_2 = entry_splats[entry_1];
                uint _e99 = entry_slots[entry_1];
                batch_slots.inner[thread_] = _e99;
                metal::float4 _e104 = centres[splat_2];
                batch_centres.inner[thread_] = _e104;
                metal::float4 _e109 = extents[splat_2];
                batch_extents.inner[thread_] = _e109;
                metal::float4 _e114 = colors[splat_2];
                batch_colors.inner[thread_] = _e114;
            } else {
                batch_centres.inner[thread_] = metal::float4(0.0);
                batch_extents.inner[thread_] = metal::float4(0.0, -1000.0, 0.0, 0.0);
            }
            metal::float4 _e127 = pixels.transmittance;
            if (metal::any(_e127 > metal::float4(0.0))) {
                uint _e133 = parity;
                uint _e136 = metal::atomic_fetch_or_explicit(&open_pixels.inner[_e133], 1u, metal::memory_order_relaxed);
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e138 = parity;
            uint _e140 = metal::atomic_load_explicit(&open_pixels.inner[_e138], metal::memory_order_relaxed);
            if (_e140 == 0u) {
                break;
            }
            uint _e144 = parity;
            parity = 1u - _e144;
            if (thread_ == 0u) {
                uint _e149 = parity;
                metal::atomic_store_explicit(&open_pixels.inner[_e149], 0u, metal::memory_order_relaxed);
            }
            uint _e153 = end;
            uint _e154 = batch;
            uint entries_1 = metal::min(BATCH, _e153 - _e154);
            i = 0u;
            bool loop_init_2 = true;
            while(true) {
                if (!loop_init_2) {
                    uint _e172 = i;
                    i = _e172 + ROUND;
                }
                loop_init_2 = false;
                uint _e159 = i;
                if (_e159 < entries_1) {
                } else {
                    break;
                }
                {
                    uint _e161 = i;
                    blend_backward(pixels, _e161, x_1, y_1, thread_, batch_centres, batch_extents, batch_colors, parts);
                    uint _e162 = i;
                    blend_backward(pixels, _e162 + 1u, x_1, y_1, thread_, batch_centres, batch_extents, batch_colors, parts);
                    uint _e165 = i;
                    blend_backward(pixels, _e165 + 2u, x_1, y_1, thread_, batch_centres, batch_extents, batch_colors, parts);
                    uint _e168 = i;
                    blend_backward(pixels, _e168 + 3u, x_1, y_1, thread_, batch_centres, batch_extents, batch_colors, parts);
                    uint _e171 = i;
                    store_sums(_e171, entries_1, first_row_1, thread_, slots, batch_centres, batch_slots, parts, terms, _buffer_sizes);
                }
            }
        }
    }
    uint _e178 = batch;
    uint _e179 = end;
    clear_slots(_e178, _e179, thread_, entry_slots, slots, _buffer_sizes);
    return;
}
