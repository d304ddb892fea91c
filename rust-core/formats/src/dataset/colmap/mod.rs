//! COLMAP reconstructions: cameras, poses and sparse points.

mod binary;
mod model;
mod text;

use std::path::{Path, PathBuf};

use trapeze_scene::Camera;

use self::model::{ModelCameras, ModelImage};
use super::DatasetOptions;
use super::assemble::{Capture, PosedImage};
use super::image_folder::{ImageFolder, match_images};
use super::points::WorldPoints;
use crate::error::{InFile, printable};
use crate::{ParseError, ReadError, open};

/// Where a reconstruction is looked for inside a dataset.
const MODEL_FOLDERS: [&str; 4] = ["sparse/0", "sparse", "colmap/sparse/0", ""];

/// The folder of a dataset that holds a reconstruction.
pub(super) fn model_folder(root: &Path) -> Option<PathBuf> {
    let holds_model = |folder: &PathBuf| {
        let present = |part| Part::find(folder, part).is_some();
        present("cameras") && present("images")
    };
    MODEL_FOLDERS.iter().map(|name| root.join(name)).find(holds_model)
}

/// Reads poses, intrinsics and points, and finds the images.
pub(super) fn read_capture(root: &Path, options: &DatasetOptions) -> Result<Capture, ReadError> {
    let folder = model_folder(root).ok_or_else(|| {
        let expected = "cameras and images (.bin or .txt) in sparse/0, sparse, colmap/sparse/0 or the folder itself";
        ReadError::new(root, ParseError::value("COLMAP model", expected, "none"))
    })?;
    let cameras = read_part(&folder, "cameras", binary::parse_cameras, text::parse_cameras)?;
    let mut images = read_part(&folder, "images", binary::parse_images, text::parse_images)?;
    images.sort_by(|a, b| a.name.cmp(&b.name));

    let photographs = ImageFolder::choose(root, &root.join("images"), options)?;
    let names: Vec<&str> = images.iter().map(|image| image.name.as_str()).collect();
    let matched = match_images(&photographs.path, &names)?;
    let mut capture = Capture { points: read_points(&folder)?, ..Capture::default() };
    capture.warnings.extend(matched.warning);
    for (image, path) in images.iter().zip(matched.paths) {
        let mut posed = pose(image, &cameras).in_file(&folder)?;
        posed.image_path = path;
        posed.reduction = photographs.reduction;
        capture.images.push(posed);
    }
    if capture.points.is_none() {
        capture.warnings.push(format!("{}: no points3D file, no points", folder.display()));
    }
    Ok(capture)
}

/// The sparse points of a reconstruction, if it has any.
pub(super) fn read_points(model: &Path) -> Result<Option<WorldPoints>, ReadError> {
    if Part::find(model, "points3D").is_none() {
        return Ok(None);
    }
    read_part(model, "points3D", binary::parse_points, text::parse_points).map(Some)
}

fn pose(image: &ModelImage, cameras: &ModelCameras) -> Result<PosedImage, ParseError> {
    let camera = cameras.get(&image.camera_id).ok_or_else(|| {
        let field = format!("camera of image {}", printable(&image.name, 120));
        ParseError::value(field, "an id in the cameras file", image.camera_id)
    })?;
    Ok(PosedImage {
        name: image.name.clone(),
        camera: Camera {
            width: camera.width,
            height: camera.height,
            fx: camera.fx,
            fy: camera.fy,
            cx: camera.cx,
            cy: camera.cy,
            world_to_camera: image.world_to_camera,
        },
        distortion: camera.distortion,
        ..PosedImage::default()
    })
}

/// One file of a reconstruction.
struct Part {
    path: PathBuf,
    is_binary: bool,
}

impl Part {
    /// The binary file of that name, or else the text file.
    fn find(folder: &Path, name: &str) -> Option<Self> {
        [("bin", true), ("txt", false)].into_iter().find_map(|(extension, is_binary)| {
            let path = folder.join(format!("{name}.{extension}"));
            path.is_file().then_some(Self { path, is_binary })
        })
    }
}

fn read_part<T>(
    folder: &Path,
    name: &str,
    parse_binary: fn(&[u8]) -> Result<T, ParseError>,
    parse_text: fn(&[u8]) -> Result<T, ParseError>,
) -> Result<T, ReadError> {
    let part = Part::find(folder, name).ok_or_else(|| {
        ReadError::new(folder.join(name), ParseError::value("file", ".bin or .txt", "none"))
    })?;
    let bytes = open::map(&part.path).in_file(&part.path)?;
    let parse = if part.is_binary { parse_binary } else { parse_text };
    parse(&bytes).in_file(&part.path)
}
