//! A COLMAP reconstruction as its files have it, binary or text.

use std::collections::BTreeMap;

use glam::{DMat4, DQuat, DVec3};

use crate::ParseError;
use crate::dataset::Distortion;

/// COLMAP's camera models by their number in `cameras.bin`.
const MODEL_NAMES: [&str; 12] = [
    "SIMPLE_PINHOLE",
    "PINHOLE",
    "SIMPLE_RADIAL",
    "RADIAL",
    "OPENCV",
    "OPENCV_FISHEYE",
    "FULL_OPENCV",
    "FOV",
    "SIMPLE_RADIAL_FISHEYE",
    "RADIAL_FISHEYE",
    "THIN_PRISM_FISHEYE",
    "RAD_TAN_THIN_PRISM_FISHEYE",
];

/// The camera models that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CameraModel {
    /// f, cx, cy
    SimplePinhole,
    /// fx, fy, cx, cy
    Pinhole,
    /// f, cx, cy, k₁
    SimpleRadial,
    /// f, cx, cy, k₁, k₂
    Radial,
    /// fx, fy, cx, cy, k₁, k₂, p₁, p₂
    OpenCv,
    /// fx, fy, cx, cy, k₁, k₂, k₃, k₄
    OpenCvFisheye,
}

impl CameraModel {
    pub(super) fn from_id(id: u32) -> Result<Self, ParseError> {
        match MODEL_NAMES.get(id as usize) {
            Some(name) => Self::from_name(name),
            None => Self::refuse(&format!("model {id}")),
        }
    }

    pub(super) fn from_name(name: &str) -> Result<Self, ParseError> {
        match name {
            "SIMPLE_PINHOLE" => Ok(Self::SimplePinhole),
            "PINHOLE" => Ok(Self::Pinhole),
            "SIMPLE_RADIAL" => Ok(Self::SimpleRadial),
            "RADIAL" => Ok(Self::Radial),
            "OPENCV" => Ok(Self::OpenCv),
            "OPENCV_FISHEYE" => Ok(Self::OpenCvFisheye),
            other => Self::refuse(other),
        }
    }

    fn refuse(found: &str) -> Result<Self, ParseError> {
        let expected = MODEL_NAMES[..6].join(", ");
        Err(ParseError::value("camera model", expected, found))
    }

    pub(super) fn parameter_count(self) -> usize {
        match self {
            Self::SimplePinhole => 3,
            Self::Pinhole | Self::SimpleRadial => 4,
            Self::Radial => 5,
            Self::OpenCv | Self::OpenCvFisheye => 8,
        }
    }
}

/// A camera of the reconstruction: intrinsics at the size of the images that COLMAP saw.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ModelCamera {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) fx: f64,
    pub(super) fy: f64,
    pub(super) cx: f64,
    pub(super) cy: f64,
    pub(super) distortion: Distortion,
}

impl ModelCamera {
    /// From the model's [`parameter_count`](CameraModel::parameter_count) parameters.
    pub(super) fn new(
        model: CameraModel,
        [width, height]: [u64; 2],
        parameters: &[f64],
    ) -> Result<Self, ParseError> {
        let radial = |k1, k2| Distortion::perspective([k1, k2, 0.0], [0.0; 2]);
        let (fx, fy, cx, cy, distortion) = match (model, parameters) {
            (CameraModel::SimplePinhole, &[f, cx, cy]) => (f, f, cx, cy, Distortion::None),
            (CameraModel::Pinhole, &[fx, fy, cx, cy]) => (fx, fy, cx, cy, Distortion::None),
            (CameraModel::SimpleRadial, &[f, cx, cy, k1]) => (f, f, cx, cy, radial(k1, 0.0)),
            (CameraModel::Radial, &[f, cx, cy, k1, k2]) => (f, f, cx, cy, radial(k1, k2)),
            (CameraModel::OpenCv, &[fx, fy, cx, cy, k1, k2, p1, p2]) => {
                (fx, fy, cx, cy, Distortion::perspective([k1, k2, 0.0], [p1, p2]))
            }
            (CameraModel::OpenCvFisheye, &[fx, fy, cx, cy, k1, k2, k3, k4]) => {
                (fx, fy, cx, cy, Distortion::Fisheye { radial: [k1, k2, k3, k4] })
            }
            _ => {
                let expected = format!("{} numbers for {model:?}", model.parameter_count());
                return Err(ParseError::value("camera parameters", expected, parameters.len()));
            }
        };
        let side = |field, value: u64| {
            let expected = "a size in pixels below 2^32";
            u32::try_from(value).map_err(|_| ParseError::value(field, expected, value))
        };
        let (width, height) = (side("camera width", width)?, side("camera height", height)?);
        Ok(Self { width, height, fx, fy, cx, cy, distortion })
    }
}

/// An image of the reconstruction.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ModelImage {
    pub(super) name: String,
    pub(super) camera_id: u32,
    pub(super) world_to_camera: DMat4,
}

/// The rigid transform of a unit quaternion (w, x, y, z) and a translation.
pub(super) fn rigid_transform(
    [w, x, y, z]: [f64; 4],
    translation: [f64; 3],
) -> Result<DMat4, ParseError> {
    let rotation = DQuat::from_xyzw(x, y, z, w);
    let length = rotation.length();
    // COLMAP writes unit quaternions; text files round them.
    if !(0.99..=1.01).contains(&length) {
        let found = format!("length {length}");
        return Err(ParseError::value("image rotation", "a unit quaternion", found));
    }
    let translation = DVec3::from(translation);
    if !translation.is_finite() {
        return Err(ParseError::value("image translation", "finite numbers", translation));
    }
    Ok(DMat4::from_rotation_translation(rotation.normalize(), translation))
}

pub(super) type ModelCameras = BTreeMap<u32, ModelCamera>;

/// A point's position, refused where it is not finite.
pub(super) fn finite_position(position: [f64; 3]) -> Result<[f64; 3], ParseError> {
    if position.iter().all(|coordinate| coordinate.is_finite()) {
        return Ok(position);
    }
    Err(ParseError::value("point position", "finite numbers", format!("{position:?}")))
}
