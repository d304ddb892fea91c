//! e^x and the logistic function in single precision, for loops that the compiler vectorises.
//!
//! The standard library's `exp` is a call per number. These are additions, multiplications and bit
//! moves in a fixed order, so they vectorise and give the same bits at every vector width.

use std::f32::consts::LOG2_E;

/// e^x within 2 ulp for |x| ≤ 87, saturating to 1.6e-38 and 1.7e38 beyond; NaN stays NaN.
///
/// x = n·ln 2 + r with |r| ≤ ½ ln 2, ln 2 in two parts (Cody and Waite 1980), and the degree-7
/// Taylor polynomial of e^r, whose truncation is below 1e-8.
#[inline(always)]
pub(crate) fn exp(x: f32) -> f32 {
    const LN_2_HIGH: f32 = 0.693_359_4;
    const LN_2_LOW: f32 = -2.121_944_4e-4;
    /// Adding and subtracting 1.5·2²³ rounds to an integer without an instruction for it.
    const ROUND: f32 = 12_582_912.0;
    let x = x.clamp(-87.0, 88.0);
    let n = (x * LOG2_E + ROUND) - ROUND;
    let r = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    let series =
        1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0))));
    let mantissa = 1.0 + r + r * r * (0.5 + r * series);
    // 2ⁿ from its bits; n is an integer of at most 8 bits, so the conversion is exact.
    mantissa * f32::from_bits(((n as i32 + 127) << 23) as u32)
}

/// 1 / (1 + e⁻ˣ), relatively accurate to a few ulp; NaN stays NaN.
#[inline(always)]
pub(crate) fn sigmoid(x: f32) -> f32 {
    let e = exp(-x.abs());
    let smaller = e / (1.0 + e);
    let larger = 1.0 / (1.0 + e);
    if x < 0.0 { smaller } else { larger }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments() -> impl Iterator<Item = f32> {
        (-869_999..=869_999).step_by(7).map(|i| i as f32 * 1e-4)
    }

    #[test]
    fn exp_and_sigmoid_are_accurate_to_a_few_ulp() {
        for x in arguments() {
            let exact = f64::from(x).exp();
            let error = (f64::from(exp(x)) / exact - 1.0).abs();
            assert!(error <= 2.0 * f64::from(f32::EPSILON), "exp({x}): {error:e}");
            let exact = trapeze_scene::sigmoid(f64::from(x));
            let error = (f64::from(sigmoid(x)) / exact - 1.0).abs();
            assert!(error <= 4.0 * f64::from(f32::EPSILON), "sigmoid({x}): {error:e}");
        }
    }

    #[test]
    fn limits_are_finite_and_nan_stays_nan() {
        for x in [f32::INFINITY, 1e4] {
            assert!(exp(x).is_finite() && exp(x) > 1e38);
            assert!(exp(-x) < 1.7e-38);
            assert_eq!(sigmoid(x), 1.0);
            assert!(sigmoid(-x) < 1.7e-38);
        }
        assert!(exp(f32::NAN).is_nan() && sigmoid(f32::NAN).is_nan());
        assert_eq!(exp(0.0), 1.0);
    }
}
