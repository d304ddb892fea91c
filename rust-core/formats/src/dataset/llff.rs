//! LLFF's `poses_bounds.npy`: N × 17 doubles, one row an image in name order.
//!
//! A row is a 3 × 5 matrix, row-major, and two depths. The matrix's first three columns are the
//! camera's axes in the world, down, right and backwards; the fourth is its centre; the fifth is
//! the image height, width and focal length in pixels. The depths are those of the nearest and
//! the farthest content.

use std::path::Path;

use glam::{DMat3, DVec3};
use trapeze_scene::Camera;

use super::assemble::{Capture, PosedImage};
use super::image_folder::{ImageFolder, ImageListing};
use super::pose::world_to_camera;
use super::{DatasetOptions, colmap};
use crate::error::InFile;
use crate::npy::parse_npy;
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError};

pub(super) const FILE_NAME: &str = "poses_bounds.npy";

/// Numbers of one image.
const ROW: usize = 17;
/// Longest file: half a million images.
const MAX_FILE_BYTES: u64 = 64 << 20;

/// Reads the poses and finds the images; points come from a COLMAP model, if one is there.
pub(super) fn read_capture(root: &Path, options: &DatasetOptions) -> Result<Capture, ReadError> {
    let path = root.join(FILE_NAME);
    let bytes = read_regular_file(&path, MAX_FILE_BYTES)?;
    let mut images = parse_poses_bounds(&bytes).in_file(&path)?;

    let photographs = ImageFolder::choose(root, &root.join("images"), options)?;
    let listing = ImageListing::read(&photographs.path)?;
    if listing.len() != images.len() {
        let expected = format!("{} as {FILE_NAME} has rows", images.len());
        let error = ParseError::value("number of images", expected, listing.len());
        return Err(ReadError::new(&photographs.path, error));
    }
    for (image, (name, path)) in images.iter_mut().zip(listing.iter()) {
        image.name = name.to_owned();
        image.image_path = path.to_path_buf();
        image.reduction = photographs.reduction;
    }
    let points = match colmap::model_folder(root) {
        Some(model) => colmap::read_points(&model)?,
        None => None,
    };
    Ok(Capture { images, points, ..Capture::default() })
}

fn parse_poses_bounds(bytes: &[u8]) -> Result<Vec<PosedImage>, ParseError> {
    let array = parse_npy(bytes)?;
    if !matches!(array.shape[..], [_, ROW]) {
        let found = format!("{:?}", array.shape);
        return Err(ParseError::value("shape", format!("(images, {ROW})"), found));
    }
    array.values.to_f64().chunks_exact(ROW).map(posed_image).collect()
}

fn posed_image(row: &[f64]) -> Result<PosedImage, ParseError> {
    let column = |c: usize| DVec3::new(row[c], row[5 + c], row[10 + c]);
    let (down, right, backwards, centre) = (column(0), column(1), column(2), column(3));
    let [height, width, focal] = column(4).to_array();
    let side = |field, value: f64| {
        let is_size = value.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&value);
        let expected = "a whole number of pixels";
        if is_size { Ok(value as u32) } else { Err(ParseError::value(field, expected, value)) }
    };
    let depth_range = [row[15], row[16]];
    let is_ordered = depth_range[0] > 0.0 && depth_range[0] <= depth_range[1];
    Ok(PosedImage {
        camera: Camera {
            width: side("image width", width)?,
            height: side("image height", height)?,
            fx: focal,
            fy: focal,
            cx: width / 2.0,
            cy: height / 2.0,
            world_to_camera: world_to_camera(DMat3::from_cols(right, down, -backwards), centre)?,
        },
        depth_range: is_ordered.then_some(depth_range),
        ..PosedImage::default()
    })
}
