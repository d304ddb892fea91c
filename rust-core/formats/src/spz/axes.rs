//! Signs that take splats from one set of axes to another when axes only point the other way.

use std::sync::LazyLock;

use trapeze_scene::sh_basis;

/// What a change of axis directions multiplies each component with; its own inverse.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AxisSigns {
    /// x, y, z of a position.
    pub(crate) position: [f32; 3],
    /// x, y, z of a quaternion.
    pub(crate) rotation: [f32; 3],
    /// SH coefficients of bands 1 to 3.
    pub(crate) sh: [f32; 15],
}

impl AxisSigns {
    /// Signs between two sets of axes, −1 for each axis that is reversed.
    ///
    /// With F = diag(x, y, z) a rotation R becomes F R F. The vector part of a quaternion is an
    /// axial vector, so it becomes det(F)·F·v = (yz, xz, xy)·v. Colour must stay the same along the
    /// reversed direction, Σ c′ Y(F d) = Σ c Y(d), and every basis function is even or odd in each
    /// of its arguments: its sign is read off the basis itself.
    pub(crate) fn new([x, y, z]: [f32; 3]) -> Self {
        // A unit vector at which no basis function vanishes.
        const DIRECTION: [f64; 3] = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0];
        let [dx, dy, dz] = DIRECTION;
        let before = sh_basis(DIRECTION);
        let after = sh_basis([dx * f64::from(x), dy * f64::from(y), dz * f64::from(z)]);
        Self {
            position: [x, y, z],
            rotation: [y * z, x * z, x * y],
            sh: std::array::from_fn(|j| (before[j + 1] * after[j + 1]).signum() as f32),
        }
    }

    /// From right, up, back (SPZ) to right, down, front (PLY), and back.
    pub(crate) fn right_up_back() -> &'static Self {
        static SIGNS: LazyLock<AxisSigns> = LazyLock::new(|| AxisSigns::new([1.0, -1.0, -1.0]));
        &SIGNS
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DQuat, DVec3};
    use proptest::prelude::*;

    use super::*;

    fn reversals() -> impl Strategy<Value = [f32; 3]> {
        prop::array::uniform3(prop_oneof![Just(1.0_f32), Just(-1.0)])
    }

    fn unit_vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0_f64)
            .prop_filter_map("too short", |v| DVec3::from(v).try_normalize())
    }

    proptest! {
        #[test]
        fn colour_along_the_reversed_direction_is_the_same(
            axes in reversals(),
            direction in unit_vector(),
            coefficients in prop::collection::vec(-2.0..2.0_f64, 16),
        ) {
            let signs = AxisSigns::new(axes);
            let reversed = direction * DVec3::from(axes.map(f64::from));
            let before = sh_basis(direction.to_array());
            let after = sh_basis(reversed.to_array());
            let mut difference = coefficients[0] * (before[0] - after[0]);
            for j in 0..15 {
                let c = coefficients[j + 1];
                difference += c * before[j + 1] - c * f64::from(signs.sh[j]) * after[j + 1];
            }
            // The two sums have the same terms up to sign; 16 terms below 6 leave rounding only.
            prop_assert!(difference.abs() < 1e-13, "{difference}");
        }

        #[test]
        fn covariances_are_reversed_with_their_axes(
            axes in reversals(),
            axis in unit_vector(),
            angle in 0.0..6.0_f64,
            scales in prop::array::uniform3(0.1..3.0_f64),
        ) {
            let signs = AxisSigns::new(axes);
            let q = DQuat::from_axis_angle(axis, angle);
            let [sx, sy, sz] = signs.rotation.map(f64::from);
            let covariance = |q: DQuat| {
                let m = DMat3::from_quat(q) * DMat3::from_diagonal(DVec3::from(scales));
                m * m.transpose()
            };
            let flip = DMat3::from_diagonal(DVec3::from(axes.map(f64::from)));
            let expected = flip * covariance(q) * flip;
            let found = covariance(DQuat::from_xyzw(sx * q.x, sy * q.y, sz * q.z, q.w));
            prop_assert!((expected - found).abs_diff_eq(DMat3::ZERO, 1e-12));
        }
    }
}
