//! Record3D's folder export: `metadata.json` and images numbered from 0 in `rgb`.
//!
//! The metadata hold the 3 × 3 intrinsics `K`, column-major, for images of `w` × `h`, and a list of
//! camera-to-world `poses` with OpenGL axes: quaternion x, y, z, w, then the centre. The image
//! `rgb/17.jpg` has the eighteenth pose; images may be left out.

use std::path::Path;

use glam::{DMat3, DQuat, DVec3};
use serde::Deserialize;
use trapeze_scene::Camera;

use super::DatasetOptions;
use super::assemble::{Capture, PosedImage};
use super::image_folder::{ImageFolder, ImageListing};
use super::pose::world_to_camera;
use crate::error::{InFile, printable};
use crate::json::{MAX_JSON_BYTES, parse_json};
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError};

const METADATA: &str = "metadata.json";
const IMAGES: &str = "rgb";

/// Whether a folder is such an export.
pub(super) fn is_present(root: &Path) -> bool {
    root.join(METADATA).is_file() && root.join(IMAGES).is_dir()
}

#[derive(Deserialize)]
struct Metadata {
    #[serde(rename = "K")]
    intrinsics: [f64; 9],
    w: u32,
    h: u32,
    poses: Vec<[f64; 7]>,
}

/// Reads the metadata and takes the images that are there.
pub(super) fn read_capture(root: &Path, options: &DatasetOptions) -> Result<Capture, ReadError> {
    let path = root.join(METADATA);
    let bytes = read_regular_file(&path, MAX_JSON_BYTES)?;
    let metadata: Metadata = parse_json(&bytes).in_file(&path)?;
    let photographs = ImageFolder::choose(root, &root.join(IMAGES), options)?;
    let listing = ImageListing::read(&photographs.path)?;
    let mut numbered = Vec::with_capacity(listing.len());
    for (name, image_path) in listing.iter() {
        let number = name.split('.').next().and_then(|stem| stem.parse::<usize>().ok());
        let number = number.filter(|&number| number < metadata.poses.len()).ok_or_else(|| {
            let expected = format!("a number below {} (the poses)", metadata.poses.len());
            let error = ParseError::value("image name", expected, printable(name, 60));
            ReadError::new(&photographs.path, error)
        })?;
        numbered.push((number, name, image_path));
    }
    numbered.sort();
    let mut capture = Capture::default();
    for (number, name, image_path) in numbered {
        let camera = metadata
            .camera(number)
            .map_err(|error| error.within(&format!("poses[{number}]")))
            .in_file(&path)?;
        capture.images.push(PosedImage {
            name: name.to_owned(),
            camera,
            image_path: image_path.to_path_buf(),
            reduction: photographs.reduction,
            ..PosedImage::default()
        });
    }
    Ok(capture)
}

impl Metadata {
    fn camera(&self, pose: usize) -> Result<Camera, ParseError> {
        let [x, y, z, w, centre @ ..] = self.poses[pose];
        let rotation = DQuat::from_xyzw(x, y, z, w);
        if !(0.99..=1.01).contains(&rotation.length()) {
            let found = format!("length {}", rotation.length());
            return Err(ParseError::value("rotation", "a unit quaternion", found));
        }
        let axes = DMat3::from_quat(rotation.normalize());
        let axes = DMat3::from_cols(axes.x_axis, -axes.y_axis, -axes.z_axis);
        let [fx, _, _, _, fy, _, cx, cy, _] = self.intrinsics;
        Ok(Camera {
            width: self.w,
            height: self.h,
            fx,
            fy,
            cx,
            cy,
            world_to_camera: world_to_camera(axes, DVec3::from(centre))?,
        })
    }
}
