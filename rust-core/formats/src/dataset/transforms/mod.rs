//! `transforms.json` and its split form `transforms_train.json`, `transforms_test.json`.
//!
//! Written by Blender exports (NeRF, D-NeRF), Instant-NGP, Nerfstudio and NeRFCapture. Poses are
//! camera-to-world with OpenGL axes (x right, y up, z backwards). Intrinsics stand beside the
//! frames or in each frame; the frame's win.

mod lens;
mod schema;

use std::collections::{BTreeMap, HashSet};
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

use self::schema::{Extras, Frame, LensFields, TransformsFile, parse_transforms};
use super::assemble::{Capture, PosedImage};
use super::decode::image_size;
use super::image_folder::{ImageFolder, missing_images};
use super::{DatasetOptions, Split, WorldPoints};
use crate::error::InFile;
use crate::json::MAX_JSON_BYTES;
use crate::ply::parse_points;
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError, open};

const SINGLE_FILE: &str = "transforms.json";
const TRAINING_FILE: &str = "transforms_train.json";
const VALIDATION_FILE: &str = "transforms_val.json";
const TEST_FILE: &str = "transforms_test.json";

/// Extensions that a path without one is tried with.
const EXTENSIONS: [&str; 7] = ["png", "jpg", "jpeg", "PNG", "JPG", "JPEG", "webp"];

/// Whether a folder holds poses of this kind.
pub(super) fn is_present(root: &Path) -> bool {
    [SINGLE_FILE, TRAINING_FILE].iter().any(|name| root.join(name).is_file())
}

/// Reads poses, intrinsics and splits, and finds the images. `path` is a folder or a JSON file.
///
/// Of split files the test views are held out; where there are none the validation views are, and
/// else they are not read. The views of split files keep the files' order, those of a single file
/// are sorted by name.
pub(super) fn read_capture(path: &Path, options: &DatasetOptions) -> Result<Capture, ReadError> {
    let (root, single) = if path.is_file() {
        (path.parent().unwrap_or(Path::new("")), path.to_path_buf())
    } else {
        (path, path.join(SINGLE_FILE))
    };
    let mut reader = FrameReader { root, options, folders: BTreeMap::new() };
    let training = path.join(TRAINING_FILE);
    if !training.is_file() {
        return reader.read_single(&single);
    }
    let held_out = [TEST_FILE, VALIDATION_FILE].map(|name| root.join(name));
    let mut capture = reader.read_all(&training, Some(Split::Train))?;
    if let Some(test) = held_out.iter().find(|path| path.is_file()) {
        capture.images.extend(reader.read_all(test, Some(Split::Test))?.images);
    }
    Ok(capture)
}

/// Finds the images of frames, remembering which folder was chosen for each folder named.
struct FrameReader<'a> {
    root: &'a Path,
    options: &'a DatasetOptions,
    folders: BTreeMap<PathBuf, ImageFolder>,
}

impl FrameReader<'_> {
    /// A file that may name its own splits.
    fn read_single(&mut self, path: &Path) -> Result<Capture, ReadError> {
        let file = read_file(path)?;
        let splits = Splits::of(&file).in_file(path)?;
        let mut capture = self.capture(path, &file, |frame| splits.of_frame(frame))?;
        capture.images.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(capture)
    }

    /// A file whose frames are all of one split.
    fn read_all(&mut self, path: &Path, split: Option<Split>) -> Result<Capture, ReadError> {
        self.capture(path, &read_file(path)?, |_| Membership::Member(split))
    }

    fn capture(
        &mut self,
        path: &Path,
        file: &TransformsFile,
        membership: impl Fn(&Frame) -> Membership,
    ) -> Result<Capture, ReadError> {
        let mut capture = Capture { points: self.read_points(file)?, ..Capture::default() };
        let mut missing = Vec::new();
        for (index, (frame, lens)) in file.frames.iter().enumerate() {
            let Membership::Member(split) = membership(frame) else { continue };
            let Some((folder, image_path)) = self.find_image(&frame.file_path)? else {
                missing.push(frame.file_path.as_str());
                continue;
            };
            let size = image_size(&image_path)?.map(|side| side.saturating_mul(folder.divisor));
            let mut image = posed_image(frame, lens, size)
                .map_err(|error| error.within(&format!("frames[{index}]")))
                .in_file(path)?;
            image.image_path = image_path;
            image.reduction = folder.reduction;
            image.split = split;
            image.mask_path = frame.mask_path.as_ref().map(|mask| self.root.join(mask));
            capture.images.push(image);
        }
        if !missing.is_empty() {
            return Err(missing_images(self.root, missing));
        }
        Ok(capture)
    }

    /// Nerfstudio's sparse points, which are in the coordinates of the poses.
    fn read_points(&self, file: &TransformsFile) -> Result<Option<WorldPoints>, ReadError> {
        let Some(name) = &file.extras.ply_file_path else { return Ok(None) };
        let path = self.root.join(name);
        let bytes = open::map(&path).in_file(&path)?;
        parse_points(&bytes).in_file(&path).map(Some)
    }

    /// The file of a frame, in the folder that it names or that folder's sibling of the wanted
    /// size.
    fn find_image(&mut self, file_path: &str) -> Result<Option<(ImageFolder, PathBuf)>, ReadError> {
        let named = self.root.join(file_path);
        let (Some(parent), Some(file_name)) = (named.parent(), named.file_name()) else {
            return Ok(None);
        };
        let folder = match self.folders.get(parent) {
            Some(folder) => folder.clone(),
            None => {
                let folder = ImageFolder::choose(self.root, parent, self.options)?;
                self.folders.insert(parent.to_path_buf(), folder.clone());
                folder
            }
        };
        Ok(existing_file(&folder.path, file_name).map(|path| (folder, path)))
    }
}

/// The file of that name, with an extension added, or with another extension.
fn existing_file(folder: &Path, file_name: &OsStr) -> Option<PathBuf> {
    let named = folder.join(file_name);
    let with_added = |extension: &&str| {
        let mut name = file_name.to_os_string();
        name.push(".");
        name.push(extension);
        folder.join(name)
    };
    let added = EXTENSIONS.iter().map(with_added);
    let replaced = EXTENSIONS.iter().map(|extension| named.with_extension(extension));
    std::iter::once(named.clone()).chain(added).chain(replaced).find(|path| path.is_file())
}

fn read_file(path: &Path) -> Result<TransformsFile, ReadError> {
    let bytes = read_regular_file(path, MAX_JSON_BYTES)?;
    parse_transforms(&bytes).in_file(path)
}

fn posed_image(
    frame: &Frame,
    lens: &LensFields,
    full_size: [u32; 2],
) -> Result<PosedImage, ParseError> {
    let time = match frame.time.map(|time| time as f32) {
        Some(time) if !time.is_finite() => {
            return Err(ParseError::value("time", "a finite number", time));
        }
        time => time,
    };
    Ok(PosedImage {
        name: normalised(&frame.file_path),
        camera: lens.camera(full_size, frame.world_to_camera()?)?,
        distortion: lens.distortion()?,
        time,
        ..PosedImage::default()
    })
}

/// A path without `.` components, `/` between folders.
fn normalised(file_path: &str) -> String {
    let components = Path::new(file_path).components().filter(|c| *c != Component::CurDir);
    components.map(|c| c.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// Whether a frame is used, and for what.
#[derive(Clone, Copy)]
enum Membership {
    Member(Option<Split>),
    Excluded,
}

/// Nerfstudio's lists of file names. Validation views are the test views where no others are.
struct Splits {
    train: HashSet<String>,
    test: HashSet<String>,
}

impl Splits {
    fn of(file: &TransformsFile) -> Result<Self, ParseError> {
        let Extras { train_filenames, val_filenames, test_filenames, .. } = &file.extras;
        let held_out = if test_filenames.is_empty() { val_filenames } else { test_filenames };
        let known: HashSet<_> = file.frames.iter().map(|(f, _)| normalised(&f.file_path)).collect();
        let names =
            |list: &[String]| -> HashSet<_> { list.iter().map(|n| normalised(n)).collect() };
        let splits = Self { train: names(train_filenames), test: names(held_out) };
        match splits.train.union(&splits.test).filter(|name| !known.contains(*name)).min() {
            Some(name) => {
                Err(ParseError::value("train/val/test_filenames", "names of frames", name))
            }
            None => Ok(splits),
        }
    }

    fn of_frame(&self, frame: &Frame) -> Membership {
        let name = normalised(&frame.file_path);
        if self.test.contains(&name) {
            Membership::Member(Some(Split::Test))
        } else if self.train.contains(&name) {
            Membership::Member(Some(Split::Train))
        } else if self.train.is_empty() {
            Membership::Member(None)
        } else {
            Membership::Excluded
        }
    }
}
