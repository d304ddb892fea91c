// Colour by spherical harmonics, up to degree 3.
//
// Needs: common/numbers, and of the stage a function `coefficients(at: u32, k: u32) -> vec3<f32>`:
// r g b of coefficient `k` of the splat at a place that only the stage knows.

const MAX_CHANNEL: f32 = 65504.0;
const MIN_NORMAL: f32 = 1.17549435e-38;

const SH_C0: f32 = 0.28209479;
const SH_C1: f32 = 0.4886025;

/// max(0, x), at most MAX_CHANNEL; what is not a number is 0.
fn limited_color(color: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(limited_channel(color.x), limited_channel(color.y), limited_channel(color.z));
}

fn limited_channel(x: f32) -> f32 {
    return select(clamp(x, 0.0, MAX_CHANNEL), 0.0, is_nan(x));
}

/// v / ‖v‖, or z where v has no direction.
fn direction(v: vec3<f32>) -> vec3<f32> {
    let squared = dot(v, v);
    if (squared > MIN_NORMAL && is_finite(squared)) {
        return v / sqrt(squared);
    }
    // Squares out of range: divide by the largest component first.
    let largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if (!(largest > 0.0 && is_finite(largest))) {
        return vec3<f32>(0.0, 0.0, 1.0);
    }
    let scaled = v / largest;
    return scaled / sqrt(dot(scaled, scaled));
}

/// 0.5 + Σ cₖ Yₖ(d) of the bands 0…`degree`, before the clamp.
fn view_color(at: u32, degree: u32, d: vec3<f32>) -> vec3<f32> {
    var color = 0.5 + SH_C0 * coefficients(at, 0u);
    if (degree == 0u) {
        return color;
    }
    color += (-SH_C1 * d.y) * coefficients(at, 1u);
    color += (SH_C1 * d.z) * coefficients(at, 2u);
    color += (-SH_C1 * d.x) * coefficients(at, 3u);
    if (degree == 1u) {
        return color;
    }
    let s = d * d;
    color += (1.0925485 * d.x * d.y) * coefficients(at, 4u);
    color += (-1.0925485 * d.y * d.z) * coefficients(at, 5u);
    color += (0.31539157 * (2.0 * s.z - s.x - s.y)) * coefficients(at, 6u);
    color += (-1.0925485 * d.x * d.z) * coefficients(at, 7u);
    color += (0.54627424 * (s.x - s.y)) * coefficients(at, 8u);
    if (degree == 2u) {
        return color;
    }
    color += (-0.5900436 * d.y * (3.0 * s.x - s.y)) * coefficients(at, 9u);
    color += (2.8906114 * d.x * d.y * d.z) * coefficients(at, 10u);
    color += (-0.4570458 * d.y * (4.0 * s.z - s.x - s.y)) * coefficients(at, 11u);
    color += (0.37317634 * d.z * (2.0 * s.z - 3.0 * s.x - 3.0 * s.y)) * coefficients(at, 12u);
    color += (-0.4570458 * d.x * (4.0 * s.z - s.x - s.y)) * coefficients(at, 13u);
    color += (1.4453057 * d.z * (s.x - s.y)) * coefficients(at, 14u);
    color += (-0.5900436 * d.x * (s.x - 3.0 * s.y)) * coefficients(at, 15u);
    return color;
}
