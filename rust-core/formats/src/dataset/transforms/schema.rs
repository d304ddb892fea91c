//! What a `transforms*.json` file may hold.

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::ParseError;
use crate::json::parse_json;

/// One file, its intrinsics already combined with each frame's.
#[derive(Debug)]
pub(super) struct TransformsFile {
    pub(super) frames: Vec<(Frame, LensFields)>,
    pub(super) extras: Extras,
}

/// Pose and files of one image.
#[derive(Debug, Deserialize)]
pub(super) struct Frame {
    /// Relative to the JSON file; Blender leaves the extension out.
    pub(super) file_path: String,
    /// Camera to world, OpenGL axes, row-major; the last row may be left out.
    pub(super) transform_matrix: Vec<[f64; 4]>,
    pub(super) time: Option<f64>,
    pub(super) mask_path: Option<String>,
}

/// Intrinsics, in pixels of a `w` × `h` image; every field may be missing.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct LensFields {
    pub(super) camera_model: Option<String>,
    pub(super) is_fisheye: Option<bool>,
    /// Horizontal and vertical field of view in radians.
    pub(super) camera_angle_x: Option<f64>,
    pub(super) camera_angle_y: Option<f64>,
    pub(super) fl_x: Option<f64>,
    pub(super) fl_y: Option<f64>,
    pub(super) cx: Option<f64>,
    pub(super) cy: Option<f64>,
    pub(super) w: Option<f64>,
    pub(super) h: Option<f64>,
    pub(super) k1: Option<f64>,
    pub(super) k2: Option<f64>,
    pub(super) k3: Option<f64>,
    pub(super) k4: Option<f64>,
    pub(super) p1: Option<f64>,
    pub(super) p2: Option<f64>,
}

impl LensFields {
    /// These fields, and the file's where they are missing.
    fn or(self, file: &Self) -> Self {
        Self {
            camera_model: self.camera_model.or_else(|| file.camera_model.clone()),
            is_fisheye: self.is_fisheye.or(file.is_fisheye),
            camera_angle_x: self.camera_angle_x.or(file.camera_angle_x),
            camera_angle_y: self.camera_angle_y.or(file.camera_angle_y),
            fl_x: self.fl_x.or(file.fl_x),
            fl_y: self.fl_y.or(file.fl_y),
            cx: self.cx.or(file.cx),
            cy: self.cy.or(file.cy),
            w: self.w.or(file.w),
            h: self.h.or(file.h),
            k1: self.k1.or(file.k1),
            k2: self.k2.or(file.k2),
            k3: self.k3.or(file.k3),
            k4: self.k4.or(file.k4),
            p1: self.p1.or(file.p1),
            p2: self.p2.or(file.p2),
        }
    }
}

/// Nerfstudio's additions.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Extras {
    /// Sparse points in the coordinates of the poses.
    pub(super) ply_file_path: Option<String>,
    pub(super) train_filenames: Vec<String>,
    pub(super) val_filenames: Vec<String>,
    pub(super) test_filenames: Vec<String>,
}

#[derive(Deserialize)]
struct Frames<T> {
    frames: Vec<T>,
}

pub(super) fn parse_transforms(bytes: &[u8]) -> Result<TransformsFile, ParseError> {
    // The text is parsed once for each group of fields, rather than once with serde's `flatten`,
    // which cannot say in which field an error is.
    let frames = parse_frames::<Frame>(bytes)?;
    let lenses = parse_frames::<LensFields>(bytes)?;
    let file_lens: LensFields = parse_json(bytes)?;
    let lenses = lenses.into_iter().map(|lens| lens.or(&file_lens));
    Ok(TransformsFile {
        frames: frames.into_iter().zip(lenses).collect(),
        extras: parse_json(bytes)?,
    })
}

fn parse_frames<T: DeserializeOwned>(bytes: &[u8]) -> Result<Vec<T>, ParseError> {
    Ok(parse_json::<Frames<T>>(bytes)?.frames)
}
