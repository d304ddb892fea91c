// Loss of a view and its gradient by the image: (1 − λ)·L1 + λ·(1 − SSIM).
//
// Needs: common/numbers, common/training.
//
// `loss` computes SSIM and its derivatives by the windowed moments, `loss_backward` carries them
// through the (symmetric) window. One workgroup per 16 × 16 tile and its 5 pixels around, one
// channel after the other, the window in two passes in workgroup memory.
//
// SSIM is written in s = x + y and e = x − y instead of x and y (x: render, y: target). With windowed
// means U of s and V of e and variances A of s and B of e:
//
//     1 − SSIM = q₂ + (1 − q₂) q₁,   q₁ = V²/D₁,  q₂ = B/D₂,
//     D₁ = (U² + V²)/2 + C₁,         D₂ = (A + B)/2 + C₂.
//
// It is the formula of Wang et al. 2004 (rust-core/train/src/loss/reference.rs), but where x = y
// every term of the loss and of its gradient is a product with an exact zero, however a compiler
// fuses multiplications and additions. A variance does not change when a constant is taken from
// all values (outside the image too), and loses less when that constant is near them.

@group(0) @binding(0) var<uniform> training: TrainingStep;
/// Premultiplied r g b, alpha.
@group(0) @binding(1) var<storage, read> render: array<vec4<f32>>;
/// r g b (not premultiplied), alpha of a photograph's pixels, a byte each.
@group(0) @binding(2) var<storage, read> photograph: array<u32>;
/// Weights of four pixels a word; one word where all count the same.
@group(0) @binding(3) var<storage, read> pixel_weights: array<u32>;
/// Derivatives of SSIM: nine planes, P Q R of each channel.
@group(0) @binding(4) var<storage, read_write> derivatives: array<f32>;
/// ∂loss / ∂(r, g, b premultiplied, alpha).
@group(0) @binding(5) var<storage, read_write> gradient: array<vec4<f32>>;
/// Of each tile: Σ|x − y|, Σ(1 − SSIM), values that are not finite.
@group(0) @binding(6) var<storage, read_write> tile_sums: array<vec4<f32>>;

const TILE: u32 = 16u;
const RADIUS: u32 = 5u;
const TAPS: u32 = 11u;
/// Tile with its surroundings.
const WIDE: u32 = 26u;
const C1: f32 = 0.0001;
const C2: f32 = 0.0009;
const UNIT: f32 = 1.0 / 255.0;
/// What s is measured from in the derivatives: the middle of its range.
const MIDDLE: f32 = 1.0;

/// The Gaussian window's one-dimensional factor, σ = 1.5, sum 1.
const WINDOW: array<f32, 11> = array<f32, 11>(
    0.0010283801, 0.007598758, 0.036000773, 0.10936069, 0.21300554, 0.2660117,
    0.21300554, 0.10936069, 0.036000773, 0.007598758, 0.0010283801,
);

// A tile and its surroundings, one component a plane: s, e; or P, Q, R.
var<workgroup> wide_0: array<f32, 676>;
var<workgroup> wide_1: array<f32, 676>;
var<workgroup> wide_2: array<f32, 676>;
/// The horizontal windows; at the end, the sums of each thread.
var<workgroup> across: array<vec4<f32>, 416>;

/// One channel of a pixel.
struct Compared {
    s: f32,
    e: f32,
    /// Weight of the pixel.
    weight: f32,
    target_value: f32,
}

fn compared(pixel: u32, channel: u32) -> Compared {
    let rendered = render[pixel];
    let bytes = photograph[pixel];
    let behind = training.background[channel];
    var y = f32((bytes >> (8u * channel)) & 0xffu) * UNIT;
    let alpha_byte = bytes >> 24u;
    if (alpha_byte != 255u) {
        let alpha = f32(alpha_byte) * UNIT;
        y = alpha * y + (1.0 - alpha) * behind;
    }
    // Not fused with the difference: a render equal to the rounded target has to have none.
    y = opaque(y, training.zero);
    let x = rendered[channel] + (1.0 - rendered.w) * behind;
    var weight = 1.0;
    if (training.weighted != 0u) {
        weight = f32((pixel_weights[pixel / 4u] >> (8u * (pixel % 4u))) & 0xffu) * UNIT;
    }
    let e = weight * (x - y);
    return Compared(e + 2.0 * y, e, weight, y);
}

/// The pixel at a place around a tile, or 2³² − 1 outside the image.
fn pixel_at(first: vec2<u32>, place: u32) -> u32 {
    let x = first.x + place % WIDE;
    let y = first.y + place / WIDE;
    if (x < RADIUS || y < RADIUS || x - RADIUS >= training.image.x || y - RADIUS >= training.image.y) {
        return 0xffffffffu;
    }
    return (y - RADIUS) * training.image.x + x - RADIUS;
}

@compute @workgroup_size(256)
fn loss(@builtin(workgroup_id) tile: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let first = tile.xy * TILE;
    let own = first + vec2<u32>(thread % TILE, thread / TILE);
    let inside = all(own < training.image);
    let own_pixel = own.y * training.image.x + own.x;
    let centre = min(first + TILE / 2u, training.image - 1u);
    let pixels = training.image.x * training.image.y;
    var sums = vec3<f32>(0.0);
    for (var channel = 0u; channel < 3u; channel++) {
        let near = 2.0 * compared(centre.y * training.image.x + centre.x, channel).target_value;
        workgroupBarrier();
        for (var place = thread; place < WIDE * WIDE; place += 256u) {
            let pixel = pixel_at(first, place);
            var s = 0.0;
            var e = 0.0;
            if (pixel != 0xffffffffu) {
                let values = compared(pixel, channel);
                s = values.s;
                e = values.e;
            }
            wide_0[place] = s - near;
            wide_1[place] = e;
        }
        workgroupBarrier();
        for (var place = thread; place < WIDE * TILE; place += 256u) {
            let start = (place / TILE) * WIDE + place % TILE;
            var sum = vec4<f32>(0.0);
            for (var tap = 0u; tap < TAPS; tap++) {
                let v = vec2<f32>(wide_0[start + tap], wide_1[start + tap]);
                sum += WINDOW[tap] * vec4<f32>(v, v * v);
            }
            across[place] = sum;
        }
        workgroupBarrier();
        var moments = vec4<f32>(0.0);
        for (var tap = 0u; tap < TAPS; tap++) {
            moments += WINDOW[tap] * across[thread + tap * TILE];
        }
        if (inside) {
            let variance_s = max(moments.z - moments.x * moments.x, 0.0);
            let variance_e = max(moments.w - moments.y * moments.y, 0.0);
            let u = moments.x + near;
            let v = moments.y;
            let inverse_d1 = 1.0 / (0.5 * (u * u + v * v) + C1);
            let inverse_d2 = 1.0 / (0.5 * (variance_s + variance_e) + C2);
            let q1 = v * v * inverse_d1;
            let q2 = variance_e * inverse_d2;
            let by_square_s = 0.5 * (1.0 - q1) * q2 * inverse_d2;
            let by_square_e = -0.5 * (1.0 - q1) * (2.0 - q2) * inverse_d2;
            let by_mean = (1.0 - q2) * inverse_d1 * (u * q1 - v * (2.0 - q1))
                - 2.0 * ((u - MIDDLE) * by_square_s + v * by_square_e);
            let plane = 3u * channel * pixels + own_pixel;
            derivatives[plane] = by_mean;
            derivatives[plane + pixels] = by_square_s;
            derivatives[plane + 2u * pixels] = by_square_e;
            let e = wide_1[(thread / TILE + RADIUS) * WIDE + thread % TILE + RADIUS];
            sums += vec3<f32>(abs(e), q2 + (1.0 - q2) * q1, select(1.0, 0.0, is_finite(e)));
        }
    }
    workgroupBarrier();
    across[thread] = vec4<f32>(sums, 0.0);
    for (var half = 128u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if (thread < half) {
            across[thread] += across[thread + half];
        }
    }
    if (thread == 0u) {
        tile_sums[tile.y * training.tiles.x + tile.x] = across[0];
    }
}

@compute @workgroup_size(256)
fn loss_backward(
    @builtin(workgroup_id) tile: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let first = tile.xy * TILE;
    let own = first + vec2<u32>(thread % TILE, thread / TILE);
    let inside = all(own < training.image);
    let own_pixel = own.y * training.image.x + own.x;
    let pixels = training.image.x * training.image.y;
    var by_color = vec3<f32>(0.0);
    for (var channel = 0u; channel < 3u; channel++) {
        workgroupBarrier();
        let plane = 3u * channel * pixels;
        for (var place = thread; place < WIDE * WIDE; place += 256u) {
            let pixel = pixel_at(first, place);
            var values = vec3<f32>(0.0);
            if (pixel != 0xffffffffu) {
                values = vec3<f32>(
                    derivatives[plane + pixel],
                    derivatives[plane + pixels + pixel],
                    derivatives[plane + 2u * pixels + pixel],
                );
            }
            wide_0[place] = values.x;
            wide_1[place] = values.y;
            wide_2[place] = values.z;
        }
        workgroupBarrier();
        for (var place = thread; place < WIDE * TILE; place += 256u) {
            let start = (place / TILE) * WIDE + place % TILE;
            var sum = vec3<f32>(0.0);
            for (var tap = 0u; tap < TAPS; tap++) {
                let i = start + tap;
                sum += WINDOW[tap] * vec3<f32>(wide_0[i], wide_1[i], wide_2[i]);
            }
            across[place] = vec4<f32>(sum, 0.0);
        }
        workgroupBarrier();
        var blurred = vec3<f32>(0.0);
        for (var tap = 0u; tap < TAPS; tap++) {
            blurred += WINDOW[tap] * across[thread + tap * TILE].xyz;
        }
        if (inside) {
            let values = compared(own_pixel, channel);
            let by_similarity = blurred.x
                + 2.0 * ((values.s - MIDDLE) * blurred.y + values.e * blurred.z);
            // The subgradient of |0| is 0.
            let by_l1 = training.l1_scale * sign(values.e);
            by_color[channel] = values.weight * (by_l1 - training.ssim_scale * by_similarity);
        }
    }
    if (inside) {
        let by_alpha = -dot(by_color, training.background.xyz);
        gradient[own_pixel] = vec4<f32>(by_color, by_alpha);
    }
}
