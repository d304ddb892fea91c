//! Pinhole camera with OpenCV axes.

use glam::{DMat3, DMat4, DVec3, DVec4};

use crate::SceneError;

/// A pinhole camera: x right, y down, z forward; pixel centres at +0.5; real `cx`, `cy`.
///
/// Kept in double precision: it is one small value per frame, and captures with geographic
/// coordinates lose pixels already when the camera is rounded to single precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Image width in pixels.
    pub width: u32,
    /// Image height in pixels.
    pub height: u32,
    /// Focal length along x in pixels.
    pub fx: f64,
    /// Focal length along y in pixels.
    pub fy: f64,
    /// Principal point along x in pixels.
    pub cx: f64,
    /// Principal point along y in pixels.
    pub cy: f64,
    /// Rigid (or rigid times uniform scale) transform from world to camera space.
    pub world_to_camera: DMat4,
}

/// Largest width or height of an image: keeps pixel counts inside 32 bits with room to spare.
pub const MAX_IMAGE_SIDE: u32 = 16_384;

impl Camera {
    /// Checks that the camera can project: a size of 1 to 16 384 pixels, positive focal lengths,
    /// finite values, an affine and invertible `world_to_camera`.
    ///
    /// # Errors
    /// [`SceneError::Camera`] names the first field that is not usable.
    pub fn validate(&self) -> Result<(), SceneError> {
        let refuse =
            |field, expected, found: String| Err(SceneError::Camera { field, expected, found });
        for (field, side) in [("width", self.width), ("height", self.height)] {
            if side == 0 || side > MAX_IMAGE_SIDE {
                return refuse(field, "1 to 16384 pixels", side.to_string());
            }
        }
        for (field, focal) in [("fx", self.fx), ("fy", self.fy)] {
            if !(focal.is_finite() && focal > 0.0) {
                return refuse(field, "a positive focal length in pixels", format!("{focal:?}"));
            }
        }
        for (field, centre) in [("cx", self.cx), ("cy", self.cy)] {
            if !centre.is_finite() {
                return refuse(field, "a finite principal point in pixels", format!("{centre:?}"));
            }
        }
        if !self.world_to_camera.is_finite() {
            return refuse("world_to_camera", "16 finite numbers", "NaN or infinity".into());
        }
        let last = self.world_to_camera.row(3);
        if last != DVec4::W {
            return refuse("world_to_camera", "last row 0 0 0 1", format!("{:?}", last.to_array()));
        }
        let determinant = self.rotation().determinant();
        if determinant.abs() < 1e-12 {
            return refuse(
                "world_to_camera",
                "an invertible matrix",
                format!("det {determinant:?}"),
            );
        }
        Ok(())
    }

    /// The linear part of `world_to_camera`.
    #[must_use]
    pub fn rotation(&self) -> DMat3 {
        DMat3::from_mat4(self.world_to_camera)
    }

    /// Camera centre in world units.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        self.rotation().inverse() * -self.world_to_camera.w_axis.truncate()
    }

    /// The same camera for a scene whose coordinates have `origin` subtracted.
    #[must_use]
    pub fn relative_to(&self, origin: DVec3) -> Self {
        Self {
            world_to_camera: self.world_to_camera * DMat4::from_translation(origin),
            ..self.clone()
        }
    }

    /// The same view in another resolution; the principal point moves with the image.
    #[must_use]
    pub fn resized(&self, width: u32, height: u32) -> Self {
        let sx = f64::from(width) / f64::from(self.width);
        let sy = f64::from(height) / f64::from(self.height);
        Self {
            width,
            height,
            fx: self.fx * sx,
            fy: self.fy * sy,
            cx: self.cx * sx,
            cy: self.cy * sy,
            world_to_camera: self.world_to_camera,
        }
    }

    /// A camera at `eye` that looks at `target`, with `up` upwards in the image.
    ///
    /// `vertical_fov` is in radians. Where `up` and the view direction are parallel another axis
    /// is taken, so that the result is always a rotation.
    #[must_use]
    pub fn look_at(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        vertical_fov: f64,
        (width, height): (u32, u32),
    ) -> Self {
        let forward = (target - eye).try_normalize().unwrap_or(DVec3::Z);
        let right =
            forward.cross(up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        let down = forward.cross(right);
        let rotation = DMat3::from_cols(right, down, forward).transpose();
        let focal = f64::from(height) / (2.0 * (vertical_fov / 2.0).tan());
        Self {
            width,
            height,
            fx: focal,
            fy: focal,
            cx: f64::from(width) / 2.0,
            cy: f64::from(height) / 2.0,
            world_to_camera: DMat4::from_mat3(rotation) * DMat4::from_translation(-eye),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::look_at(DVec3::new(1.0, 2.0, 5.0), DVec3::ZERO, DVec3::Y, 0.8, (640, 480))
    }

    #[test]
    fn the_target_projects_to_the_image_centre_and_up_is_up() {
        let camera = camera();
        let target = camera.world_to_camera.transform_point3(DVec3::ZERO);
        assert!(target.truncate().length() < 1e-12 && target.z > 0.0, "{target}");
        let above = camera.world_to_camera.transform_point3(DVec3::new(0.0, 0.1, 0.0));
        assert!(above.y < 0.0, "y points down in the image: {above}");
        assert!((camera.rotation().determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_centre_is_where_the_camera_was_put() {
        assert!((camera().centre() - DVec3::new(1.0, 2.0, 5.0)).length() < 1e-12);
    }

    #[test]
    fn looking_along_up_still_gives_a_rotation() {
        let camera = Camera::look_at(DVec3::Y * 3.0, DVec3::ZERO, DVec3::Y, 0.8, (4, 4));
        assert!((camera.rotation().determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn unusable_cameras_are_refused_by_field() {
        for (field, broken) in [
            ("width", Camera { width: 0, ..camera() }),
            ("height", Camera { height: 1 << 20, ..camera() }),
            ("fx", Camera { fx: f64::NAN, ..camera() }),
            ("fy", Camera { fy: -1.0, ..camera() }),
            ("cx", Camera { cx: f64::INFINITY, ..camera() }),
            ("world_to_camera", Camera { world_to_camera: DMat4::ZERO, ..camera() }),
        ] {
            let message = broken.validate().unwrap_err().to_string();
            assert!(message.contains(field), "{message}");
        }
        assert!(camera().validate().is_ok());
        // Not with 300 digits.
        let message = Camera { fx: -1e300, ..camera() }.validate().unwrap_err().to_string();
        assert!(message.ends_with("found -1e300"), "{message}");
    }
}
