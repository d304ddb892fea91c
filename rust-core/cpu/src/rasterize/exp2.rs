//! 2ˣ for the exponents that blending needs.

use fearless_simd::f32x16;
use fearless_simd::prelude::*;

/// Coefficients of 2^(x/8) on [−8, 0], lowest first: the polynomial of degree 5 with the smallest
/// largest relative error, 7.5·10⁻⁸ (Remez exchange).
const COEFFICIENTS: [f32; 6] =
    [0.999_999_9, 0.086_642_78, 0.003_752_690_5, 0.000_107_968_21, 2.243_313_4e-6, 2.864_954_6e-8];

/// 2ˣ for −8 ≤ x ≤ 0, the exponents of a visible splat (−log₂ 255 … 0), with relative error below
/// 2·10⁻⁶: 2^(x/8), squared three times, which also multiplies its relative error by eight. Below
/// −8 it returns any number, without a trap; blending leaves those lanes out.
///
/// `N` vectors go through each step together, so that their chains of dependent operations overlap.
#[inline(always)]
pub(crate) fn exp2<S: Simd, const N: usize>(simd: S, x: [f32x16<S>; N]) -> [f32x16<S>; N] {
    let mut power = [f32x16::splat(simd, COEFFICIENTS[5]); N];
    for &coefficient in COEFFICIENTS[..5].iter().rev() {
        for i in 0..N {
            power[i] = power[i].mul_add(x[i], coefficient);
        }
    }
    for _ in 0..3 {
        for i in 0..N {
            power[i] = power[i] * power[i];
        }
    }
    power
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    #[test]
    fn exponentials_are_exact_to_a_few_roundings() {
        for i in 0..2000 {
            let x: [f32; 16] = std::array::from_fn(|lane| -8.0 + (i * 16 + lane) as f32 * 2.5e-4);
            let ours: [f32; 16] = dispatch!(Level::new(), simd => exp2(simd, [f32x16::load_array(simd, x)])[0].to_array());
            for (a, x) in ours.into_iter().zip(x) {
                let exact = f64::from(x).exp2();
                assert!((f64::from(a) / exact - 1.0).abs() < 2e-6, "2^{x} = {a}, not {exact}");
            }
        }
    }
}
