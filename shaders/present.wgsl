// Presentation: the image that blending left in a buffer, onto a texture that a screen shows.
//
// Colour space. The image holds what the scene was trained on: display (sRGB-encoded) values,
// premultiplied by alpha. Blending over the background happens on those values, as everywhere else
// in the renderer, and their meaning changes here or nowhere: a texture of plain numbers gets them
// as they are, a texture that encodes on write, or that is read as linear light, gets them decoded
// (LINEAR).

struct Presentation {
    /// r g b under what the splats leave open, display values.
    background: vec4<f32>,
    /// Width and height of the image, pixels.
    image: vec2<u32>,
    /// Width and height of the texture, pixels.
    texture: vec2<u32>,
}

@group(0) @binding(0) var<uniform> presentation: Presentation;
/// Premultiplied r g b, and alpha; rows of `presentation.image.x`.
@group(0) @binding(1) var<storage, read> image: array<vec4<f32>>;

/// Whether the texture takes linear light.
override LINEAR: bool = false;

/// A triangle that covers the texture.
@vertex
fn cover(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32((vertex << 1u) & 2u), f32(vertex & 2u));
    return vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0);
}

fn pixel(at: vec2<i32>) -> vec4<f32> {
    let inside = vec2<u32>(clamp(at, vec2<i32>(0), vec2<i32>(presentation.image) - 1));
    return image[inside.y * presentation.image.x + inside.x];
}

/// sRGB's decoding (IEC 61966-2-1).
fn linear_light(encoded: vec3<f32>) -> vec3<f32> {
    let low = encoded / 12.92;
    let high = pow((max(encoded, vec3<f32>(0.0)) + 0.055) / 1.055, vec3<f32>(2.4));
    return select(high, low, encoded <= vec3<f32>(0.04045));
}

@fragment
fn present(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    // Images of another size are stretched, bilinearly; of the same size, the shares are 0 and 1.
    let scale = vec2<f32>(presentation.image) / vec2<f32>(presentation.texture);
    let at = position.xy * scale - 0.5;
    let corner = floor(at);
    let share = at - corner;
    let first = vec2<i32>(corner);
    let top = mix(pixel(first), pixel(first + vec2<i32>(1, 0)), share.x);
    let bottom = mix(pixel(first + vec2<i32>(0, 1)), pixel(first + vec2<i32>(1, 1)), share.x);
    let seen = mix(top, bottom, share.y);
    let color = seen.xyz + (1.0 - seen.w) * presentation.background.xyz;
    if (LINEAR) {
        return vec4<f32>(linear_light(color), 1.0);
    }
    return vec4<f32>(color, 1.0);
}
