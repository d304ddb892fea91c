//! The mirror of [`Projection::project`]: ∂L/∂(projected splat) → ∂L/∂(splat in the world).

use glam::{DMat2, DMat3, DVec2, DVec3};

use super::project::{Projection, rotation_matrix};
use super::{PosedSplat, ProjectedGradient, ProjectedSplat};

/// ∂L/∂ a splat in the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PosedGradient {
    /// By the centre, 1/world units; the part that goes through the colour is not in it.
    pub position: DVec3,
    /// By the quaternion (w, x, y, z) that enters the covariance, each component taken as free.
    pub rotation: [f64; 4],
    /// By the standard deviations, 1/world units.
    pub scale: DVec3,
    /// By the opacity, 0–1.
    pub opacity: f64,
    /// By r g b.
    pub color: DVec3,
}

impl Projection {
    /// Gradient of a splat that [`Projection::project`] turned into `projected`.
    #[must_use]
    pub fn project_backward(
        &self,
        splat: &PosedSplat,
        projected: &ProjectedSplat,
        gradient: &ProjectedGradient,
    ) -> PosedGradient {
        let (fx, fy) = (self.camera.fx, self.camera.fy);
        let p = self.rotation * (splat.position - self.centre);
        let unlimited = p.truncate() / p.z;
        let slope = unlimited.clamp(self.slope_min, self.slope_max);
        let row_x = DVec3::new(fx / p.z, 0.0, -fx * slope.x / p.z);
        let row_y = DVec3::new(0.0, fy / p.z, -fy * slope.y / p.z);
        let local = rotation_matrix(splat.rotation);
        let factor = self.rotation * local * DMat3::from_diagonal(splat.scale);
        let (mx, my) = (factor.transpose() * row_x, factor.transpose() * row_y);

        // Σ' = K⁻¹: dΣ' = −K dK K for symmetric K.
        let [by_xx, by_xy, by_yy] = gradient.conic;
        let by_conic = DMat2::from_cols_array(&[by_xx, by_xy / 2.0, by_xy / 2.0, by_yy]);
        let [xx, xy, yy] = projected.conic;
        let conic = DMat2::from_cols_array(&[xx, xy, xy, yy]);
        let by_covariance = -(conic * by_conic * conic);
        // Σ' = M Mᵀ + λI, rows mx and my.
        let by_mx = 2.0 * (by_covariance.x_axis.x * mx + by_covariance.x_axis.y * my);
        let by_my = 2.0 * (by_covariance.x_axis.y * mx + by_covariance.y_axis.y * my);

        // mx = (W R S)ᵀ row_x: by the factor an outer product, by the row a product.
        let outer = |column: DVec3, row: DVec3| {
            DMat3::from_cols(column * row.x, column * row.y, column * row.z)
        };
        let by_factor = outer(row_x, by_mx) + outer(row_y, by_my);
        let by_row_x = factor * by_mx;
        let by_row_y = factor * by_my;
        let by_world = self.rotation.transpose() * by_factor;
        let scale = DVec3::new(
            by_world.x_axis.dot(local.x_axis),
            by_world.y_axis.dot(local.y_axis),
            by_world.z_axis.dot(local.z_axis),
        );
        let by_local = by_world * DMat3::from_diagonal(splat.scale);

        // row = (f/z, 0, −f s/z) with s limited; the centre is f x/z + c with x/z as it is.
        let inside = |s: f64, low: f64, high: f64| f64::from(u8::from(s > low && s < high));
        let free = DVec2::new(
            inside(unlimited.x, self.slope_min.x, self.slope_max.x),
            inside(unlimited.y, self.slope_min.y, self.slope_max.y),
        );
        let by_limited = DVec2::new(-fx / p.z * by_row_x.z, -fy / p.z * by_row_y.z);
        let by_slope = gradient.centre * DVec2::new(fx, fy) + by_limited * free;
        let by_z = gradient.depth
            - (by_row_x.dot(row_x) + by_row_y.dot(row_y)) / p.z
            - by_slope.dot(unlimited) / p.z;
        let by_view = (by_slope / p.z).extend(by_z);
        PosedGradient {
            position: self.rotation.transpose() * by_view,
            rotation: rotation_matrix_backward(splat.rotation, by_local),
            scale,
            opacity: gradient.opacity,
            color: gradient.color,
        }
    }
}

/// ∂L/∂(w, x, y, z) from ∂L/∂(entries of the rotation matrix).
#[must_use]
pub(super) fn rotation_matrix_backward([w, x, y, z]: [f64; 4], g: DMat3) -> [f64; 4] {
    // gₖ is column k, so that R[row][k] has the gradient gₖ[row].
    let [a, b, c] = [g.x_axis, g.y_axis, g.z_axis];
    [
        2.0 * (z * (a.y - b.x) + y * (c.x - a.z) + x * (b.z - c.y)),
        2.0 * (y * (a.y + b.x) + z * (a.z + c.x) + w * (b.z - c.y) - 2.0 * x * (b.y + c.z)),
        2.0 * (x * (a.y + b.x) + z * (b.z + c.y) + w * (c.x - a.z) - 2.0 * y * (a.x + c.z)),
        2.0 * (x * (a.z + c.x) + y * (b.z + c.y) + w * (a.y - b.x) - 2.0 * z * (a.x + b.y)),
    ]
}
