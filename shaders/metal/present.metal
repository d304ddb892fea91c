// Made from shaders/present.wgsl by scripts/export-msl.

// language: metal3.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct _mslBufferSizes {
    uint size1;
};

struct Presentation {
    metal::float4 background;
    metal::uint2 image;
    metal::uint2 texture;
};
typedef metal::float4 type_3[1];
constant bool LINEAR = false;

metal::float4 pixel(
    metal::int2 at,
    constant Presentation& presentation,
    device type_3 const& image,
    constant _mslBufferSizes& _buffer_sizes
) {
    metal::uint2 _e5 = presentation.image;
    metal::uint2 inside = static_cast<metal::uint2>(metal::clamp(at, metal::int2(0), as_type<metal::int2>(as_type<metal::uint2>(static_cast<metal::int2>(_e5)) - as_type<metal::uint2>(metal::int2(1)))));
    uint _e17 = presentation.image.x;
    metal::float4 _e22 = image[(inside.y * _e17) + inside.x];
    return _e22;
}

metal::float3 linear_light(
    metal::float3 encoded
) {
    metal::float3 low = encoded / metal::float3(12.92);
    metal::float3 high = metal::pow((metal::max(encoded, metal::float3(0.0)) + metal::float3(0.055)) / metal::float3(1.055), metal::float3(2.4));
    return metal::select(high, low, encoded <= metal::float3(0.04045));
}

struct coverInput {
};
struct coverOutput {
    metal::float4 member [[position]];
};
vertex coverOutput cover(
  uint vertex_ [[vertex_id]]
) {
    metal::float2 corner = metal::float2(static_cast<float>((vertex_ << 1u) & 2u), static_cast<float>(vertex_ & 2u));
    return coverOutput { metal::float4((corner * 2.0) - metal::float2(1.0), 0.0, 1.0) };
}

metal::int2 naga_f2i32(metal::float2 value) {
    return static_cast<metal::int2>(metal::clamp(value, -2147483600.0, 2147483500.0));
}


struct presentInput {
};
struct presentOutput {
    metal::float4 member_1 [[color(0)]];
};
fragment presentOutput present(
  metal::float4 position [[position]]
, constant Presentation& presentation [[user(fake0)]]
, device type_3 const& image [[user(fake0)]]
, constant _mslBufferSizes& _buffer_sizes [[user(fake0)]]
) {
    metal::uint2 _e3 = presentation.image;
    metal::uint2 _e7 = presentation.texture;
    metal::float2 scale = static_cast<metal::float2>(_e3) / static_cast<metal::float2>(_e7);
    metal::float2 at_1 = (position.xy * scale) - metal::float2(0.5);
    metal::float2 corner_1 = metal::floor(at_1);
    metal::float2 share = at_1 - corner_1;
    metal::int2 first = naga_f2i32(corner_1);
    metal::float4 _e18 = pixel(first, presentation, image, _buffer_sizes);
    metal::float4 _e23 = pixel(as_type<metal::int2>(as_type<metal::uint2>(first) + as_type<metal::uint2>(metal::int2(1, 0))), presentation, image, _buffer_sizes);
    metal::float4 top = metal::mix(_e18, _e23, share.x);
    metal::float4 _e30 = pixel(as_type<metal::int2>(as_type<metal::uint2>(first) + as_type<metal::uint2>(metal::int2(0, 1))), presentation, image, _buffer_sizes);
    metal::float4 _e35 = pixel(as_type<metal::int2>(as_type<metal::uint2>(first) + as_type<metal::uint2>(metal::int2(1, 1))), presentation, image, _buffer_sizes);
    metal::float4 bottom = metal::mix(_e30, _e35, share.x);
    metal::float4 seen = metal::mix(top, bottom, share.y);
    metal::float4 _e46 = presentation.background;
    metal::float3 color = seen.xyz + ((1.0 - seen.w) * _e46.xyz);
    if (LINEAR) {
        metal::float3 _e51 = linear_light(color);
        return presentOutput { metal::float4(_e51, 1.0) };
    }
    return presentOutput { metal::float4(color, 1.0) };
}
