//! Standard normal numbers from random words, by the inverse of the cumulative distribution.
//!
//! One word gives one number, without rejection, without trigonometry and without a table, and
//! every operation is an IEEE addition, multiplication, division or square root, so that the
//! result is the same on every processor, in SIMD and in scalar code. A shader computes the same
//! up to the rounding of its own multiply-adds.

use std::f32::consts::{LN_2, SQRT_2};

/// A standard normal number; the word 2³² − 1 − w gives the negative of what w gives.
///
/// With p = (k + ½)·2⁻³² the smaller tail probability, z = √2·erf⁻¹(1 − 2p) in the form of Giles,
/// "Approximating the erfinv function" (GPU Computing Gems 2, 2011): a polynomial in
/// w = −ln(4p(1 − p)) below 5 and one in √w above. Taken of p itself the logarithm keeps its
/// precision for small p, so the tails reach |z| = 6.34 (p = 2⁻³³), beyond the range that Giles
/// fitted in single precision; the tail polynomial interpolates erf⁻¹(x)/x at the nine Chebyshev
/// nodes of √5 ≤ √w ≤ 4.66 instead. |Δz| ≤ 5e-6 against the exact inverse, as the tests check.
#[inline]
#[must_use]
pub fn normal(word: u32) -> f32 {
    // The top bit is the sign; the lower half of the words counts up from the lower tail.
    let upper = word >> 31 == 1;
    let k = if upper { !word } else { word };
    let p = (k as f32 + 0.5) * (1.0 / 4_294_967_296.0);
    let x = 1.0 - 2.0 * p;
    let magnitude = SQRT_2 * inverse_error_function_ratio(-natural_log(4.0 * p * (1.0 - p))) * x;
    if upper { magnitude } else { -magnitude }
}

/// erf⁻¹(x) / x as a function of w = −ln(1 − x²).
#[inline]
fn inverse_error_function_ratio(w: f32) -> f32 {
    const CENTRE: [f32; 9] = [
        2.810_226_4e-8,
        3.432_739_4e-7,
        -3.523_387_7e-6,
        -4.391_506_5e-6,
        0.000_218_580_87,
        -0.001_253_725_1,
        -0.004_177_681_6,
        0.246_640_73,
        1.501_409_4,
    ];
    const TAIL: [f32; 9] = [
        4.827_362e-6,
        -0.000_181_344_33,
        0.000_665_472_4,
        -0.001_119_537_7,
        0.001_498_155_6,
        -0.002_524_958_3,
        0.003_966_079,
        1.006_641_1,
        3.234_784,
    ];
    // Both sides are evaluated and one is chosen: no branch, so the loop over splats vectorises.
    let centre = polynomial(&CENTRE, w - 2.5);
    let tail = polynomial(&TAIL, w.max(0.0).sqrt() - 3.4);
    if w < 5.0 { centre } else { tail }
}

#[inline]
fn polynomial(coefficients: &[f32; 9], x: f32) -> f32 {
    coefficients[1..].iter().fold(coefficients[0], |sum, c| sum * x + c)
}

/// ln x for positive normal x: exponent bits, and atanh's series on the mantissa in [√½, √2).
/// Truncation after s⁹ leaves less than 1e-9; what is left is the rounding of a few operations.
#[inline]
fn natural_log(x: f32) -> f32 {
    const SQRT_HALF_BITS: i32 = 0x3F35_04F3;
    let bits = x.to_bits() as i32;
    let exponent = (bits - SQRT_HALF_BITS) >> 23;
    let mantissa = f32::from_bits((bits - (exponent << 23)) as u32);
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    let series = 2.0 + s2 * (2.0 / 3.0 + s2 * (2.0 / 5.0 + s2 * (2.0 / 7.0 + s2 * (2.0 / 9.0))));
    exponent as f32 * LN_2 + s * series
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Words that cover both tails densely and the middle evenly.
    fn words() -> impl Iterator<Item = u32> {
        let middle = (0..100_000u32).map(|i| i * 42_949);
        let lower = (0..32).flat_map(|bit| (0..64).map(move |j| (1u32 << bit).wrapping_add(j)));
        middle.chain(lower).flat_map(|w| [w, !w])
    }

    #[test]
    fn the_inverse_cumulative_distribution_is_accurate_into_the_tails() {
        let mut worst: f64 = 0.0;
        for word in words() {
            let z = f64::from(normal(word));
            // Newton's correction at z: (Φ(−|z|) − p) / φ(z), exact to second order, with p the
            // tail probability of the word.
            let k = word.min(!word);
            let p = (f64::from(k) + 0.5) / 4_294_967_296.0;
            let tail = 0.5 * libm::erfc(z.abs() / std::f64::consts::SQRT_2);
            let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
            worst = worst.max(((tail - p) / density).abs());
        }
        // The fit leaves √2·1.5e-6 in the tail; rounding adds a few ulp (ε = 1.2e-7) of up to 6.
        assert!(worst <= 5e-6, "{worst:e}");
    }

    #[test]
    fn the_distribution_is_symmetric_and_grows_with_the_word() {
        for word in words() {
            assert_eq!(normal(word), -normal(!word));
        }
        for word in (0..100_000u32).map(|i| i * 42_949) {
            assert!(normal(word) < normal(word + 42_949), "{word}");
        }
        assert!(normal(0) < -6.3 && normal(u32::MAX) > 6.3);
    }

    #[test]
    fn the_logarithm_agrees_with_the_standard_library() {
        for i in 1..200_000 {
            let x = i as f32 / 100_000.0;
            let (found, exact) = (natural_log(x), f64::from(x).ln());
            let bound = 2.0 * f64::from(f32::EPSILON) * (1.0 + exact.abs());
            assert!((f64::from(found) - exact).abs() <= bound, "{x}: {found} {exact}");
        }
    }
}
