//! Colours and opacities in eight bits, as compact splat formats store them.

use trapeze_scene::{SH_C0, sigmoid};

/// Band-0 coefficient of a display colour; 0.5 is grey (Kerbl et al. 2023).
pub(crate) fn sh_dc_of_color(color: f64) -> f32 {
    ((color - 0.5) / SH_C0) as f32
}

/// Display colour of a band-0 coefficient. Not clamped: colours outside 0–1 are legal.
pub(crate) fn color_of_sh_dc(sh_dc: f32) -> f64 {
    f64::from(sh_dc) * SH_C0 + 0.5
}

/// The nearest of 256 levels from 0 to 1. NaN gives 0.
pub(crate) fn byte_of_unit(value: f64) -> u8 {
    // The cast saturates, and takes NaN to 0.
    (value * 255.0).round() as u8
}

/// Opacity logit of an eight-bit opacity.
///
/// 0 and 255 stand for all opacities that round to them, and get the middle of that interval
/// instead of an infinite logit: finite for the optimiser, and the same image (opacities below
/// 1/255 are not drawn, those above 0.99 are clamped).
pub(crate) fn logit_of_byte(alpha: u8) -> f32 {
    let opacity = match alpha {
        0 => 0.25 / 255.0,
        255 => 1.0 - 0.25 / 255.0,
        _ => f64::from(alpha) / 255.0,
    };
    (opacity / (1.0 - opacity)).ln() as f32
}

/// The nearest eight-bit opacity.
pub(crate) fn byte_of_logit(logit: f32) -> u8 {
    byte_of_unit(sigmoid(f64::from(logit)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_opacity_and_colour_survives_a_round_trip_and_is_finite() {
        for byte in 0..=255u8 {
            let logit = logit_of_byte(byte);
            assert!(logit.is_finite());
            assert_eq!(byte_of_logit(logit), byte);
            let color = f64::from(byte) / 255.0;
            assert_eq!(byte_of_unit(color_of_sh_dc(sh_dc_of_color(color))), byte);
        }
    }

    #[test]
    fn values_that_are_not_finite_have_a_byte() {
        assert_eq!(byte_of_logit(f32::INFINITY), 255);
        assert_eq!(byte_of_logit(f32::NAN), 0);
        assert_eq!(byte_of_unit(f64::NAN), 0);
        assert_eq!(byte_of_unit(-3.0), 0);
        assert_eq!(byte_of_unit(f64::INFINITY), 255);
    }
}
