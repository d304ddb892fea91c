//! Camera-to-world poses of any scale, turned into rigid world-to-camera transforms.

use glam::{DMat3, DMat4, DQuat, DVec3};

use crate::ParseError;

/// The transform into a camera whose axes in the world (right, down, forward) are the columns of
/// `axes` and whose centre is `centre`.
///
/// A common length of the axes (a scene that was scaled together with its cameras) changes no ray
/// and is divided out; axes that are not perpendicular, or mirrored, are refused. What rounding
/// left of a skew is removed, so that the result is rigid to double precision.
pub(super) fn world_to_camera(axes: DMat3, centre: DVec3) -> Result<DMat4, ParseError> {
    /// Relative error of the axes' lengths and angles: files with four digits pass.
    const TOLERANCE: f64 = 1e-3;
    let refuse = |expected, found: String| Err(ParseError::value("camera pose", expected, found));
    if !axes.is_finite() || !centre.is_finite() {
        return refuse("finite numbers", "NaN or infinity".into());
    }
    let determinant = axes.determinant();
    // NaN-proof: a zero, negative or overflown determinant has no usable cube root.
    let scale = determinant.cbrt();
    if !(scale > 0.0 && scale.is_finite()) {
        return refuse("right-handed axes", format!("determinant {determinant}"));
    }
    let unit = axes * (1.0 / scale);
    let skew = unit.transpose() * unit - DMat3::IDENTITY;
    if !skew.to_cols_array().iter().all(|error| error.abs() <= TOLERANCE) {
        return refuse("perpendicular axes of one length", format!("{axes}"));
    }
    let rotation = DQuat::from_mat3(&unit).normalize().conjugate();
    Ok(DMat4::from_rotation_translation(rotation, rotation * -centre))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_is_divided_out_and_the_centre_kept() {
        let rotation = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
        let centre = DVec3::new(4.0, -5.0, 6.0);
        let pose = world_to_camera(DMat3::from_quat(rotation) * 3.0, centre).unwrap();
        assert!(pose.transform_point3(centre).length() < 1e-14);
        let ahead = centre + rotation * DVec3::Z;
        assert!((pose.transform_point3(ahead) - DVec3::Z).length() < 1e-14);
    }

    #[test]
    fn mirrored_skewed_and_broken_axes_are_refused() {
        let columns = |x, y, z| DMat3::from_cols(x, y, z);
        for (axes, expected) in [
            (columns(-DVec3::X, DVec3::Y, DVec3::Z), "right-handed"),
            (DMat3::ZERO, "right-handed"),
            (columns(DVec3::X, DVec3::Y, DVec3::new(0.1, 0.0, 1.0)), "perpendicular"),
            (columns(DVec3::X, DVec3::Y, DVec3::Z * 1.1), "perpendicular"),
            (DMat3::IDENTITY * f64::NAN, "finite"),
            (DMat3::IDENTITY * 1e200, "right-handed"),
        ] {
            let error = world_to_camera(axes, DVec3::ZERO).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
