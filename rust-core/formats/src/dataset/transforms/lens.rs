//! Intrinsics of a `transforms*.json` frame.

use glam::{DMat3, DMat4, DVec3};
use trapeze_scene::Camera;

use super::schema::{Frame, LensFields};
use crate::ParseError;
use crate::dataset::Distortion;
use crate::dataset::pose::world_to_camera;

impl LensFields {
    /// The camera at the size that the file states or, where it states none, at `full_size`, that
    /// of the full-size image.
    pub(super) fn camera(
        &self,
        full_size: [u32; 2],
        world_to_camera: DMat4,
    ) -> Result<Camera, ParseError> {
        let width = side("w", self.w, full_size[0])?;
        let height = side("h", self.h, full_size[1])?;
        let from_angle = |angle: f64, side: u32| f64::from(side) / (2.0 * (angle / 2.0).tan());
        let fx = match (self.fl_x, self.camera_angle_x) {
            (Some(focal), _) => focal,
            (None, Some(angle)) => from_angle(angle, width),
            (None, None) => {
                return Err(ParseError::value("fl_x", "fl_x or camera_angle_x", "neither"));
            }
        };
        // An angle of its own counts only where the horizontal one did: pixels are square.
        let vertical_angle = self.camera_angle_y.filter(|_| self.fl_x.is_none());
        let fy = self.fl_y.or(vertical_angle.map(|a| from_angle(a, height))).unwrap_or(fx);
        Ok(Camera {
            width,
            height,
            fx,
            fy,
            cx: self.cx.unwrap_or(f64::from(width) / 2.0),
            cy: self.cy.unwrap_or(f64::from(height) / 2.0),
            world_to_camera,
        })
    }

    pub(super) fn distortion(&self) -> Result<Distortion, ParseError> {
        let [k1, k2, k3, k4, p1, p2] =
            [self.k1, self.k2, self.k3, self.k4, self.p1, self.p2].map(Option::unwrap_or_default);
        let model = match (self.camera_model.as_deref(), self.is_fisheye) {
            (Some(model), _) => model,
            (None, Some(true)) => "OPENCV_FISHEYE",
            (None, _) => "OPENCV",
        };
        match model {
            "SIMPLE_PINHOLE" | "PINHOLE" => Ok(Distortion::None),
            "OPENCV" | "PERSPECTIVE" | "SIMPLE_RADIAL" | "RADIAL" if k4 == 0.0 => {
                Ok(Distortion::perspective([k1, k2, k3], [p1, p2]))
            }
            "OPENCV" | "PERSPECTIVE" | "SIMPLE_RADIAL" | "RADIAL" => {
                Err(ParseError::value("k4", "0 for a perspective lens", k4))
            }
            "OPENCV_FISHEYE" => Ok(Distortion::Fisheye { radial: [k1, k2, k3, k4] }),
            other => {
                let expected = "SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, \
                                PERSPECTIVE, OPENCV_FISHEYE";
                Err(ParseError::value("camera_model", expected, other))
            }
        }
    }
}

fn side(field: &str, stated: Option<f64>, otherwise: u32) -> Result<u32, ParseError> {
    match stated {
        None => Ok(otherwise),
        Some(side) if side.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&side) => {
            Ok(side as u32)
        }
        Some(side) => Err(ParseError::value(field, "a whole number of pixels", side)),
    }
}

impl Frame {
    /// The frame's pose in OpenCV axes.
    pub(super) fn world_to_camera(&self) -> Result<DMat4, ParseError> {
        let rows = match self.transform_matrix.as_slice() {
            [x, y, z] | [x, y, z, [0.0, 0.0, 0.0, 1.0]] => [x, y, z],
            other => {
                let expected = "3 rows of 4 numbers, or 4 of which the last is 0 0 0 1";
                let found = format!("{} rows", other.len());
                return Err(ParseError::value("transform_matrix", expected, found));
            }
        };
        let column = |c: usize| DVec3::from(rows.map(|row| row[c]));
        let (right, up, backwards, centre) = (column(0), column(1), column(2), column(3));
        world_to_camera(DMat3::from_cols(right, -up, -backwards), centre)
    }
}
