// Made from shaders/weigh.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size3;
    uint size4;
    uint size5;
    uint size6;
    uint size7;
    uint size8;
    uint size9;
    uint size10;
    uint size11;
};

struct type_4 {
    uint inner[256];
};
struct Densification {
    uint splats;
    uint count;
    metal::uint2 seed;
    uint step;
    uint purpose;
    uint shift;
    uint even_weight;
    float dead_logit;
    float lowest_logit;
    uint padding_1_;
    uint padding_2_;
};
struct type_7 {
    metal::uint4 inner[513];
};
typedef float type_8[1];
typedef uint type_9[1];
constant uint MAX_GROUPS_PER_ROW = 65535u;
constant uint SCAN_WIDTH = 256u;
constant uint NO_HOST = 4294967295u;
constant uint DEAD = 4294967294u;
constant uint REST_WIDTH = 0u;

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

uint saturating_add(
    uint a,
    uint b
) {
    uint sum_1 = a + b;
    return (sum_1 < a) ? 4294967295u : sum_1;
}

uint inclusive_scan(
    uint thread_1,
    uint value,
    threadgroup type_4& scan_values
) {
    uint sum = {};
    uint distance = 1u;
    uint left = {};
    sum = value;
    uint _e5 = sum;
    scan_values.inner[thread_1] = _e5;
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
            if (thread_1 >= _e13) {
                uint _e16 = distance;
                uint _e19 = scan_values.inner[thread_1 - _e16];
                left = _e19;
            }
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
            uint _e20 = sum;
            uint _e21 = left;
            uint _e22 = saturating_add(_e20, _e21);
            sum = _e22;
            uint _e25 = sum;
            scan_values.inner[thread_1] = _e25;
            metal::threadgroup_barrier(metal::mem_flags::mem_threadgroup);
        }
    }
    uint _e29 = sum;
    return _e29;
}

bool all_finite(
    uint splat,
    device type_8 const& positions,
    device type_8 const& log_scales,
    device type_8 const& rotations,
    device type_8 const& opacity_logits,
    device type_8 const& sh_dc,
    device type_8 const& sh_rest,
    constant _mslBufferSizes& _buffer_sizes
) {
    bool finite = {};
    uint c = 0u;
    bool local_2 = {};
    bool local_3 = {};
    bool local_4 = {};
    uint c_1 = 0u;
    bool local_5 = {};
    uint c_2 = 0u;
    bool local_6 = {};
    float _e3 = opacity_logits[splat];
    bool _e4 = is_finite(_e3);
    finite = _e4;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e41 = c;
            c = _e41 + 1u;
        }
        loop_init_1 = false;
        uint _e8 = c;
        if (_e8 < 3u) {
        } else {
            break;
        }
        {
            uint _e13 = c;
            uint i_1 = (3u * splat) + _e13;
            bool _e15 = finite;
            if (_e15) {
                float _e20 = positions[i_1];
                bool _e21 = is_finite(_e20);
                local_2 = _e21;
            } else {
                local_2 = false;
            }
            bool _e23 = local_2;
            if (_e23) {
                float _e28 = log_scales[i_1];
                bool _e29 = is_finite(_e28);
                local_3 = _e29;
            } else {
                local_3 = false;
            }
            bool _e31 = local_3;
            if (_e31) {
                float _e36 = sh_dc[i_1];
                bool _e37 = is_finite(_e36);
                local_4 = _e37;
            } else {
                local_4 = false;
            }
            bool _e39 = local_4;
            finite = _e39;
        }
    }
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e62 = c_1;
            c_1 = _e62 + 1u;
        }
        loop_init_2 = false;
        uint _e45 = c_1;
        if (_e45 < 4u) {
        } else {
            break;
        }
        {
            bool _e48 = finite;
            if (_e48) {
                uint _e54 = c_1;
                float _e57 = rotations[(4u * splat) + _e54];
                bool _e58 = is_finite(_e57);
                local_5 = _e58;
            } else {
                local_5 = false;
            }
            bool _e60 = local_5;
            finite = _e60;
        }
    }
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e83 = c_2;
            c_2 = _e83 + 1u;
        }
        loop_init_3 = false;
        uint _e66 = c_2;
        if (_e66 < REST_WIDTH) {
        } else {
            break;
        }
        {
            bool _e69 = finite;
            if (_e69) {
                uint _e75 = c_2;
                float _e78 = sh_rest[(REST_WIDTH * splat) + _e75];
                bool _e79 = is_finite(_e78);
                local_6 = _e79;
            } else {
                local_6 = false;
            }
            bool _e81 = local_6;
            finite = _e81;
        }
    }
    bool _e85 = finite;
    return _e85;
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

uint table_entry(
    uint i,
    constant type_7& opacity_units
) {
    uint _e8 = opacity_units.inner[naga_div(i, 4u)][naga_mod(i, 4u)];
    return _e8;
}

int naga_f2i32(float value) {
    return static_cast<int>(metal::clamp(value, -2147483600.0, 2147483500.0));
}

uint units_of(
    float logit,
    constant type_7& opacity_units
) {
    uint fixed = static_cast<uint>(as_type<int>(as_type<uint>(naga_f2i32(metal::clamp(logit, -16.0, 16.0) * 16384.0)) + as_type<uint>(262144)));
    uint _e12 = table_entry(fixed >> 8u, opacity_units);
    uint _e17 = table_entry((fixed >> 8u) + 1u, opacity_units);
    return _e12 + (((_e17 - _e12) * (fixed & 255u)) >> 8u);
}

struct weighInput {
};
[[max_total_threads_per_threadgroup(256)]] kernel void weigh(
  metal::uint3 group [[threadgroup_position_in_grid]]
, metal::uint3 groups [[threadgroups_per_grid]]
, uint thread_ [[thread_index_in_threadgroup]]
, threadgroup type_4& scan_values
, constant Densification& densification [[user(fake0)]]
, constant type_7& opacity_units [[user(fake0)]]
, device type_8 const& positions [[user(fake0)]]
, device type_8 const& log_scales [[user(fake0)]]
, device type_8 const& rotations [[user(fake0)]]
, device type_8 const& opacity_logits [[user(fake0)]]
, device type_8 const& sh_dc [[user(fake0)]]
, device type_8 const& sh_rest [[user(fake0)]]
, device type_9& sums [[user(fake0)]]
, device type_9& block_sums [[user(fake0)]]
, device type_9& hosts [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    uint weight = 0u;
    bool local = {};
    bool local_1 = {};
    uint _e3 = flat_group(group, groups);
    uint splat_1 = (_e3 * 256u) + thread_;
    uint _e11 = densification.splats;
    if (splat_1 < _e11) {
        float logit_1 = opacity_logits[splat_1];
        bool _e16 = all_finite(splat_1, positions, log_scales, rotations, opacity_logits, sh_dc, sh_rest, _buffer_sizes);
        if (_e16) {
            float _e21 = densification.dead_logit;
            local = logit_1 > _e21;
        } else {
            local = false;
        }
        bool alive = local;
        hosts[splat_1] = alive ? NO_HOST : DEAD;
        if (alive) {
            uint _e30 = units_of(logit_1, opacity_units);
            uint _e33 = densification.shift;
            weight = _e30 >> _e33;
        }
    }
    uint _e35 = weight;
    uint _e36 = inclusive_scan(thread_, _e35, scan_values);
    uint _e39 = densification.splats;
    if (splat_1 < _e39) {
        sums[splat_1] = _e36;
    }
    if (thread_ == 255u) {
        uint _e51 = densification.splats;
        local_1 = (_e3 * 256u) < _e51;
    } else {
        local_1 = false;
    }
    bool _e54 = local_1;
    if (_e54) {
        block_sums[_e3] = _e36;
        return;
    } else {
        return;
    }
}
