// Made from shaders/report.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size1;
    uint size2;
    uint size3;
};

struct type_4 {
    metal::float4 inner[2];
};
struct TrainingStep {
    uint splats;
    uint step;
    metal::uint2 seed;
    metal::float4 background;
    metal::uint2 image;
    metal::uint2 tiles;
    float l1_scale;
    float ssim_scale;
    uint weighted;
    uint slot;
    type_4 rates;
    float beta1_;
    float one_minus_beta1_;
    float beta2_;
    float one_minus_beta2_;
    float second_correction;
    float epsilon;
    float opacity_pressure;
    float scale_pressure;
    float noise_amplitude;
    float gate_steepness;
    float gate_opacity;
    uint zero;
};
typedef metal::float4 type_5[1];
typedef uint type_6[1];
struct type_7 {
    metal::float4 inner[256];
};
constant uint VISIBLE = 0u;
constant uint ENTRIES = 1u;
constant uint SORTED_ENTRIES = 2u;
constant uint DYNAMIC = 3u;
constant uint MOST_ENTRIES = 4u;
constant uint HALTED = 5u;
constant uint DRAWN_FRAMES = 6u;
constant uint REPORT_WORDS = 8u;
constant uint REPORT_DIFFERENCE = 0u;
constant uint REPORT_DISSIMILARITY = 1u;
constant uint REPORT_IMAGE_NOT_FINITE = 2u;
constant uint REPORT_NOT_FINITE = 3u;
constant uint REPORT_VISIBLE = 4u;
constant uint REPORT_ENTRIES = 5u;
constant uint REPORT_HALTED = 6u;
constant uint REPORT_STEP = 7u;

uint report_word(
    uint slot,
    uint word
) {
    return (slot * REPORT_WORDS) + word;
}
uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

uint naga_f2u32(float value) {
    return static_cast<uint>(metal::clamp(value, 0.0, 4294967000.0));
}


struct reportInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void report(
  uint thread_ [[thread_index_in_threadgroup]]
, constant TrainingStep& training [[user(fake0)]]
, device type_5 const& tile_sums [[user(fake0)]]
, device type_6 const& counts [[user(fake0)]]
, device type_6& reports [[user(fake0)]]
, threadgroup type_7& partial
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    metal::float4 sum = metal::float4(0.0);
    uint tile = {};
    uint half_ = 128u;
    uint _e4 = training.tiles.x;
    uint _e8 = training.tiles.y;
    uint tiles = _e4 * _e8;
    tile = thread_;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e22 = tile;
            tile = _e22 + 256u;
        }
        loop_init = false;
        uint _e14 = tile;
        if (_e14 < tiles) {
        } else {
            break;
        }
        {
            metal::float4 _e16 = sum;
            uint _e18 = tile;
            metal::float4 _e20 = tile_sums[_e18];
            sum = _e16 + _e20;
        }
    }
    metal::float4 _e27 = sum;
    partial.inner[thread_] = _e27;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e44 = half_;
            half_ = naga_div(_e44, 2u);
        }
        loop_init_1 = false;
        uint _e30 = half_;
        if (_e30 > 0u) {
        } else {
            break;
        }
        {
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e33 = half_;
            if (thread_ < _e33) {
                metal::float4 _e37 = partial.inner[thread_];
                uint _e39 = half_;
                metal::float4 _e42 = partial.inner[thread_ + _e39];
                partial.inner[thread_] = _e37 + _e42;
            }
        }
    }
    if (thread_ != 0u) {
        return;
    }
    metal::float4 total = partial.inner[0];
    uint slot_1 = training.slot;
    uint _e57 = report_word(slot_1, REPORT_DIFFERENCE);
    reports[_e57] = as_type<uint>(total.x);
    uint _e63 = report_word(slot_1, REPORT_DISSIMILARITY);
    reports[_e63] = as_type<uint>(total.y);
    uint _e69 = report_word(slot_1, REPORT_IMAGE_NOT_FINITE);
    reports[_e69] = naga_f2u32(total.z);
    uint _e75 = report_word(slot_1, REPORT_NOT_FINITE);
    reports[_e75] = 0u;
    uint _e80 = report_word(slot_1, REPORT_VISIBLE);
    uint _e84 = counts[0];
    reports[_e80] = _e84;
    uint _e87 = report_word(slot_1, REPORT_ENTRIES);
    uint _e91 = counts[4];
    reports[_e87] = _e91;
    uint _e94 = report_word(slot_1, REPORT_HALTED);
    uint _e98 = counts[5];
    reports[_e94] = _e98;
    uint _e101 = report_word(slot_1, REPORT_STEP);
    uint _e105 = training.step;
    reports[_e101] = _e105;
    return;
}
