//! 2ˣ for the exponents that blending needs.

use fearless_simd::f32x16;
use fearless_simd::prelude::*;

/// 1.5·2²³: adding it leaves the nearest integer in the low bits of the sum.
const ROUND: f32 = 12_582_912.0;

/// Coefficients of 2ᶠ on [−½, ½], lowest first: the polynomial of degree 5 with the smallest
/// largest relative error, 7.5·10⁻⁸ (Remez exchange), about the rounding of f32.
const COEFFICIENTS: [f32; 6] =
    [1.000_000_1, 0.693_146_97, 0.240_221_2, 0.055_507_133, 0.009_675_541, 0.001_327_647_2];

/// 2ˣ for −100 ≤ x ≤ 100, with relative error below 4·10⁻⁷. Other x give any bits, no trap.
///
/// `N` vectors go through each step together, so that their chains of dependent operations overlap.
#[inline(always)]
pub(super) fn exp2<S: Simd, const N: usize>(simd: S, x: [f32x16<S>; N]) -> [f32x16<S>; N] {
    let mut shifted = x;
    let mut fraction = x;
    for i in 0..N {
        shifted[i] = x[i] + ROUND;
        fraction[i] = x[i] - (shifted[i] - ROUND);
    }
    let mut power = [f32x16::splat(simd, COEFFICIENTS[5]); N];
    for &coefficient in COEFFICIENTS[..5].iter().rev() {
        for i in 0..N {
            power[i] = power[i].mul_add(fraction[i], coefficient);
        }
    }
    // The low bits of `shifted` hold the integer part; shifted into the exponent field they scale
    // by its power of two. What ROUND itself puts there is shifted out.
    for i in 0..N {
        power[i] = f32x16::from_bits(power[i].to_bits() + (shifted[i].to_bits() << 23));
    }
    power
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    #[test]
    fn exponentials_are_exact_to_rounding() {
        for i in 0..2000 {
            let x: [f32; 16] = std::array::from_fn(|lane| -9.5 + (i * 16 + lane) as f32 * 3e-4);
            let ours: [f32; 16] = dispatch!(Level::new(), simd => exp2(simd, [f32x16::load_array(simd, x)])[0].to_array());
            for (a, x) in ours.into_iter().zip(x) {
                let exact = f64::from(x).exp2();
                assert!((f64::from(a) / exact - 1.0).abs() < 4e-7, "2^{x} = {a}, not {exact}");
            }
        }
    }
}
