// One blend, and its decisions: whether a splat is seen in a pixel, and whether the pixel would be
// left with too little transmittance.
//
// The forward pass and its mirror both blend by these functions. Products that a compiler might
// or might not contract are written as `fma`, so that both make the same decisions.

const LOG2_255: f32 = 7.994353437;
const ALPHA_MAX: f32 = 0.99;
const TRANSMITTANCE_MIN: f32 = 1e-4;

/// Where a pixel is in a splat: v₁ = u11 dx + u12 dy, and ‖U d‖².
struct Place {
    v1: f32,
    power: f32,
}

/// `centre`: x, y, u11, u12. `d`: from the splat's centre to the pixel's.
fn place_of(centre: vec4<f32>, u22: f32, d: vec2<f32>) -> Place {
    let v1 = fma(centre.z, d.x, centre.w * d.y);
    let v2 = u22 * d.y;
    return Place(v1, fma(v1, v1, v2 * v2));
}

/// α ≥ 1/255, decided on the power: the same condition with less rounding.
fn is_seen(power: f32, log2_opacity: f32) -> bool {
    return power <= log2_opacity + LOG2_255;
}

/// α before its ceiling ALPHA_MAX.
fn free_alpha(power: f32, log2_opacity: f32) -> f32 {
    return exp2(log2_opacity - power);
}

/// T after a blend; the pixel is full, and the blend does not happen, when it `fills`.
fn transmittance_after(before: f32, alpha: f32) -> f32 {
    return fma(-alpha, before, before);
}

fn fills(after: f32) -> bool {
    return !(after > TRANSMITTANCE_MIN);
}
