// Made from shaders/bin_numbered.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size1;
    uint size2;
    uint size3;
    uint size5;
    uint size6;
    uint size7;
    uint size8;
    uint size9;
};

struct type_2 {
    uint inner[256];
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
typedef uint type_4[1];
typedef metal::float4 type_7[1];
struct type_8 {
    metal::float4 inner[64];
};
struct type_9 {
    uint inner[64];
};
struct TileRun {
    uint first;
    uint count;
};
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint VISIBLE = 0u;
constant uint ENTRIES = 1u;
constant uint SORTED_ENTRIES = 2u;
constant uint DYNAMIC = 3u;
constant uint MOST_ENTRIES = 4u;
constant uint HALTED = 5u;
constant uint DRAWN_FRAMES = 6u;
constant uint SCAN_WIDTH = 256u;
constant uint TILE = 16u;
constant uint SPLATS_PER_GROUP = 64u;
constant float LOG2_255_ = 7.9943533;
constant float SLACK = 0.01;

uint flat_group(
    metal::uint3 group,
    metal::uint3 groups_2
) {
    return (group.y * groups_2.x) + group.x;
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

metal::uint3 folded(
    uint count_1
) {
    uint rows = naga_div((count_1 + MAX_GROUPS_PER_ROW) - 1u, MAX_GROUPS_PER_ROW);
    return metal::uint3(metal::min(count_1, MAX_GROUPS_PER_ROW), metal::max(rows, 1u), 1u);
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

uint saturating_add(
    uint a_1,
    uint b_1
) {
    uint sum_1 = a_1 + b_1;
    return (sum_1 < a_1) ? 4294967295u : sum_1;
}

uint inclusive_scan(
    uint thread_2,
    uint value,
    threadgroup type_2& scan_values
) {
    uint sum = {};
    uint distance = 1u;
    uint left = {};
    sum = value;
    uint _e5 = sum;
    scan_values.inner[thread_2] = _e5;
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e26 = distance;
            distance = _e26 * 2u;
        }
        loop_init = false;
        uint _e8 = distance;
        if (_e8 < SCAN_WIDTH) {
        } else {
            break;
        }
        {
            left = 0u;
            uint _e13 = distance;
            if (thread_2 >= _e13) {
                uint _e16 = distance;
                uint _e19 = scan_values.inner[thread_2 - _e16];
                left = _e19;
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e20 = sum;
            uint _e21 = left;
            uint _e22 = saturating_add(_e20, _e21);
            sum = _e22;
            uint _e25 = sum;
            scan_values.inner[thread_2] = _e25;
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
        }
    }
    uint _e29 = sum;
    return _e29;
}

void scan_barrier(
) {
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    return;
}

void write_entry(
    uint index,
    uint tile,
    uint splat,
    device type_4& entry_tiles,
    device type_4& entry_slots,
    device type_4& slot_splats,
    constant _mslBufferSizes& _buffer_sizes
) {
    entry_tiles[index] = tile;
    entry_slots[index] = index;
    slot_splats[index] = splat;
    return;
}

uint naga_f2u32(float value) {
    return static_cast<uint>(metal::clamp(value, 0.0, 4294967000.0));
}

metal::uint2 bands_of(
    float y,
    float half_height,
    constant Region& region
) {
    float first = metal::floor(metal::floor((y - half_height) - 0.5) / 16.0);
    float last = metal::floor(metal::ceil((y + half_height) - 0.5) / 16.0);
    uint _e18 = region.first_tile.y;
    float low = static_cast<float>(_e18);
    uint _e23 = region.first_tile.y;
    uint _e27 = region.tiles.y;
    float high = static_cast<float>(_e23 + _e27);
    float from_band = metal::clamp(first, low, high);
    float to_band = metal::clamp(last + 1.0, from_band, high);
    return metal::uint2(naga_f2u32(from_band), naga_f2u32(to_band));
}

void load_group(
    uint group_1,
    uint thread_3,
    threadgroup type_2& scan_values,
    constant Region& region,
    device type_4 const& order,
    device type_7 const& centres,
    device type_7 const& extents,
    device type_4 const& counts,
    threadgroup type_8& group_centres,
    threadgroup type_8& group_extents,
    threadgroup type_9& group_splats,
    threadgroup type_9& first_bands,
    threadgroup type_9& band_sums,
    threadgroup uint& all_bands,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::uint2 bands = metal::uint2(0u);
    if (thread_3 < SPLATS_PER_GROUP) {
        uint rank = (group_1 * SPLATS_PER_GROUP) + thread_3;
        uint _e12 = counts[0];
        if (rank < _e12) {
            uint splat_3 = order[rank];
            metal::float4 extent_1 = extents[splat_3];
            metal::float4 centre_1 = centres[splat_3];
            group_splats.inner[thread_3] = splat_3;
            group_centres.inner[thread_3] = centre_1;
            group_extents.inner[thread_3] = metal::float4(extent_1.xy, extent_1.w, 0.0);
            metal::uint2 _e35 = bands_of(centre_1.y, extent_1.w, region);
            bands = _e35;
            uint _e39 = bands.x;
            first_bands.inner[thread_3] = _e39;
        }
    }
    uint _e41 = bands.y;
    uint _e43 = bands.x;
    uint _e45 = inclusive_scan(thread_3, _e41 - _e43, scan_values);
    if (thread_3 < SPLATS_PER_GROUP) {
        band_sums.inner[thread_3] = _e45;
    }
    if (thread_3 == 0u) {
        uint _e55 = scan_values.inner[255];
        all_bands = _e55;
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    return;
}

uint splat_of_band(
    uint item_1,
    threadgroup type_9& band_sums
) {
    uint splat_1 = 0u;
    uint step = 32u;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e20 = step;
            step = naga_div(_e20, 2u);
        }
        loop_init_1 = false;
        uint _e5 = step;
        if (_e5 > 0u) {
        } else {
            break;
        }
        {
            uint _e9 = splat_1;
            uint _e10 = step;
            uint _e15 = band_sums.inner[(_e9 + _e10) - 1u];
            if (_e15 <= item_1) {
                uint _e17 = splat_1;
                uint _e18 = step;
                splat_1 = _e17 + _e18;
            }
        }
    }
    uint _e23 = splat_1;
    return _e23;
}

float half_width_at(
    float dy,
    float u11_,
    float u22_,
    float cutoff
) {
    float v = u22_ * dy;
    return metal::sqrt(metal::max(cutoff - (v * v), 0.0)) / u11_;
}

metal::float2 x_interval(
    metal::float4 centre,
    metal::float4 extent,
    uint band
) {
    float u11_1 = centre.z;
    float u12_ = centre.w;
    float u22_1 = extent.x;
    float half_height_1 = extent.z;
    float y_first = static_cast<float>(band * TILE) + 0.5;
    float y_last = y_first + 15.0;
    float low_1 = metal::max((y_first - SLACK) - centre.y, -(half_height_1));
    float high_1 = metal::min((y_last + SLACK) - centre.y, half_height_1);
    if (low_1 > high_1) {
        return metal::float2(1.0, -1000000000.0);
    }
    float slope = -(u12_) / u11_1;
    float cutoff_1 = metal::max(extent.y + LOG2_255_, 0.0);
    float slope_u22_ = (slope * u11_1) / u22_1;
    float right_end = (slope_u22_ * metal::sqrt(cutoff_1)) / (u22_1 * metal::sqrt(1.0 + (slope_u22_ * slope_u22_)));
    float at_right = metal::clamp(right_end, low_1, high_1);
    float at_left = metal::clamp(-(right_end), low_1, high_1);
    float _e52 = half_width_at(at_right, u11_1, u22_1, cutoff_1);
    float right = (centre.x + (slope * at_right)) + _e52;
    float _e57 = half_width_at(at_left, u11_1, u22_1, cutoff_1);
    float left_1 = (centre.x + (slope * at_left)) - _e57;
    float slack = SLACK + (0.00001 * (right - left_1));
    return metal::float2(left_1 - slack, right + slack);
}

TileRun tile_run(
    uint item_2,
    uint splat_2,
    constant Region& region,
    threadgroup type_8& group_centres,
    threadgroup type_8& group_extents,
    threadgroup type_9& first_bands,
    threadgroup type_9& band_sums
) {
    uint before = 0u;
    if (splat_2 > 0u) {
        uint _e10 = band_sums.inner[splat_2 - 1u];
        before = _e10;
    }
    uint _e13 = first_bands.inner[splat_2];
    uint _e15 = before;
    uint band_1 = (_e13 + item_2) - _e15;
    metal::float4 _e19 = group_centres.inner[splat_2];
    metal::float4 _e22 = group_extents.inner[splat_2];
    metal::float2 _e23 = x_interval(_e19, _e22, band_1);
    uint _e27 = region.first_tile.x;
    float low_2 = static_cast<float>(_e27);
    uint _e32 = region.first_tile.x;
    uint _e36 = region.tiles.x;
    float high_2 = static_cast<float>(_e32 + _e36);
    float first_1 = metal::floor((_e23.x - 0.5) / 16.0);
    float last_1 = metal::floor((_e23.y - 0.5) / 16.0);
    float from_tile = metal::clamp(first_1, low_2, high_2);
    float to_tile = metal::clamp(last_1 + 1.0, from_tile, high_2);
    uint _e58 = region.first_tile.y;
    uint _e63 = region.tiles.x;
    uint row = (band_1 - _e58) * _e63;
    uint _e70 = region.first_tile.x;
    return TileRun {(row + naga_f2u32(from_tile)) - _e70, naga_f2u32(to_tile - from_tile)};
}

uint run_of_entry(
    uint entry_1,
    threadgroup type_2& scan_values
) {
    uint run_1 = 0u;
    uint step_1 = 128u;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e20 = step_1;
            step_1 = naga_div(_e20, 2u);
        }
        loop_init_2 = false;
        uint _e5 = step_1;
        if (_e5 > 0u) {
        } else {
            break;
        }
        {
            uint _e9 = run_1;
            uint _e10 = step_1;
            uint _e15 = scan_values.inner[(_e9 + _e10) - 1u];
            if (_e15 <= entry_1) {
                uint _e17 = run_1;
                uint _e18 = step_1;
                run_1 = _e17 + _e18;
            }
        }
    }
    uint _e23 = run_1;
    return _e23;
}

struct countInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void count(
  metal::uint3 group_id [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, threadgroup type_2& scan_values
, constant Region& region [[user(fake0)]]
, device type_4 const& order [[user(fake0)]]
, device type_7 const& centres [[user(fake0)]]
, device type_7 const& extents [[user(fake0)]]
, device type_4 const& counts [[user(fake0)]]
, device type_4& group_entries [[user(fake0)]]
, threadgroup type_8& group_centres
, threadgroup type_8& group_extents
, threadgroup type_9& group_splats
, threadgroup type_9& first_bands
, threadgroup type_9& band_sums
, threadgroup uint& all_bands
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint entries = 0u;
    uint item = {};
    bool local = {};
    uint _e3 = flat_group(group_id, groups);
    load_group(_e3, thread_, scan_values, region, order, centres, extents, counts, group_centres, group_extents, group_splats, first_bands, band_sums, all_bands, _buffer_sizes);
    item = thread_;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e18 = item;
            item = _e18 + 256u;
        }
        loop_init_3 = false;
        uint _e7 = item;
        uint _e9 = all_bands;
        if (_e7 < _e9) {
        } else {
            break;
        }
        {
            uint _e11 = entries;
            uint _e12 = item;
            uint _e13 = item;
            uint _e14 = splat_of_band(_e13, band_sums);
            TileRun _e15 = tile_run(_e12, _e14, region, group_centres, group_extents, first_bands, band_sums);
            uint _e17 = saturating_add(_e11, _e15.count);
            entries = _e17;
        }
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    uint _e21 = entries;
    uint _e22 = inclusive_scan(thread_, _e21, scan_values);
    if (thread_ == 255u) {
        uint _e31 = counts[0];
        local = (_e3 * SPLATS_PER_GROUP) < _e31;
    } else {
        local = false;
    }
    bool _e34 = local;
    if (_e34) {
        group_entries[_e3] = _e22;
        return;
    } else {
        return;
    }
}


struct emitInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void emit(
  metal::uint3 group_id_1 [[threadgroup_position_in_grid]]
, metal::uint3 groups_1 [[threadgroups_per_grid]]
, uint thread_1 [[thread_index_in_threadgroup]]
, threadgroup type_2& scan_values
, device type_4& entry_tiles [[user(fake0)]]
, device type_4& entry_slots [[user(fake0)]]
, device type_4& slot_splats [[user(fake0)]]
, constant Region& region [[user(fake0)]]
, device type_4 const& order [[user(fake0)]]
, device type_7 const& centres [[user(fake0)]]
, device type_7 const& extents [[user(fake0)]]
, device type_4 const& counts [[user(fake0)]]
, device type_4 const& group_entries [[user(fake0)]]
, threadgroup type_8& group_centres
, threadgroup type_8& group_extents
, threadgroup type_9& group_splats
, threadgroup type_9& first_bands
, threadgroup type_9& band_sums
, threadgroup uint& all_bands
, threadgroup type_2& run_splats
, threadgroup type_2& run_tiles
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint position = 0u;
    uint first_item = 0u;
    TileRun run = {};
    uint entry = {};
    uint _e3 = flat_group(group_id_1, groups_1);
    load_group(_e3, thread_1, scan_values, region, order, centres, extents, counts, group_centres, group_extents, group_splats, first_bands, band_sums, all_bands, _buffer_sizes);
    uint _e10 = counts[0];
    if ((_e3 * SPLATS_PER_GROUP) < _e10) {
        uint _e14 = group_entries[_e3];
        position = _e14;
    }
    uint bands_1 = all_bands;
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e74 = first_item;
            first_item = _e74 + 256u;
        }
        loop_init_4 = false;
        uint _e19 = first_item;
        if (_e19 < bands_1) {
        } else {
            break;
        }
        {
            uint _e21 = first_item;
            uint item_3 = _e21 + thread_1;
            run = TileRun {0u, 0u};
            if (item_3 < bands_1) {
                uint _e28 = splat_of_band(item_3, band_sums);
                TileRun _e29 = tile_run(item_3, _e28, region, group_centres, group_extents, first_bands, band_sums);
                run = _e29;
                uint _e34 = group_splats.inner[_e28];
                run_splats.inner[thread_1] = _e34;
            }
            uint _e36 = run.count;
            uint _e37 = inclusive_scan(thread_1, _e36, scan_values);
            uint _e41 = run.first;
            uint _e43 = run.count;
            run_tiles.inner[thread_1] = _e41 - (_e37 - _e43);
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint entries_1 = scan_values.inner[255];
            entry = thread_1;
            bool loop_init_5 = true;
            while(true) {
                if (!loop_init_5) {
                    uint _e69 = entry;
                    entry = _e69 + 256u;
                }
                loop_init_5 = false;
                uint _e50 = entry;
                if (_e50 < entries_1) {
                } else {
                    break;
                }
                {
                    uint _e52 = entry;
                    uint _e53 = run_of_entry(_e52, scan_values);
                    uint _e54 = position;
                    uint _e55 = entry;
                    uint target_index = _e54 + _e55;
                    uint _e59 = region.capacity;
                    if (target_index < _e59) {
                        uint _e63 = run_tiles.inner[_e53];
                        uint _e64 = entry;
                        uint _e68 = run_splats.inner[_e53];
                        write_entry(target_index, _e63 + _e64, _e68, entry_tiles, entry_slots, slot_splats, _buffer_sizes);
                    }
                }
            }
            uint _e72 = position;
            position = _e72 + entries_1;
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
        }
    }
    return;
}
