//! From a splat in the world to an ellipse on the image.

use glam::{DMat3, DVec2, DVec3};
use trapeze_scene::Camera;

use super::PosedSplat;

/// Splats nearer than this (view z, world units) are not drawn.
pub const NEAR_PLANE: f64 = 0.01;
/// Added to both variances, px²: every splat covers at least about a pixel (Kerbl et al. 2023).
pub const LOW_PASS: f64 = 0.3;
/// Contributions below this are skipped.
pub const ALPHA_MIN: f64 = 1.0 / 255.0;
/// α never exceeds this, so that 1 − α can be divided by.
pub const ALPHA_MAX: f64 = 0.99;
/// A blend that would leave less transmittance than this ends the pixel.
pub const TRANSMITTANCE_MIN: f64 = 1e-4;
/// How far outside the image, in half image widths at unit depth, the Jacobian still follows x/z.
pub const JACOBIAN_MARGIN: f64 = 0.3;

/// A splat on the image plane.
#[derive(Clone, Copy, Debug)]
pub struct ProjectedSplat {
    /// Index of the splat in the scene.
    pub index: u32,
    /// View z, world units.
    pub depth: f64,
    /// Centre in pixels; pixel (i, j) has its centre at (i + 0.5, j + 0.5).
    pub centre: DVec2,
    /// Σ' in px²: xx, xy, yy, low-pass included.
    pub covariance: [f64; 3],
    /// Σ'⁻¹: xx, xy, yy.
    pub conic: [f64; 3],
    /// o, 0–1.
    pub opacity: f64,
    /// r g b.
    pub color: DVec3,
}

impl ProjectedSplat {
    /// α before the threshold: min(0.99, o·exp(−½ dᵀΣ'⁻¹d)) at a point of the image.
    #[must_use]
    pub fn alpha(&self, point: DVec2) -> f64 {
        let d = point - self.centre;
        let [xx, xy, yy] = self.conic;
        let power = -0.5 * (xx * d.x * d.x + 2.0 * xy * d.x * d.y + yy * d.y * d.y);
        (self.opacity * power.exp()).min(ALPHA_MAX)
    }

    /// Half the size of the box around the ellipse α = 1/255, in pixels.
    #[must_use]
    pub fn half_extent(&self) -> DVec2 {
        // o·exp(−½q) = 1/255  ⇔  q = 2 ln(255 o); the box of dᵀΣ'⁻¹d = q is √(q Σ'ᵢᵢ).
        let cutoff = (2.0 * (self.opacity / ALPHA_MIN).ln()).max(0.0);
        DVec2::new((cutoff * self.covariance[0]).sqrt(), (cutoff * self.covariance[2]).sqrt())
    }
}

/// The camera, prepared for projecting.
#[derive(Clone, Debug)]
pub struct Projection {
    pub(super) camera: Camera,
    pub(super) rotation: DMat3,
    pub(super) centre: DVec3,
    pub(super) slope_min: DVec2,
    pub(super) slope_max: DVec2,
}

impl Projection {
    /// Prepares a camera.
    #[must_use]
    pub fn new(camera: &Camera) -> Self {
        let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
        let focal = DVec2::new(camera.fx, camera.fy);
        let principal = DVec2::new(camera.cx, camera.cy);
        let margin = JACOBIAN_MARGIN * size / (2.0 * focal);
        Self {
            camera: camera.clone(),
            rotation: camera.rotation(),
            centre: camera.centre(),
            slope_min: -(principal / focal + margin),
            slope_max: (size - principal) / focal + margin,
        }
    }

    /// Projects a splat; `None` when it is nearer than the near plane, too transparent to reach
    /// 1/255 anywhere, not made of finite numbers, or farther than single precision can say.
    #[must_use]
    pub fn project(&self, splat: &PosedSplat) -> Option<ProjectedSplat> {
        let p = self.rotation * (splat.position - self.centre);
        let far = f64::from(f32::MAX);
        if !(p.z > NEAR_PLANE && p.z <= far && p.is_finite() && splat.opacity >= ALPHA_MIN) {
            return None;
        }
        let (fx, fy) = (self.camera.fx, self.camera.fy);
        let slope = (p.truncate() / p.z).clamp(self.slope_min, self.slope_max);
        // Rows of J, the derivative of (fx x/z, fy y/z) at the clamped point.
        let row_x = DVec3::new(fx / p.z, 0.0, -fx * slope.x / p.z);
        let row_y = DVec3::new(0.0, fy / p.z, -fy * slope.y / p.z);
        // M = J W R S is 2 × 3 and Σ' = M Mᵀ.
        let world = rotation_matrix(splat.rotation) * DMat3::from_diagonal(splat.scale);
        let factor = (self.rotation * world).transpose();
        let (mx, my) = (factor * row_x, factor * row_y);
        let covariance = [mx.dot(mx) + LOW_PASS, mx.dot(my), my.dot(my) + LOW_PASS];
        // |M Mᵀ + λI| = Σ (2×2 minors of M)² + λ tr(M Mᵀ) + λ² (Cauchy–Binet): no cancellation.
        let determinant = mx.cross(my).length_squared()
            + LOW_PASS * (mx.length_squared() + my.length_squared())
            + LOW_PASS * LOW_PASS;
        let conic = [
            covariance[2] / determinant,
            -covariance[1] / determinant,
            covariance[0] / determinant,
        ];
        let centre = DVec2::new(fx * p.x / p.z + self.camera.cx, fy * p.y / p.z + self.camera.cy);
        let finite =
            determinant.is_finite() && centre.is_finite() && conic.iter().all(|c| c.is_finite());
        finite.then_some(ProjectedSplat {
            index: splat.index,
            depth: p.z,
            centre,
            covariance,
            conic,
            opacity: splat.opacity,
            color: splat.color,
        })
    }
}

/// The matrix of a quaternion (w, x, y, z), by the formula for unit quaternions; one of another
/// length is used as it is.
#[must_use]
pub(super) fn rotation_matrix([w, x, y, z]: [f64; 4]) -> DMat3 {
    DMat3::from_cols_array_2d(&[
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
        [2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)],
        [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)],
    ])
}

#[cfg(test)]
mod tests {
    use glam::{DMat2, DQuat};

    use super::*;

    fn splat(position: DVec3, rotation: DQuat, scale: DVec3) -> PosedSplat {
        PosedSplat {
            index: 0,
            position,
            rotation: [rotation.w, rotation.x, rotation.y, rotation.z],
            scale,
            opacity: 0.8,
            color: DVec3::ONE,
        }
    }

    fn camera() -> Camera {
        Camera::look_at(DVec3::new(0.0, 0.0, -5.0), DVec3::ZERO, DVec3::NEG_Y, 0.7, (200, 100))
    }

    #[test]
    fn the_rotation_matrix_is_that_of_the_unit_quaternion() {
        let q = DQuat::from_xyzw(0.1, -0.5, 0.3, 0.7).normalize();
        let ours = rotation_matrix([q.w, q.x, q.y, q.z]);
        assert!((ours - DMat3::from_quat(q)).abs_diff_eq(DMat3::ZERO, 1e-14));
    }

    #[test]
    fn a_small_splat_projects_as_its_samples_do() {
        // Points x + R S e for unit vectors e on a fine sphere: their projections' spread has the
        // covariance M Mᵀ / 3 up to the curvature of the projection, O(scale / depth).
        let q = DQuat::from_xyzw(0.3, 0.2, -0.4, 0.8).normalize();
        let scale = DVec3::new(1e-4, 3e-4, 2e-4);
        let s = splat(DVec3::new(0.4, -0.2, 0.3), q, scale);
        let camera = camera();
        let projected = Projection::new(&camera).project(&s).unwrap();
        let mut sum = [0.0; 3];
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            for sign in [-1.0, 1.0] {
                let world = s.position + q * (axis * scale * sign);
                let p = camera.world_to_camera.transform_point3(world);
                let d = DVec2::new(
                    camera.fx * p.x / p.z + camera.cx,
                    camera.fy * p.y / p.z + camera.cy,
                ) - projected.centre;
                sum =
                    [sum[0] + d.x * d.x / 2.0, sum[1] + d.x * d.y / 2.0, sum[2] + d.y * d.y / 2.0];
            }
        }
        let low_pass = [LOW_PASS, 0.0, LOW_PASS];
        for i in 0..3 {
            let got = projected.covariance[i] - low_pass[i];
            assert!((got - sum[i]).abs() < 1e-6 * sum[0].max(sum[2]), "{i}: {got} {}", sum[i]);
        }
    }

    #[test]
    fn the_conic_inverts_the_covariance() {
        let q = DQuat::from_xyzw(0.3, 0.2, -0.4, 0.8).normalize();
        let s = splat(DVec3::new(0.4, -0.2, 0.3), q, DVec3::new(0.5, 0.01, 0.2));
        let projected = Projection::new(&camera()).project(&s).unwrap();
        let [xx, xy, yy] = projected.covariance;
        let plain = DMat2::from_cols_array(&[xx, xy, xy, yy]).inverse().to_cols_array();
        for (ours, plain) in projected.conic.iter().zip([plain[0], plain[1], plain[3]]) {
            assert!((ours - plain).abs() < 1e-12, "{ours} {plain}");
        }
    }

    #[test]
    fn alpha_is_one_255th_on_the_edge_of_the_extent() {
        let s = splat(DVec3::ZERO, DQuat::IDENTITY, DVec3::new(0.3, 0.1, 0.2));
        let projected = Projection::new(&camera()).project(&s).unwrap();
        let half = projected.half_extent();
        let edge = projected.centre + DVec2::new(half.x, 0.0);
        assert!((projected.alpha(edge) - ALPHA_MIN).abs() < 1e-9);
    }

    #[test]
    fn splats_at_or_behind_the_near_plane_are_left_out() {
        let projection = Projection::new(&camera());
        let at = |z: f64| splat(DVec3::new(0.0, 0.0, z - 5.0), DQuat::IDENTITY, DVec3::splat(0.1));
        assert!(projection.project(&at(NEAR_PLANE * 0.999)).is_none());
        assert!(projection.project(&at(-1.0)).is_none());
        assert!(projection.project(&at(NEAR_PLANE * 1.001)).is_some());
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let projection = Projection::new(&camera());
        let good = splat(DVec3::ZERO, DQuat::IDENTITY, DVec3::splat(0.1));
        assert!(projection.project(&good).is_some());
        for bad in [
            PosedSplat { position: DVec3::NAN, ..good.clone() },
            PosedSplat { position: DVec3::new(f64::INFINITY, 0.0, 0.0), ..good.clone() },
            PosedSplat { scale: DVec3::new(1.0, f64::NAN, 1.0), ..good.clone() },
            PosedSplat { opacity: f64::NAN, ..good.clone() },
        ] {
            assert!(projection.project(&bad).is_none(), "{bad:?}");
        }
    }
}
