// Random numbers addressed by (seed, purpose, step, index): the words that the CPU draws.
//
// Philox4x32-10 (Salmon et al. 2011); `rust-core/train/src/random` has the twin and its tests.
//
// Needs: common/exponential.

const PURPOSE_NOISE: u32 = 3u;
const PURPOSE_RELOCATION: u32 = 4u;
const PURPOSE_GROWTH: u32 = 5u;

/// High word of a 64-bit product: WGSL has no 64-bit integers.
fn multiply_high(a: u32, b: u32) -> u32 {
    let a_low = a & 0xffffu;
    let a_high = a >> 16u;
    let b_low = b & 0xffffu;
    let b_high = b >> 16u;
    let first = a_high * b_low + ((a_low * b_low) >> 16u);
    let second = a_low * b_high + (first & 0xffffu);
    return a_high * b_high + (first >> 16u) + (second >> 16u);
}

/// Four random words for `index`.
fn random_words(seed: vec2<u32>, purpose: u32, step: u32, index: u32) -> vec4<u32> {
    var counter = vec4<u32>(index, 0u, step, purpose);
    var key = seed;
    for (var round = 0u; round < 10u; round++) {
        counter = vec4<u32>(
            multiply_high(0xcd9e8d57u, counter.z) ^ counter.y ^ key.x,
            0xcd9e8d57u * counter.z,
            multiply_high(0xd2511f53u, counter.x) ^ counter.w ^ key.y,
            0xd2511f53u * counter.x,
        );
        key += vec2<u32>(0x9e3779b9u, 0xbb67ae85u);
    }
    return counter;
}

/// A standard normal number from a word, by the inverse of the cumulative distribution (Giles 2011;
/// the CPU's twin says how it was fitted).
fn normal_number(word: u32) -> f32 {
    let upper = (word >> 31u) == 1u;
    let k = select(word, ~word, upper);
    let p = (f32(k) + 0.5) * (1.0 / 4294967296.0);
    let w = -natural_log(4.0 * p * (1.0 - p));
    var ratio = 0.0;
    if (w < 5.0) {
        let x = w - 2.5;
        ratio = 2.8102264e-8;
        ratio = ratio * x + 3.4327394e-7;
        ratio = ratio * x - 3.5233877e-6;
        ratio = ratio * x - 4.3915065e-6;
        ratio = ratio * x + 0.00021858087;
        ratio = ratio * x - 0.0012537251;
        ratio = ratio * x - 0.0041776816;
        ratio = ratio * x + 0.24664073;
        ratio = ratio * x + 1.5014094;
    } else {
        let x = sqrt(w) - 3.4;
        ratio = 4.827362e-6;
        ratio = ratio * x - 0.00018134433;
        ratio = ratio * x + 0.0006654724;
        ratio = ratio * x - 0.0011195377;
        ratio = ratio * x + 0.0014981556;
        ratio = ratio * x - 0.0025249583;
        ratio = ratio * x + 0.003966079;
        ratio = ratio * x + 1.0066411;
        ratio = ratio * x + 3.234784;
    }
    let magnitude = 1.4142135 * ratio * (1.0 - 2.0 * p);
    return select(-magnitude, magnitude, upper);
}
