//! Which files are the images that a pose file names.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::DatasetOptions;
use crate::error::{InFile, printable};
use crate::{ParseError, ReadError};

/// Divisors of the image folders that are looked for: `images`, `images_2`, …
const DIVISORS: [u32; 5] = [1, 2, 4, 8, 16];
/// Sub-folders of an image folder that are searched.
const MAX_DEPTH: usize = 4;

/// A folder of images, and by how much they are to be reduced when they are loaded.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ImageFolder {
    pub(super) path: PathBuf,
    /// How many times smaller than the full-size images those of the folder are.
    pub(super) divisor: u32,
    /// By how much they are still to be reduced.
    pub(super) reduction: u32,
}

impl ImageFolder {
    /// The folder that the options ask for: the one they name, or the best of `full_size` and its
    /// siblings `…_2` to `…_16`.
    pub(super) fn choose(
        root: &Path,
        full_size: &Path,
        options: &DatasetOptions,
    ) -> Result<Self, ReadError> {
        let candidates: Vec<(u32, PathBuf)> = match &options.image_folder {
            Some(name) => vec![(divisor_of(name), root.join(name))],
            // Siblings of the dataset itself are other datasets.
            None if full_size == root => vec![(1, root.to_path_buf())],
            None => DIVISORS.iter().map(|&d| (d, with_divisor(full_size, d))).collect(),
        };
        let present: Vec<_> = candidates.iter().filter(|(_, path)| path.is_dir()).collect();
        let Some((smallest_divisor, largest_images)) = present.first() else {
            return Err(Self::absent(root, &candidates));
        };
        let chosen = |divisor: u32, path: &Path, reduction| {
            Ok(Self { path: path.to_path_buf(), divisor, reduction })
        };
        let Some(downscale) = options.downscale else {
            return chosen(*smallest_divisor, largest_images, 1);
        };
        let fitting = present.iter().rev().find(|(d, _)| downscale > 0 && downscale % d == 0);
        if let Some((divisor, path)) = fitting {
            return chosen(*divisor, path, downscale / divisor);
        }
        let largest = file_name(largest_images);
        let expected =
            format!("a multiple of {smallest_divisor} (the largest images are in {largest})");
        Err(ReadError::new(root, ParseError::value("downscale", expected, downscale)))
    }

    fn absent(root: &Path, candidates: &[(u32, PathBuf)]) -> ReadError {
        let names: Vec<_> = candidates.iter().map(|(_, path)| file_name(path)).collect();
        let expected = format!("a folder {}", printable(names.join(" or "), 120));
        ReadError::new(root, ParseError::value("images", expected, "none"))
    }
}

fn with_divisor(full_size: &Path, divisor: u32) -> PathBuf {
    if divisor == 1 {
        return full_size.to_path_buf();
    }
    let mut name = full_size.file_name().unwrap_or_default().to_os_string();
    name.push(format!("_{divisor}"));
    full_size.with_file_name(name)
}

/// The divisor that the name of a folder states; 1 where it states none.
fn divisor_of(name: &str) -> u32 {
    let suffix = name.rsplit_once('_').and_then(|(_, digits)| digits.parse().ok());
    suffix.filter(|&divisor| divisor > 0).unwrap_or(1)
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The image files of a folder by their path relative to it, `/` between folders, in byte order.
#[derive(Debug, Default)]
pub(super) struct ImageListing {
    by_name: BTreeMap<String, PathBuf>,
    /// Name without extension → its files.
    by_stem: BTreeMap<String, Vec<PathBuf>>,
}

impl ImageListing {
    pub(super) fn read(folder: &Path) -> Result<Self, ReadError> {
        let mut listing = Self::default();
        listing.add(folder, "", MAX_DEPTH)?;
        Ok(listing)
    }

    fn add(&mut self, folder: &Path, prefix: &str, depth: usize) -> Result<(), ReadError> {
        for entry in std::fs::read_dir(folder).in_file(folder)? {
            let path = entry.in_file(folder)?.path();
            let Some(file_name) = path.file_name().and_then(OsStr::to_str) else { continue };
            if file_name.starts_with('.') {
                continue;
            }
            let name = format!("{prefix}{file_name}");
            if path.is_dir() {
                if depth > 0 {
                    self.add(&path, &format!("{name}/"), depth - 1)?;
                }
            } else if has_image_extension(&name) {
                self.by_stem.entry(stem(&name).to_owned()).or_default().push(path.clone());
                self.by_name.insert(name, path);
            }
        }
        Ok(())
    }

    pub(super) fn len(&self) -> usize {
        self.by_name.len()
    }

    /// Names and files, in name order.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&str, &Path)> {
        self.by_name.iter().map(|(name, path)| (name.as_str(), path.as_path()))
    }

    /// The file of that name, or else the only one of that stem.
    fn find(&self, name: &str) -> Option<&Path> {
        if let Some(path) = self.by_name.get(name) {
            return Some(path);
        }
        match self.by_stem.get(stem(name)).map(Vec::as_slice) {
            Some([path]) => Some(path),
            _ => None,
        }
    }

    /// The mask of an image: its name, its name with `.png` appended (COLMAP), or its stem.
    pub(super) fn find_mask(&self, image_name: &str) -> Option<&Path> {
        let appended = self.by_name.get(&format!("{image_name}.png")).map(PathBuf::as_path);
        appended.or_else(|| self.find(image_name))
    }
}

fn has_image_extension(name: &str) -> bool {
    let extension = Path::new(name).extension().and_then(OsStr::to_str).unwrap_or_default();
    ["png", "jpg", "jpeg", "webp"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// The name without its extension, folders kept.
fn stem(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((stem, extension)) if !extension.contains('/') => stem,
        _ => name,
    }
}

/// Files for names that are in byte order.
#[derive(Debug, PartialEq)]
pub(super) struct MatchedImages {
    /// One file for each name.
    pub(super) paths: Vec<PathBuf>,
    /// Set where the names did not fit and the order was taken instead.
    pub(super) warning: Option<String>,
}

/// Finds the file of each name: by name, by stem, or, where no name fits and there are as many
/// files as names, by order.
///
/// `names` must be sorted.
pub(super) fn match_images(folder: &Path, names: &[&str]) -> Result<MatchedImages, ReadError> {
    let listing = ImageListing::read(folder)?;
    let found: Vec<Option<&Path>> = names.iter().map(|name| listing.find(name)).collect();
    if let Some(paths) = found.iter().map(|path| path.map(Path::to_path_buf)).collect() {
        return Ok(MatchedImages { paths, warning: None });
    }
    if found.iter().all(Option::is_none) && listing.len() == names.len() {
        let paths: Vec<_> = listing.by_name.values().cloned().collect();
        let warning = format!(
            "{}: no image has a name from the pose file; the {} images are taken in order, {} as {}",
            folder.display(),
            names.len(),
            file_name(&paths[0]),
            names[0],
        );
        return Ok(MatchedImages { paths, warning: Some(warning) });
    }
    let missing =
        names.iter().zip(&found).filter(|(_, path)| path.is_none()).map(|(name, _)| *name);
    Err(missing_images(folder, missing))
}

/// An error that names the first few missing images and counts the rest.
pub(super) fn missing_images<'a>(
    folder: &Path,
    missing: impl IntoIterator<Item = &'a str>,
) -> ReadError {
    const NAMED: usize = 3;
    let missing: Vec<_> = missing.into_iter().collect();
    let names = missing[..missing.len().min(NAMED)].join(", ");
    let mut field = format!("image {}", printable(names, 120));
    if missing.len() > NAMED {
        field.push_str(&format!(" and {} more", missing.len() - NAMED));
    }
    let expected = "a file of that name, or one with another extension";
    ReadError::new(folder, ParseError::value(field, expected, "none"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            let path = folder.path().join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, b"").unwrap();
        }
        folder
    }

    fn matched(files: &[&str], names: &[&str]) -> Result<(Vec<String>, bool), String> {
        let folder = folder_with(files);
        match_images(folder.path(), names)
            .map(|found| {
                let relative = |path: &PathBuf| {
                    path.strip_prefix(folder.path()).unwrap().to_string_lossy().into_owned()
                };
                (found.paths.iter().map(relative).collect(), found.warning.is_some())
            })
            .map_err(|error| error.to_string())
    }

    #[test]
    fn names_win_over_stems_and_stems_over_order() {
        let files = ["a.png", "b.JPG", "c/a.png", "notes.txt", ".hidden.png"];
        let names = ["a.png", "b.png", "c/a.jpg"];
        let expected = ["a.png", "b.JPG", "c/a.png"].map(str::to_owned).to_vec();
        assert_eq!(matched(&files, &names), Ok((expected, false)));
        let expected = ["a.png", "b.JPG", "c/a.png"].map(str::to_owned).to_vec();
        assert_eq!(matched(&files, &["X1", "X2", "X3"]), Ok((expected, true)));
    }

    #[test]
    fn missing_images_are_named() {
        let error = matched(&["a.png", "b.png"], &["a.png", "q.png"]).unwrap_err();
        assert!(error.contains("image q.png: expected a file"), "{error}");
        let names = ["1.png", "2.png", "3.png", "4.png", "5.png"];
        let error = matched(&["a.png"], &names).unwrap_err();
        assert!(error.contains("image 1.png, 2.png, 3.png and 2 more: "), "{error}");
    }

    #[test]
    fn two_files_of_one_stem_are_not_guessed_between() {
        let error = matched(&["a.png", "a.jpg", "b.png"], &["a.tif", "b.png"]).unwrap_err();
        assert!(error.contains("image a.tif"), "{error}");
    }

    fn chosen(files: &[&str], options: &DatasetOptions) -> Result<(String, u32), String> {
        let folder = folder_with(files);
        ImageFolder::choose(folder.path(), &folder.path().join("images"), options)
            .map(|chosen| (file_name(&chosen.path), chosen.reduction))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn the_folder_fits_the_requested_size() {
        let files = ["images/a.png", "images_4/a.png"];
        let downscale = |d| DatasetOptions { downscale: Some(d), ..DatasetOptions::default() };
        let folder = |name: &str, reduction| Ok((name.to_owned(), reduction));
        assert_eq!(chosen(&files, &DatasetOptions::default()), folder("images", 1));
        assert_eq!(chosen(&files[1..], &DatasetOptions::default()), folder("images_4", 1));
        assert_eq!(chosen(&files, &downscale(2)), folder("images", 2));
        assert_eq!(chosen(&files, &downscale(4)), folder("images_4", 1));
        assert_eq!(chosen(&files, &downscale(8)), folder("images_4", 2));
        for refused in [0, 2, 6] {
            let error = chosen(&files[1..], &downscale(refused)).unwrap_err();
            assert!(error.contains("downscale: expected a multiple of 4"), "{error}");
        }
        let named =
            DatasetOptions { image_folder: Some("images_4".into()), ..DatasetOptions::default() };
        assert_eq!(chosen(&files, &named), folder("images_4", 1));
        let error = chosen(&["other/a.png"], &DatasetOptions::default()).unwrap_err();
        assert!(error.contains("images: expected a folder images"), "{error}");
    }
}
