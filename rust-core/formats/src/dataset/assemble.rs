//! From posed images, as every layout gives them, to a dataset.

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3};
use trapeze_scene::Camera;

use super::decode::image_size;
use super::image_folder::ImageListing;
use super::points::{PointCloud, WorldPoints};
use super::{Dataset, DatasetFormat, DatasetOptions, Distortion, Split, View};
use crate::error::{InFile, printable};
use crate::recentre::recentre_f64;
use crate::{ParseError, ReadError};

/// What a layout says.
#[derive(Debug, Default)]
pub(super) struct Capture {
    pub(super) images: Vec<PosedImage>,
    pub(super) points: Option<WorldPoints>,
    pub(super) warnings: Vec<String>,
}

/// An image with its pose, before its file was opened.
#[derive(Debug)]
pub(super) struct PosedImage {
    pub(super) name: String,
    /// At the size for which the file states the intrinsics.
    pub(super) camera: Camera,
    pub(super) distortion: Distortion,
    pub(super) time: Option<f32>,
    pub(super) depth_range: Option<[f64; 2]>,
    pub(super) image_path: PathBuf,
    pub(super) reduction: u32,
    pub(super) mask_path: Option<PathBuf>,
    /// Set where the dataset itself says it.
    pub(super) split: Option<Split>,
}

impl Default for PosedImage {
    fn default() -> Self {
        let world_to_camera = DMat4::IDENTITY;
        Self {
            name: String::new(),
            camera: Camera {
                width: 0,
                height: 0,
                fx: 0.0,
                fy: 0.0,
                cx: 0.0,
                cy: 0.0,
                world_to_camera,
            },
            distortion: Distortion::None,
            time: None,
            depth_range: None,
            image_path: PathBuf::new(),
            reduction: 1,
            mask_path: None,
            split: None,
        }
    }
}

/// Reads the image headers, fits the cameras to them and chooses what is held out.
pub(super) fn assemble(
    root: &Path,
    format: DatasetFormat,
    capture: Capture,
    options: &DatasetOptions,
) -> Result<Dataset, ReadError> {
    if capture.images.is_empty() {
        return Err(ReadError::new(root, ParseError::value("images", "at least one", "none")));
    }
    let mut warnings = capture.warnings;
    let masks = match &options.mask_folder {
        Some(folder) => Some((root.join(folder), ImageListing::read(&root.join(folder))?)),
        None => None,
    };
    // A dataset that names its test views means them; the others are for training.
    let has_own_split = capture.images.iter().any(|image| image.split == Some(Split::Test));
    let mut views = Vec::with_capacity(capture.images.len());
    for (index, mut image) in capture.images.into_iter().enumerate() {
        let held_out = options.holdout.is_some_and(|every| every > 0 && index % every == 0);
        let split = match image.split {
            Some(split) if has_own_split => split,
            _ if held_out && !has_own_split => Split::Test,
            _ => Split::Train,
        };
        if let Some((folder, listing)) = &masks {
            let mask =
                listing.find_mask(&image.name).ok_or_else(|| no_mask(folder, &image.name))?;
            image.mask_path = Some(mask.to_path_buf());
        }
        if options.ignore_distortion {
            image.distortion = Distortion::None;
        }
        let size = image_size(&image.image_path)?;
        if index == 0 {
            warnings.extend(stretch_warning(&image, size));
        }
        views.push(view(image, size, split)?);
    }
    let mut points = capture.points;
    if points.as_mut().is_some_and(WorldPoints::replace_absent_colors) {
        warnings.push("the points have no colours (all black): mid grey is taken".into());
    }
    let (points, origin) = recentred(points, &views);
    Ok(Dataset { format, views, points, origin, warnings })
}

/// Points relative to the origin that they ask for; without points the cameras are asked.
fn recentred(points: Option<WorldPoints>, views: &[View]) -> (Option<PointCloud>, DVec3) {
    if let Some(WorldPoints { positions, colors }) = points
        && !positions.is_empty()
    {
        let (positions, origin) = recentre_f64(&positions);
        return (Some(PointCloud { positions, colors }), origin);
    }
    let centres: Vec<_> = views.iter().map(|view| view.camera.centre().to_array()).collect();
    (None, recentre_f64(&centres).1)
}

fn view(image: PosedImage, size: [u32; 2], split: Split) -> Result<View, ReadError> {
    let path = &image.image_path;
    if !image.distortion.is_finite() {
        let found = "NaN or infinity";
        return Err(ParseError::value("distortion", "finite numbers", found)).in_file(path);
    }
    if image.camera.width == 0 || image.camera.height == 0 {
        let found = format!("{} x {}", image.camera.width, image.camera.height);
        return Err(ParseError::value("camera size", "at least 1 x 1 pixel", found)).in_file(path);
    }
    let camera = fitted_camera(&image.camera, size, image.reduction);
    camera.validate().in_file(path)?;
    Ok(View {
        name: image.name,
        camera,
        distortion: image.distortion,
        reduction: image.reduction,
        time: image.time,
        depth_range: image.depth_range,
        image_path: image.image_path,
        mask_path: image.mask_path,
        split,
    })
}

/// The camera rescaled, along each axis, to the size of the image file, then to the reduced
/// image: whole blocks of pixels, so the intrinsics are divided by exactly the factor.
fn fitted_camera(camera: &Camera, [width, height]: [u32; 2], reduction: u32) -> Camera {
    let full = camera.resized(width, height);
    let factor = f64::from(reduction);
    Camera {
        width: width / reduction,
        height: height / reduction,
        fx: full.fx / factor,
        fy: full.fy / factor,
        cx: full.cx / factor,
        cy: full.cy / factor,
        world_to_camera: full.world_to_camera,
    }
}

/// Resizing changes the shape of an image by rounding only; more is a sign of a rotated one.
fn stretch_warning(image: &PosedImage, [width, height]: [u32; 2]) -> Option<String> {
    let along_x = f64::from(width) / f64::from(image.camera.width);
    let along_y = f64::from(height) / f64::from(image.camera.height);
    let is_close = (along_x / along_y - 1.0).abs() < 0.05;
    (!is_close).then(|| {
        format!(
            "{}: the image is {width} x {height}, its camera {} x {}: another shape (rotated by EXIF?)",
            image.image_path.display(),
            image.camera.width,
            image.camera.height,
        )
    })
}

fn no_mask(folder: &Path, name: &str) -> ReadError {
    let expected = "a file of the image's name, that name with .png, or its stem";
    ReadError::new(
        folder,
        ParseError::value(format!("mask of {}", printable(name, 120)), expected, "none"),
    )
}
