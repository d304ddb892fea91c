//! Lens distortion: from the direction of a ray to where the lens puts it, and back.

use glam::{DVec2, dvec2};

/// How a lens departs from a pinhole, as COLMAP and OpenCV parametrise it.
///
/// Coordinates are normalised: (x, y) = (X/Z, Y/Z) of a point in camera space. A pinhole camera
/// sees it at (fx·x + cx, fy·y + cy); a real lens at the same place of the distorted (x, y).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Distortion {
    /// A pinhole.
    #[default]
    None,
    /// Brown–Conrady: with r² = x² + y²,
    /// x' = x·(1 + k₁r² + k₂r⁴ + k₃r⁶) + 2p₁xy + p₂(r² + 2x²),
    /// y' = y·(1 + k₁r² + k₂r⁴ + k₃r⁶) + p₁(r² + 2y²) + 2p₂xy.
    Perspective {
        /// k₁, k₂, k₃.
        radial: [f64; 3],
        /// p₁, p₂.
        tangential: [f64; 2],
    },
    /// Kannala–Brandt (OpenCV's fisheye): with θ = atan r,
    /// (x', y') = (x, y)/r · θ·(1 + k₁θ² + k₂θ⁴ + k₃θ⁶ + k₄θ⁸).
    Fisheye {
        /// k₁, k₂, k₃, k₄.
        radial: [f64; 4],
    },
}

impl Distortion {
    /// The perspective model, or no distortion where all its coefficients are zero.
    #[must_use]
    pub fn perspective(radial: [f64; 3], tangential: [f64; 2]) -> Self {
        if radial.iter().chain(&tangential).all(|&c| c == 0.0) {
            Self::None
        } else {
            Self::Perspective { radial, tangential }
        }
    }

    /// Whether every coefficient is a finite number.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        match self {
            Self::None => true,
            Self::Perspective { radial, tangential } => {
                radial.iter().chain(tangential).all(|c| c.is_finite())
            }
            Self::Fisheye { radial } => radial.iter().all(|c| c.is_finite()),
        }
    }

    /// Distorted radius of a ray at angle `theta` to the optical axis, tangential terms left out.
    fn distorted_radius(&self, theta: f64) -> f64 {
        match self {
            Self::None => theta.tan(),
            Self::Perspective { radial, .. } => {
                let r = theta.tan();
                r * even_polynomial(radial, r)
            }
            Self::Fisheye { radial } => theta * even_polynomial(radial, theta),
        }
    }

    fn tangential_shift(&self, p: DVec2) -> DVec2 {
        let Self::Perspective { tangential: [p1, p2], .. } = *self else { return DVec2::ZERO };
        let r2 = p.length_squared();
        dvec2(
            2.0 * p1 * p.x * p.y + p2 * (r2 + 2.0 * p.x * p.x),
            p1 * (r2 + 2.0 * p.y * p.y) + 2.0 * p2 * p.x * p.y,
        )
    }
}

/// 1 + k₁t² + k₂t⁴ + …
fn even_polynomial(coefficients: &[f64], t: f64) -> f64 {
    let t2 = t * t;
    1.0 + coefficients.iter().rev().fold(0.0, |sum, k| (sum + k) * t2)
}

/// A distortion with the field of view over which it can be inverted.
///
/// The polynomials are fitted inside the photograph; farther out they turn back, and a pixel there
/// would show a second image of the centre. Nothing beyond that angle is used.
#[derive(Clone, Debug)]
pub struct Lens {
    distortion: Distortion,
    /// Largest angle to the optical axis, in radians.
    max_theta: f64,
    /// `max_theta` as a normalised radius, and its image under the distortion.
    max_radius: f64,
    max_distorted_radius: f64,
}

/// Steps in which the usable angle is looked for: 0.1°.
const ANGLE_STEPS: u32 = 900;

impl Lens {
    /// Finds the angle up to which the distorted radius grows.
    #[must_use]
    pub fn new(distortion: Distortion) -> Self {
        let angle =
            |step: u32| f64::from(step) / f64::from(ANGLE_STEPS) * std::f64::consts::FRAC_PI_2;
        // The last step, 90°, is no direction that a pinhole sees.
        let grows = |&step: &u32| {
            let here = distortion.distorted_radius(angle(step));
            here.is_finite() && here > distortion.distorted_radius(angle(step - 1))
        };
        let max_theta = angle((1..ANGLE_STEPS).take_while(grows).last().unwrap_or(0));
        Self {
            distortion,
            max_theta,
            max_radius: max_theta.tan(),
            max_distorted_radius: distortion.distorted_radius(max_theta),
        }
    }

    /// Where the lens puts a ray, in normalised coordinates; `None` outside its field of view.
    #[must_use]
    pub fn distort(&self, ideal: DVec2) -> Option<DVec2> {
        let r = ideal.length();
        if !(0.0..=self.max_radius).contains(&r) {
            return None;
        }
        let scale = match &self.distortion {
            Distortion::None => return Some(ideal),
            Distortion::Perspective { radial, .. } => even_polynomial(radial, r),
            // θ/r → 1 on the axis.
            Distortion::Fisheye { .. } if r < 1e-9 => 1.0,
            Distortion::Fisheye { .. } => self.distortion.distorted_radius(r.atan()) / r,
        };
        Some(ideal * scale + self.distortion.tangential_shift(ideal))
    }

    /// The ray that the lens puts at a point: the inverse of [`distort`](Self::distort). `None`
    /// for points that no ray of its field of view reaches.
    ///
    /// The tangential shift is found by fixed-point iteration (it is a small fraction of the
    /// radius in any real lens), the radial part by bisection, which cannot leave the field of
    /// view.
    #[must_use]
    pub fn undistort(&self, distorted: DVec2) -> Option<DVec2> {
        const ITERATIONS: usize = 100;
        const TOLERANCE: f64 = 1e-13;
        let mut ideal = self.undistort_radially(distorted)?;
        for _ in 0..ITERATIONS {
            let shift = self.distortion.tangential_shift(ideal);
            let next = self.undistort_radially(distorted - shift)?;
            let change = (next - ideal).length();
            ideal = next;
            if change <= TOLERANCE * (1.0 + ideal.length()) {
                return Some(ideal);
            }
        }
        None
    }

    fn undistort_radially(&self, distorted: DVec2) -> Option<DVec2> {
        let target = distorted.length();
        if !(0.0..=self.max_distorted_radius).contains(&target) {
            return None;
        }
        if target == 0.0 {
            return Some(DVec2::ZERO);
        }
        let (mut low, mut high) = (0.0, self.max_theta);
        // Each step halves an interval of at most π/2: 60 reach double precision.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.distortion.distorted_radius(middle) < target {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(distorted * ((0.5 * (low + high)).tan() / target))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Coefficients up to those of an action camera; every model, by index.
    fn distortions() -> impl Strategy<Value = Distortion> {
        let k = -0.2..0.2f64;
        let p = -0.005..0.005f64;
        prop_oneof![
            Just(Distortion::None),
            k.clone().prop_map(|k1| Distortion::perspective([k1, 0.0, 0.0], [0.0; 2])),
            (k.clone(), k.clone())
                .prop_map(|(k1, k2)| Distortion::perspective([k1, k2, 0.0], [0.0; 2])),
            (k.clone(), k.clone(), k.clone(), p.clone(), p)
                .prop_map(|(k1, k2, k3, p1, p2)| Distortion::perspective([k1, k2, k3], [p1, p2])),
            [k.clone(), k.clone(), k.clone(), k]
                .prop_map(|radial| Distortion::Fisheye { radial: radial.map(|k| k * 0.2) }),
        ]
    }

    proptest! {
        // The bisection finds θ to 2⁻⁶⁰·π/2; what is left is rounding, amplified by at most the
        // inverse slope of the distortion. Points where the slope is below 0.05 (the rim of the
        // field of view) are left out by staying at 80 % of its angle.
        #[test]
        fn undistort_inverts_distort_for_every_model(
            distortion in distortions(),
            angle in 0.0..0.8f64,
            direction in 0.0..std::f64::consts::TAU,
        ) {
            let lens = Lens::new(distortion);
            let theta = angle * lens.max_theta.min(1.2);
            let ideal = DVec2::from_angle(direction) * theta.tan();
            let distorted = lens.distort(ideal).unwrap();
            let back = lens.undistort(distorted).unwrap();
            prop_assert!((back - ideal).length() <= 1e-10 * (1.0 + ideal.length()), "{back} {ideal}");
        }
    }

    #[test]
    fn the_models_follow_opencv_at_a_worked_point() {
        // x = 0.3, y = −0.2: r² = 0.13. Perspective with k = (0.1, −0.05, 0.02), p = (0.01, −0.02):
        // radial 1 + 0.013 − 0.000845 + 0.00004394 = 1.01219894.
        let lens = Lens::new(Distortion::Perspective {
            radial: [0.1, -0.05, 0.02],
            tangential: [0.01, -0.02],
        });
        let p = lens.distort(dvec2(0.3, -0.2)).unwrap();
        let x = 0.3 * 1.01219894 + 2.0 * 0.01 * 0.3 * -0.2 - 0.02 * (0.13 + 2.0 * 0.09);
        let y = -0.2 * 1.01219894 + 0.01 * (0.13 + 2.0 * 0.04) + 2.0 * -0.02 * 0.3 * -0.2;
        assert!((p - dvec2(x, y)).length() < 1e-15, "{p}");
        // An ideal equidistant fisheye puts a ray at 45° at radius π/4.
        let lens = Lens::new(Distortion::Fisheye { radial: [0.0; 4] });
        let p = lens.distort(dvec2(0.0, 1.0)).unwrap();
        assert!((p - dvec2(0.0, std::f64::consts::FRAC_PI_4)).length() < 1e-15, "{p}");
    }

    #[test]
    fn rays_beyond_the_turning_point_of_the_polynomial_are_outside_the_field_of_view() {
        // r(1 − 0.2r²) has its maximum at r² = 1/0.6.
        let lens = Lens::new(Distortion::perspective([-0.2, 0.0, 0.0], [0.0; 2]));
        let turn = (1.0f64 / 0.6).sqrt();
        assert!(lens.distort(dvec2(turn * 0.99, 0.0)).is_some());
        assert!(lens.distort(dvec2(0.0, turn * 1.01)).is_none());
        assert!(lens.undistort(dvec2(0.9, 0.0)).is_none(), "beyond the largest image radius");
    }

    #[test]
    fn hostile_coefficients_give_an_empty_field_of_view_and_no_panic() {
        for radial in [[f64::NAN, 0.0, 0.0], [f64::INFINITY; 3], [-1e300, 1e300, 0.0]] {
            let lens = Lens::new(Distortion::Perspective { radial, tangential: [0.0; 2] });
            assert!(lens.distort(dvec2(0.5, 0.5)).is_none());
            assert!(lens.undistort(dvec2(0.5, 0.5)).is_none());
        }
        assert!(Lens::new(Distortion::None).distort(dvec2(f64::NAN, 0.0)).is_none());
    }
}
