//! One splat on the image plane, in the form that the rasteriser reads.

use std::f32::consts::LOG2_E;

use crate::reference::{ALPHA_MIN, LOW_PASS};

/// A projected splat: one cache line.
///
/// The ellipse is kept as the Cholesky factor U of Σ'⁻¹·(log₂e / 2), so that
/// α = 2^(log₂ o − ‖U d‖²) with U = [[u11, u12], [0, u22]]. Compared with the conic form
/// `a dx² + 2b dx dy + c dy²` it costs the same per pixel and does not cancel: for a needle across
/// the screen the conic's terms are 10⁶ times their sum, U's are not (docs/numerics.md).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct ProjectedSplat {
    /// Centre, pixels.
    pub x: f32,
    /// Centre, pixels.
    pub y: f32,
    /// U row 1, column 1, 1/px.
    pub u11: f32,
    /// U row 1, column 2, 1/px.
    pub u12: f32,
    /// U row 2, column 2, 1/px.
    pub u22: f32,
    /// log₂ of the opacity.
    pub log2_opacity: f32,
    /// r g b.
    pub color: [f32; 3],
    /// View z, world units.
    pub depth: f32,
    /// What `depth` lost to rounding: depth + depth_low is z to 48 bits. Near-ties are ordered by
    /// it as the reference orders them.
    pub depth_low: f32,
    /// Half the width of the box around α = 1/255, pixels.
    pub half_width: f32,
    /// Half the height of that box, pixels.
    pub half_height: f32,
    /// Index of the splat in the scene.
    pub index: u32,
}

/// log₂ (1/255): α ≥ 1/255 ⇔ log₂ o − ‖U d‖² ≥ log₂ (1/255).
pub(crate) const LOG2_ALPHA_MIN: f32 = -7.994_353_4;

impl ProjectedSplat {
    /// Builds the ellipse from the rows of M = J W R S (pixels), so that Σ' = M Mᵀ + 0.3 I.
    ///
    /// `None` when the opacity never reaches 1/255 or something is not finite.
    #[must_use]
    #[inline(always)]
    pub fn from_factor(centre: [f32; 2], mx: [f32; 3], my: [f32; 3], opacity: f32) -> Option<Self> {
        // A comparison that is false for NaN.
        if !(opacity >= ALPHA_MIN as f32) {
            return None;
        }
        let low_pass = LOW_PASS as f32;
        let xx = dot(mx, mx);
        let yy = dot(my, my);
        // Variance along y, and along x where y is given: |Σ'| / Σ'yy. The determinant of
        // M Mᵀ + λI is the sum of the squared 2×2 minors of M, λ tr(M Mᵀ) and λ² (Cauchy–Binet),
        // all positive; dividing the minors by √Σ'yy first keeps the squares inside f32.
        let inverse_deviation_y = 1.0 / (yy + low_pass).sqrt();
        let minors = [
            (mx[1] * my[2] - mx[2] * my[1]) * inverse_deviation_y,
            (mx[2] * my[0] - mx[0] * my[2]) * inverse_deviation_y,
            (mx[0] * my[1] - mx[1] * my[0]) * inverse_deviation_y,
        ];
        let rest = (low_pass * inverse_deviation_y) * ((xx + yy + low_pass) * inverse_deviation_y);
        let inverse_deviation_x = 1.0 / (dot(minors, minors) + rest).sqrt();
        let slope = (dot(mx, my) * inverse_deviation_y) * inverse_deviation_y;

        let scale = (0.5 * LOG2_E).sqrt();
        let log2_opacity = opacity.log2();
        // The opacity is at least 1/255, so this is ≥ 0 up to rounding.
        let reach = (log2_opacity - LOG2_ALPHA_MIN).max(0.0).sqrt() / scale;
        let splat = Self {
            x: centre[0],
            y: centre[1],
            u11: inverse_deviation_x * scale,
            u12: -slope * inverse_deviation_x * scale,
            u22: inverse_deviation_y * scale,
            log2_opacity,
            half_width: reach * (xx + low_pass).sqrt(),
            half_height: reach * (yy + low_pass).sqrt(),
            ..Self::default()
        };
        let sum = splat.x + splat.y + splat.u11 + splat.u12 + splat.half_width + splat.half_height;
        sum.is_finite().then_some(splat)
    }

    /// The ellipse α = 1/255, prepared for cutting it with strips.
    #[must_use]
    #[inline(always)]
    pub fn outline(&self) -> Outline {
        let slope = -self.u12 / self.u11;
        let cutoff = (self.log2_opacity - LOG2_ALPHA_MIN).max(0.0);
        let slope_u22 = slope * self.u11 / self.u22;
        Outline {
            x: self.x,
            y: self.y,
            half_height: self.half_height,
            slope,
            inverse_u11: 1.0 / self.u11,
            u22: self.u22,
            cutoff,
            right_end: slope_u22 * cutoff.sqrt()
                / (self.u22 * (1.0 + slope_u22 * slope_u22).sqrt()),
        }
    }
}

/// The ellipse α = 1/255 of a projected splat: at height dy above its centre it reaches from
/// slope·dy − w to slope·dy + w, w = √(cutoff − (u22 dy)²) / u11.
#[derive(Clone, Copy, Debug)]
pub struct Outline {
    x: f32,
    y: f32,
    half_height: f32,
    slope: f32,
    inverse_u11: f32,
    u22: f32,
    /// ‖U d‖² on the ellipse.
    cutoff: f32,
    /// dy of its rightmost point; the leftmost mirrors it.
    right_end: f32,
}

impl Outline {
    /// Interval of x in which the ellipse meets the strip `y_min ≤ y ≤ y_max`, pixels; `None` when
    /// it does not.
    ///
    /// The extremes are at the ellipse's own left and right ends if those lie inside the strip,
    /// else at the nearer edge: the ellipse is convex.
    #[must_use]
    #[inline(always)]
    pub fn x_interval(&self, y_min: f32, y_max: f32) -> Option<(f32, f32)> {
        let low = (y_min - self.y).max(-self.half_height);
        let high = (y_max - self.y).min(self.half_height);
        if low > high {
            return None;
        }
        let half_width = |dy: f32| {
            let v = self.u22 * dy;
            (self.cutoff - v * v).max(0.0).sqrt() * self.inverse_u11
        };
        let at_right = self.right_end.clamp(low, high);
        let at_left = (-self.right_end).clamp(low, high);
        let left = self.x + self.slope * at_left - half_width(at_left);
        let right = self.x + self.slope * at_right + half_width(at_right);
        Some((left, right))
    }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn alpha(splat: &ProjectedSplat, x: f32, y: f32) -> f64 {
        let (dx, dy) = (f64::from(x - splat.x), f64::from(y - splat.y));
        let v1 = f64::from(splat.u11) * dx + f64::from(splat.u12) * dy;
        let v2 = f64::from(splat.u22) * dy;
        (f64::from(splat.log2_opacity) - v1 * v1 - v2 * v2).exp2()
    }

    prop_compose! {
        fn any_factor()(m in prop::array::uniform6(-30.0f32..30.0)) -> ([f32; 3], [f32; 3]) {
            ([m[0], m[1], m[2]], [m[3], m[4], m[5]])
        }
    }

    proptest! {
        #[test]
        fn the_factor_is_that_of_the_inverse_covariance((mx, my) in any_factor(), dx in -20.0f64..20.0, dy in -20.0f64..20.0) {
            let splat = ProjectedSplat::from_factor([0.0; 2], mx, my, 1.0).unwrap();
            let (mx, my) = (mx.map(f64::from), my.map(f64::from));
            let d = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let (xx, xy, yy) = (d(mx, mx) + LOW_PASS, d(mx, my), d(my, my) + LOW_PASS);
            let det = xx * yy - xy * xy;
            let power = 0.5 * (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / det;
            let v1 = f64::from(splat.u11) * dx + f64::from(splat.u12) * dy;
            let v2 = f64::from(splat.u22) * dy;
            let ours = (v1 * v1 + v2 * v2) / std::f64::consts::LOG2_E;
            // v1 is a difference of two terms, each exact to a few ε; its absolute error is a few
            // ε of the larger term and enters the power twice over.
            let v1_error = 8.0 * f64::from(f32::EPSILON) * ((f64::from(splat.u11) * dx).abs() + (f64::from(splat.u12) * dy).abs());
            let tolerance = 2.0 * v1.abs() * v1_error + v1_error * v1_error + 1e-5 * power + 1e-6;
            prop_assert!((ours - power).abs() <= tolerance, "{} {} (tolerance {})", ours, power, tolerance);
        }

        #[test]
        fn the_interval_holds_every_visible_point_of_the_strip_and_touches_it(
            (mx, my) in any_factor(), opacity in 0.01f32..1.0, top in -60.0f32..60.0, height in 0.0f32..15.0,
        ) {
            let splat = ProjectedSplat::from_factor([3.0, -2.0], mx, my, opacity).unwrap();
            let visible = |x: f32, y: f32| alpha(&splat, x, y) >= ALPHA_MIN * (1.0 + 1e-4);
            match splat.outline().x_interval(top, top + height) {
                None => for i in 0..200 {
                    prop_assert!(!visible(splat.x - 100.0 + i as f32, top + height * 0.5));
                },
                Some((left, right)) => {
                    for row in 0..=10 {
                        let y = top + height * row as f32 / 10.0;
                        for i in 1..200 {
                            prop_assert!(!visible(left - 0.05 * i as f32, y));
                            prop_assert!(!visible(right + 0.05 * i as f32, y));
                        }
                    }
                    // Exact, not merely safe: both ends are on the ellipse.
                    let slack = 1e-3 * (right - left).abs().max(1.0);
                    let touches = |x: f32| (0..=1000).any(|i| {
                        alpha(&splat, x, top + height * i as f32 / 1000.0) >= ALPHA_MIN * 0.9
                    });
                    prop_assert!(touches(left + slack) && touches(right - slack));
                }
            }
        }
    }

    #[test]
    fn a_needle_keeps_its_width_where_a_covariance_would_lose_it() {
        // 1000 px long, 10⁻³ px wide, at 45°: |Σ'| from Σ' in f32 would be off by several percent.
        let (long, thin) = (1000.0, 1e-3);
        let h = std::f32::consts::FRAC_1_SQRT_2;
        let splat = ProjectedSplat::from_factor(
            [0.0; 2],
            [long * h, -thin * h, 0.0],
            [long * h, thin * h, 0.0],
            1.0,
        )
        .unwrap();
        // Across the needle the variance is thin² + 0.3, so α falls as exp(−d²/0.6).
        for d in [0.5f32, 1.0, 1.5] {
            let exact = (-f64::from(d * d) / (2.0 * (0.3 + 1e-6))).exp();
            assert!((alpha(&splat, d * h, -d * h) - exact).abs() < 1e-4);
        }
    }

    #[test]
    fn huge_factors_stay_finite_and_overflow_is_left_out() {
        let big = 2e17;
        let splat =
            ProjectedSplat::from_factor([0.0; 2], [big, big, 0.0], [0.0, big, big], 0.5).unwrap();
        assert!((alpha(&splat, 1e4, -1e4) - 0.5).abs() < 1e-6);
        assert!(ProjectedSplat::from_factor([0.0; 2], [f32::INFINITY; 3], [1.0; 3], 0.5).is_none());
        assert!(ProjectedSplat::from_factor([f32::NAN; 2], [1.0; 3], [1.0; 3], 0.5).is_none());
        assert!(ProjectedSplat::from_factor([0.0; 2], [1.0; 3], [1.0; 3], f32::NAN).is_none());
    }
}
