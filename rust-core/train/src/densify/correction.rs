//! What opacity and scale several coincident splats need to look like the one they came from.

/// Largest number of coincident splats that the correction is made for (Kheradmand et al. 2024).
pub const MAX_COPIES: u32 = 51;

/// Opacity and factor of the standard deviations of `copies` splats that replace one of `opacity`
/// in the same place ("3D Gaussian Splatting as Markov Chain Monte Carlo", eq. 9).
///
/// The new opacity o′ = 1 − (1 − o)^(1/N) keeps what the centre lets through. The scale keeps the
/// integral of the profile through the centre: one splat gives ∫ o·e^(−x²/2) dx = o·√(2π); N of
/// opacity o′ and scale 1 give ∫ 1 − (1 − o′e^(−x²/2))ᴺ dx, by the binomial theorem
/// √(2π)·Σⱼ C(N, j)·(−1)^(j+1)·o′ʲ/√j, so the scale is o divided by that sum. (The paper writes the
/// sum twice, over i ≤ N and k < i; Σᵢ C(i − 1, k) = C(N, k + 1) collapses it.)
///
/// The terms alternate and grow to (1 + o′)ᴺ, so the sum loses log₂(1 + o′)ᴺ bits: at most 11 of 53
/// for opacities up to 0.9999. Opacities outside (0, 1) are taken to the nearest inside.
#[must_use]
pub fn relocation_correction(opacity: f64, copies: u32) -> (f64, f64) {
    let n = copies.clamp(1, MAX_COPIES);
    // f32's next value below 1: what the opacity of a stored logit can be.
    let opacity = opacity.clamp(f64::MIN_POSITIVE, 1.0 - f64::from(f32::EPSILON));
    // 1 − (1 − o)^(1/N) without cancellation for small o.
    let new_opacity = -((-opacity).ln_1p() / f64::from(n)).exp_m1();
    let mut sum = 0.0;
    let mut term = 1.0; // C(N, j)·(−1)^(j+1)·o′ʲ, starting from −1 at j = 0.
    for j in 1..=n {
        let ratio = f64::from(n - j + 1) / f64::from(j) * new_opacity;
        term *= if j == 1 { ratio } else { -ratio };
        sum += term / f64::from(j).sqrt();
    }
    (new_opacity, opacity / sum)
}

/// The logit of an opacity in (0, 1).
#[must_use]
pub fn logit(opacity: f64) -> f64 {
    opacity.ln() - (-opacity).ln_1p()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The double sum of the paper, term by term.
    fn scale_of_the_paper(opacity: f64, new_opacity: f64, copies: u32) -> f64 {
        let binomial =
            |n: u32, k: u32| (1..=k).fold(1.0, |b, j| b * f64::from(n - j + 1) / f64::from(j));
        let mut sum = 0.0;
        for i in 1..=copies {
            for k in 0..i {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                let power = new_opacity.powi(k as i32 + 1);
                sum += binomial(i - 1, k) * sign * power / f64::from(k + 1).sqrt();
            }
        }
        opacity / sum
    }

    /// ∫ 1 − (1 − o·e^(−x²/2s²))ᴺ dx by the trapezoidal rule, which converges faster than any
    /// power on smooth functions that vanish at the ends.
    fn profile(opacity: f64, scale: f64, copies: u32) -> f64 {
        let step = scale / 64.0;
        (-64 * 12..=64 * 12)
            .map(|i| {
                let x = f64::from(i) * step;
                let alpha = opacity * (-0.5 * (x / scale).powi(2)).exp();
                step * (1.0 - (1.0 - alpha).powi(copies as i32))
            })
            .sum()
    }

    #[test]
    fn one_copy_is_left_as_it_is() {
        for opacity in [0.005, 0.3, 0.99] {
            let (o, scale) = relocation_correction(opacity, 1);
            assert!((o - opacity).abs() < 1e-15 && (scale - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn the_single_sum_equals_the_double_sum_of_the_paper() {
        for copies in [2, 3, 7, 20, 51] {
            for opacity in [0.005, 0.1, 0.5, 0.9, 0.99] {
                let (o, scale) = relocation_correction(opacity, copies);
                let expected = scale_of_the_paper(opacity, o, copies);
                // Both sums lose up to (1 + o′)ᴺ ≤ 70 ulp here.
                assert!((scale / expected - 1.0).abs() < 1e-12, "{copies} {opacity}");
            }
        }
    }

    #[test]
    fn extreme_opacities_have_finite_corrections() {
        for opacity in [f64::NEG_INFINITY, -1.0, 0.0, 1e-300, 1.0, 2.0] {
            for copies in [0, 1, 2, 51, u32::MAX] {
                let (o, scale) = relocation_correction(opacity, copies);
                assert!((0.0..1.0).contains(&o) && scale > 0.0 && scale.is_finite());
                assert!(scale <= 1.0 + 1e-9, "more splats are never larger: {scale}");
            }
        }
    }

    proptest! {
        #[test]
        fn coincident_copies_keep_the_centre_and_the_integrated_profile(
            opacity in 0.001f64..0.9999, copies in 1u32..=51,
        ) {
            let (o, scale) = relocation_correction(opacity, copies);
            let through = (1.0 - o).powi(copies as i32);
            prop_assert!((through - (1.0 - opacity)).abs() < 1e-12);
            let (one, many) = (profile(opacity, 1.0, 1), profile(o, scale, copies));
            // The sum's cancellation, 2⁻⁴² relative, and the profile's tails beyond 12 σ.
            prop_assert!((many / one - 1.0).abs() < 1e-9, "{one} {many}");
        }

        #[test]
        fn the_logit_is_the_inverse_of_the_sigmoid(opacity in 1e-6f64..0.999_999) {
            prop_assert!((trapeze_scene::sigmoid(logit(opacity)) - opacity).abs() < 1e-14);
        }
    }
}
