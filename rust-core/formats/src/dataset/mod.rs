//! Training datasets: posed photographs, and the sparse points that came with the poses.
//!
//! Five families of layouts are read: [COLMAP](DatasetFormat::Colmap), LLFF's
//! [`poses_bounds.npy`](DatasetFormat::Llff), the [`transforms.json`](DatasetFormat::Transforms) of
//! Blender, D-NeRF, Nerfstudio, Instant-NGP and NeRFCapture, and the exports of the phone apps
//! [Polycam](DatasetFormat::Polycam) and [Record3D](DatasetFormat::Record3d). Whatever the layout
//! says, a [`View`] is a pinhole camera in OpenCV axes for the image that [`load_image`] returns.
//!
//! # What happens to an image
//! Decoded to 8 bits a channel (16-bit files are rounded), EXIF orientation ignored as COLMAP
//! ignores it; then freed of lens distortion, at its own size and for the pinhole camera with the
//! same fx, fy, cx, cy; then reduced by the whole factor that is left between the image folder and
//! [`DatasetOptions::downscale`]. Pixels that the photograph does not cover get weight 0.

mod assemble;
mod colmap;
mod decode;
mod distortion;
mod image;
mod image_cache;
mod image_folder;
mod llff;
mod points;
mod polycam;
mod pose;
mod record3d;
mod resample;
mod transforms;

use std::path::{Path, PathBuf};

use glam::DVec3;
use trapeze_scene::Camera;

pub use self::decode::load_image;
pub use self::distortion::{Distortion, Lens};
pub use self::image::Image;
pub use self::image_cache::ImageCache;
pub use self::points::PointCloud;
pub(crate) use self::points::WorldPoints;

use crate::{ParseError, ReadError};

/// Posed images, read but not decoded, and what is known about the scene they show.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// The layout that was read.
    pub format: DatasetFormat,
    /// Every image with its camera, in name order (`transforms_*.json`: in the files' order,
    /// training views first).
    pub views: Vec<View>,
    /// Sparse points, relative to [`origin`](Self::origin); `None` where there are none.
    pub points: Option<PointCloud>,
    /// World position of the coordinate zero that a scene trained on this dataset should use; zero
    /// unless single precision would lose detail (geographic coordinates).
    pub origin: DVec3,
    /// What was guessed while reading, one line each, to be shown to the user.
    pub warnings: Vec<String>,
}

impl Dataset {
    /// Indices of the views to train on.
    pub fn training_views(&self) -> impl Iterator<Item = usize> + '_ {
        self.views_of(Split::Train)
    }

    /// Indices of the views that are held out.
    pub fn test_views(&self) -> impl Iterator<Item = usize> + '_ {
        self.views_of(Split::Test)
    }

    fn views_of(&self, split: Split) -> impl Iterator<Item = usize> + '_ {
        (0..self.views.len()).filter(move |&index| self.views[index].split == split)
    }

    /// The camera of a view in the coordinates of [`points`](Self::points): relative to
    /// [`origin`](Self::origin).
    ///
    /// # Panics
    /// When there is no view of that index.
    #[must_use]
    pub fn local_camera(&self, view: usize) -> Camera {
        self.views[view].camera.relative_to(self.origin)
    }
}

/// One image and its camera.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The name that the pose file gives, `/` between folders.
    pub name: String,
    /// Pinhole camera of the image as [`load_image`] returns it, in world coordinates.
    pub camera: Camera,
    /// Distortion of the photograph that loading removes.
    pub distortion: Distortion,
    /// Loading averages blocks of this many pixels squared into one.
    pub reduction: u32,
    /// Time of the exposure, for scenes that move.
    pub time: Option<f32>,
    /// Distances of the nearest and the farthest content from the camera, where they are known
    /// (LLFF), in world units.
    pub depth_range: Option<[f64; 2]>,
    /// The photograph.
    pub image_path: PathBuf,
    /// A grey image: 0 where a pixel is to be ignored.
    pub mask_path: Option<PathBuf>,
    /// Whether training may see the view.
    pub split: Split,
}

/// What a view is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Trained on.
    Train,
    /// Held out for the final evaluation.
    Test,
}

/// A family of dataset layouts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DatasetFormat {
    /// `cameras`, `images` and `points3D`, each `.bin` or `.txt`, in `sparse/0`, `sparse`,
    /// `colmap/sparse/0` or the dataset folder itself.
    Colmap,
    /// `poses_bounds.npy`: N × 17 doubles. Points of a COLMAP model beside it are used.
    Llff,
    /// `transforms.json`, or `transforms_train.json` with `transforms_test.json`.
    Transforms,
    /// Polycam's raw export: `keyframes/corrected_cameras`, or `keyframes/cameras`.
    Polycam,
    /// Record3D's folder export: `metadata.json` and `rgb`.
    Record3d,
}

/// How a dataset is to be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DatasetOptions {
    /// The layout; `None` takes the first of `transforms*.json`, COLMAP, `poses_bounds.npy`,
    /// Polycam and Record3D that is there.
    pub format: Option<DatasetFormat>,
    /// Leave lens distortion in the images and out of the cameras, as tools do that know only
    /// pinhole cameras.
    pub ignore_distortion: bool,
    /// Folder of the images, relative to the dataset; `None` looks for `images`, `images_2`,
    /// `images_4`, `images_8` and `images_16` (transforms: the named folder, with these suffixes).
    pub image_folder: Option<String>,
    /// Size of the images relative to the full-size ones, as a divisor; `None` takes the largest
    /// images present as they are. Where the folder of that size is missing, the next larger one
    /// is reduced by averaging.
    pub downscale: Option<u32>,
    /// Folder of masks, relative to the dataset: an image's mask has its name, its name with
    /// `.png` appended, or its stem. Masks named in a `transforms.json` are used in any case.
    pub mask_folder: Option<String>,
    /// Every n-th view, from the first, is held out, unless the dataset names its own test views;
    /// `None` holds out nothing then.
    pub holdout: Option<usize>,
}

impl Default for DatasetOptions {
    /// Everything found by itself, distortion removed, every eighth view held out.
    fn default() -> Self {
        Self {
            format: None,
            ignore_distortion: false,
            image_folder: None,
            downscale: None,
            mask_folder: None,
            holdout: Some(8),
        }
    }
}

/// Reads the poses, points and image headers of a dataset: a folder, or a `transforms*.json` file.
///
/// # Errors
/// [`ReadError`] names the file and the field that cannot be used, or the images that are missing.
pub fn load_dataset(path: &Path, options: &DatasetOptions) -> Result<Dataset, ReadError> {
    let format = match options.format {
        Some(format) => format,
        None => detect(path)?,
    };
    let capture = match format {
        DatasetFormat::Colmap => colmap::read_capture(path, options)?,
        DatasetFormat::Llff => llff::read_capture(path, options)?,
        DatasetFormat::Transforms => transforms::read_capture(path, options)?,
        DatasetFormat::Polycam => polycam::read_capture(path, options)?,
        DatasetFormat::Record3d => record3d::read_capture(path, options)?,
    };
    assemble::assemble(path, format, capture, options)
}

fn detect(path: &Path) -> Result<DatasetFormat, ReadError> {
    if path.is_file() || transforms::is_present(path) {
        Ok(DatasetFormat::Transforms)
    } else if colmap::model_folder(path).is_some() {
        Ok(DatasetFormat::Colmap)
    } else if path.join(llff::FILE_NAME).is_file() {
        Ok(DatasetFormat::Llff)
    } else if polycam::folders(path).is_some() {
        Ok(DatasetFormat::Polycam)
    } else if record3d::is_present(path) {
        Ok(DatasetFormat::Record3d)
    } else {
        let expected = "transforms.json, transforms_train.json, a COLMAP model in sparse/0, \
                        poses_bounds.npy, keyframes/cameras or metadata.json with rgb";
        Err(ReadError::new(path, ParseError::value("dataset", expected, "none of them")))
    }
}
