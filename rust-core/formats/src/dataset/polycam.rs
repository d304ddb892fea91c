//! Polycam's raw export: `keyframes/cameras/*.json` and `keyframes/images`, or the `corrected_…`
//! folders that its own bundle adjustment adds.
//!
//! Each image has a JSON file of its stem with fx, fy, cx, cy, width, height and the rows t_00 …
//! t_23 of the camera-to-world matrix, OpenGL axes.

use std::path::{Path, PathBuf};

use glam::{DMat3, DVec3};
use serde::Deserialize;
use trapeze_scene::Camera;

use super::DatasetOptions;
use super::assemble::{Capture, PosedImage};
use super::image_folder::{ImageFolder, match_images};
use super::pose::world_to_camera;
use crate::error::InFile;
use crate::json::parse_json;
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError};

/// Folders of cameras and of their images, the adjusted ones first.
const FOLDERS: [[&str; 2]; 2] = [
    ["keyframes/corrected_cameras", "keyframes/corrected_images"],
    ["keyframes/cameras", "keyframes/images"],
];

/// Longest camera file; the usual has one kilobyte.
const MAX_CAMERA_BYTES: u64 = 1 << 20;

/// The camera and image folders of an export.
pub(super) fn folders(root: &Path) -> Option<[PathBuf; 2]> {
    FOLDERS.map(|pair| pair.map(|name| root.join(name))).into_iter().find(|[c, _]| c.is_dir())
}

#[derive(Deserialize)]
struct CameraFile {
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    width: u32,
    height: u32,
    t_00: f64,
    t_01: f64,
    t_02: f64,
    t_03: f64,
    t_10: f64,
    t_11: f64,
    t_12: f64,
    t_13: f64,
    t_20: f64,
    t_21: f64,
    t_22: f64,
    t_23: f64,
}

/// Reads one camera for each JSON file and finds the images.
pub(super) fn read_capture(root: &Path, options: &DatasetOptions) -> Result<Capture, ReadError> {
    let [cameras, images] = folders(root).ok_or_else(|| {
        ReadError::new(root, ParseError::value("Polycam export", "keyframes/cameras", "none"))
    })?;
    let mut files = Vec::new();
    for entry in std::fs::read_dir(&cameras).in_file(&cameras)? {
        let path = entry.in_file(&cameras)?.path();
        if path.extension().is_some_and(|extension| extension == "json") {
            files.push(path);
        }
    }
    files.sort();
    let stem = |path: &PathBuf| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let names: Vec<String> = files.iter().map(stem).collect();

    let photographs = ImageFolder::choose(root, &images, options)?;
    let names_by_ref: Vec<&str> = names.iter().map(String::as_str).collect();
    let matched = match_images(&photographs.path, &names_by_ref)?;
    let mut capture = Capture::default();
    capture.warnings.extend(matched.warning);
    for ((file, name), image_path) in files.iter().zip(names).zip(matched.paths) {
        let bytes = read_regular_file(file, MAX_CAMERA_BYTES)?;
        let camera = parse_camera(&bytes).in_file(file)?;
        let reduction = photographs.reduction;
        capture.images.push(PosedImage {
            name,
            camera,
            image_path,
            reduction,
            ..PosedImage::default()
        });
    }
    Ok(capture)
}

fn parse_camera(bytes: &[u8]) -> Result<Camera, ParseError> {
    let file: CameraFile = parse_json(bytes)?;
    let right = DVec3::new(file.t_00, file.t_10, file.t_20);
    let up = DVec3::new(file.t_01, file.t_11, file.t_21);
    let backwards = DVec3::new(file.t_02, file.t_12, file.t_22);
    let centre = DVec3::new(file.t_03, file.t_13, file.t_23);
    Ok(Camera {
        width: file.width,
        height: file.height,
        fx: file.fx,
        fy: file.fy,
        cx: file.cx,
        cy: file.cy,
        world_to_camera: world_to_camera(DMat3::from_cols(right, -up, -backwards), centre)?,
    })
}
