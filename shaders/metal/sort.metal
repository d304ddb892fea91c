// Made from shaders/sort.wgsl by scripts/export-msl.

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
};

struct type_2 {
    uint inner[256];
};
struct SortPass {
    uint shift;
    uint count;
    uint keys_per_thread;
    uint max_blocks;
};
typedef uint type_3[1];
struct type_6 {
    metal::atomic_uint inner[256];
};
struct type_7 {
    metal::atomic_uint inner[2048];
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
constant uint DIGITS = 256u;
constant uint NOT_DRAWN = 4294967295u;
constant bool DROPS_NOT_DRAWN = false;

uint flat_group(
    metal::uint3 group_3,
    metal::uint3 groups_2
) {
    return (group_3.y * groups_2.x) + group_3.x;
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
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
    uint thread_3,
    uint value,
    threadgroup type_2& scan_values
) {
    uint sum = {};
    uint distance = 1u;
    uint left = {};
    sum = value;
    uint _e5 = sum;
    scan_values.inner[thread_3] = _e5;
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
            if (thread_3 >= _e13) {
                uint _e16 = distance;
                uint _e19 = scan_values.inner[thread_3 - _e16];
                left = _e19;
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e20 = sum;
            uint _e21 = left;
            uint _e22 = saturating_add(_e20, _e21);
            sum = _e22;
            uint _e25 = sum;
            scan_values.inner[thread_3] = _e25;
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

uint pair_count(
    constant SortPass& sort_pass,
    device type_3 const& counts,
    constant _mslBufferSizes& _buffer_sizes
) {
    if (DROPS_NOT_DRAWN) {
        uint _e3 = sort_pass.count;
        return _e3;
    }
    uint _e7 = sort_pass.count;
    uint _e9 = counts[_e7];
    return _e9;
}

bool is_kept(
    uint key_1
) {
    bool local = {};
    if (false) {
        local = key_1 != NOT_DRAWN;
    } else {
        local = true;
    }
    bool _e10 = local;
    return _e10;
}

uint digit_of(
    uint i,
    uint key_2,
    constant SortPass& sort_pass,
    device type_3 const& values_in,
    constant _mslBufferSizes& _buffer_sizes
) {
    if (DROPS_NOT_DRAWN) {
        uint _e5 = values_in[i];
        return _e5 & 255u;
    }
    uint _e10 = sort_pass.shift;
    return (key_2 >> _e10) & 255u;
}

struct histogramInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void histogram(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, constant SortPass& sort_pass [[user(fake0)]]
, device type_3 const& counts [[user(fake0)]]
, device type_3 const& keys_in [[user(fake0)]]
, device type_3 const& values_in [[user(fake0)]]
, device type_3& block_counts [[user(fake0)]]
, threadgroup type_6& block_histogram
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint round = 0u;
    uint _e3 = flat_group(group, groups);
    uint _e4 = pair_count(sort_pass, counts, _buffer_sizes);
    metal::atomic_store_explicit(&block_histogram.inner[thread_], 0u, metal::memory_order_relaxed);
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e35 = round;
            round = _e35 + 1u;
        }
        loop_init_1 = false;
        uint _e10 = round;
        uint _e13 = sort_pass.keys_per_thread;
        if (_e10 < _e13) {
        } else {
            break;
        }
        {
            uint _e17 = sort_pass.keys_per_thread;
            uint _e19 = round;
            uint i_1 = (((_e3 * _e17) + _e19) * 256u) + thread_;
            if (i_1 < _e4) {
                uint key_3 = keys_in[i_1];
                bool _e28 = is_kept(key_3);
                if (_e28) {
                    uint _e30 = digit_of(i_1, key_3, sort_pass, values_in, _buffer_sizes);
                    uint _e33 = metal::atomic_fetch_add_explicit(&block_histogram.inner[_e30], 1u, metal::memory_order_relaxed);
                }
            }
        }
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    uint _e39 = sort_pass.max_blocks;
    if (_e3 < _e39) {
        uint _e44 = sort_pass.max_blocks;
        uint _e50 = metal::atomic_load_explicit(&block_histogram.inner[thread_], metal::memory_order_relaxed);
        block_counts[(thread_ * _e44) + _e3] = _e50;
        return;
    } else {
        return;
    }
}


struct scan_digitsInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void scan_digits(
  metal::uint3 group_1 [[threadgroup_position_in_grid]]
, uint thread_1 [[thread_index_in_threadgroup]]
, threadgroup type_2& scan_values
, constant SortPass& sort_pass [[user(fake0)]]
, device type_3 const& counts [[user(fake0)]]
, device type_3& block_counts [[user(fake0)]]
, device type_3& digit_counts [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint before = 0u;
    uint first = 0u;
    uint count = {};
    uint _e5 = sort_pass.max_blocks;
    uint row = group_1.x * _e5;
    uint _e7 = pair_count(sort_pass, counts, _buffer_sizes);
    uint _e10 = sort_pass.keys_per_thread;
    uint _e13 = divide_up(_e7, _e10 * 256u);
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e44 = first;
            first = _e44 + SCAN_WIDTH;
        }
        loop_init_2 = false;
        uint _e18 = first;
        if (_e18 < _e13) {
        } else {
            break;
        }
        {
            uint _e20 = first;
            uint block = _e20 + thread_1;
            count = 0u;
            if (block < _e13) {
                uint _e28 = block_counts[row + block];
                count = _e28;
            }
            uint _e29 = count;
            uint _e30 = inclusive_scan(thread_1, _e29, scan_values);
            if (block < _e13) {
                uint _e35 = before;
                uint _e37 = count;
                block_counts[row + block] = (_e35 + _e30) - _e37;
            }
            uint _e39 = before;
            uint _e42 = scan_values.inner[255];
            before = _e39 + _e42;
            scan_barrier();
        }
    }
    if (thread_1 == 0u) {
        uint _e52 = before;
        digit_counts[group_1.x] = _e52;
        return;
    } else {
        return;
    }
}


struct scatterInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void scatter(
  metal::uint3 group_2 [[threadgroup_position_in_grid]]
, metal::uint3 groups_1 [[threadgroups_per_grid]]
, uint thread_2 [[thread_index_in_threadgroup]]
, threadgroup type_2& scan_values
, constant SortPass& sort_pass [[user(fake0)]]
, device type_3 const& counts [[user(fake0)]]
, device type_3 const& keys_in [[user(fake0)]]
, device type_3 const& values_in [[user(fake0)]]
, device type_3& keys_out [[user(fake0)]]
, device type_3& values_out [[user(fake0)]]
, device type_3 const& block_counts [[user(fake0)]]
, device type_3 const& digit_counts [[user(fake0)]]
, threadgroup type_7& holders
, threadgroup type_2& next_position
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint word = {};
    uint round_1 = 0u;
    uint key = {};
    uint digit = {};
    bool kept = {};
    uint position = {};
    bool is_last = {};
    uint before_1 = {};
    uint all = {};
    uint word_1 = {};
    uint _e3 = flat_group(group_2, groups_1);
    uint _e4 = pair_count(sort_pass, counts, _buffer_sizes);
    uint of_digit = digit_counts[thread_2];
    uint _e8 = inclusive_scan(thread_2, of_digit, scan_values);
    uint first_of_digit = _e8 - of_digit;
    uint _e13 = sort_pass.max_blocks;
    uint _e17 = sort_pass.max_blocks;
    uint in_digit = block_counts[(thread_2 * _e13) + metal::min(_e3, _e17 - 1u)];
    next_position.inner[thread_2] = first_of_digit + in_digit;
    word = thread_2;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e35 = word;
            word = _e35 + 256u;
        }
        loop_init_3 = false;
        uint _e28 = word;
        if (_e28 < 2048u) {
        } else {
            break;
        }
        {
            uint _e32 = word;
            metal::atomic_store_explicit(&holders.inner[_e32], 0u, metal::memory_order_relaxed);
        }
    }
    metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
    uint own_word = naga_div(thread_2, 32u);
    uint own_bit = 1u << naga_mod(thread_2, 32u);
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e163 = round_1;
            round_1 = _e163 + 1u;
        }
        loop_init_4 = false;
        uint _e46 = round_1;
        uint _e49 = sort_pass.keys_per_thread;
        if (_e46 < _e49) {
        } else {
            break;
        }
        {
            uint _e53 = sort_pass.keys_per_thread;
            uint _e55 = round_1;
            uint i_2 = (((_e3 * _e53) + _e55) * 256u) + thread_2;
            key = 0u;
            digit = 0u;
            kept = false;
            if (i_2 < _e4) {
                uint _e69 = keys_in[i_2];
                key = _e69;
                uint _e70 = key;
                bool _e71 = is_kept(_e70);
                kept = _e71;
                uint _e72 = key;
                uint _e73 = digit_of(i_2, _e72, sort_pass, values_in, _buffer_sizes);
                digit = _e73;
            }
            bool _e74 = kept;
            if (_e74) {
                uint _e76 = digit;
                uint _e81 = metal::atomic_fetch_or_explicit(&holders.inner[(_e76 * 8u) + own_word], own_bit, metal::memory_order_relaxed);
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            position = 0u;
            is_last = false;
            bool _e86 = kept;
            if (_e86) {
                before_1 = 0u;
                all = 0u;
                word_1 = 0u;
                bool loop_init_5 = true;
                while(true) {
                    if (!loop_init_5) {
                        uint _e120 = word_1;
                        word_1 = _e120 + 1u;
                    }
                    loop_init_5 = false;
                    uint _e93 = word_1;
                    if (_e93 < 8u) {
                    } else {
                        break;
                    }
                    {
                        uint _e97 = digit;
                        uint _e100 = word_1;
                        uint bits = metal::atomic_load_explicit(&holders.inner[(_e97 * 8u) + _e100], metal::memory_order_relaxed);
                        uint here = metal::popcount(bits);
                        uint _e105 = all;
                        all = _e105 + here;
                        uint _e107 = word_1;
                        if (_e107 < own_word) {
                            uint _e109 = before_1;
                            before_1 = _e109 + here;
                        } else {
                            uint _e111 = word_1;
                            if (_e111 == own_word) {
                                uint _e113 = before_1;
                                before_1 = _e113 + metal::popcount(bits & (own_bit - 1u));
                            }
                        }
                    }
                }
                uint _e123 = digit;
                uint _e125 = next_position.inner[_e123];
                uint _e126 = before_1;
                position = _e125 + _e126;
                uint _e128 = before_1;
                uint _e131 = all;
                is_last = (_e128 + 1u) == _e131;
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            bool _e133 = kept;
            if (_e133) {
                uint _e135 = digit;
                metal::atomic_store_explicit(&holders.inner[(_e135 * 8u) + own_word], 0u, metal::memory_order_relaxed);
                bool _e141 = is_last;
                if (_e141) {
                    uint _e143 = digit;
                    uint _e145 = position;
                    next_position.inner[_e143] = _e145 + 1u;
                }
                uint _e149 = position;
                uint _e151 = key;
                keys_out[_e149] = _e151;
                if (DROPS_NOT_DRAWN) {
                    uint _e154 = position;
                    values_out[_e154] = i_2;
                } else {
                    uint _e157 = position;
                    uint _e161 = values_in[i_2];
                    values_out[_e157] = _e161;
                }
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
        }
    }
    return;
}
