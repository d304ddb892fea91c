//! Where `meta.json` and the images come from: a folder or a zip archive.

use std::path::{Component, Path, PathBuf};

use crate::ParseError;
use crate::regular_file::read_regular_file;
use crate::zip_members::ZipMembers;

/// Most bytes of one file of a folder, far above any image of 2³¹ bytes of pixels.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Gives the content of the files of a scene by name.
pub(super) trait Source {
    /// The whole file called `name`, which comes from the description and is not trusted.
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ParseError>;
}

/// The files of a folder.
pub(super) struct Folder {
    path: PathBuf,
}

impl Folder {
    pub(super) fn new(path: &Path) -> Self {
        Self { path: path.into() }
    }
}

impl Source for Folder {
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ParseError> {
        read_regular_file(&self.path.join(plain_file_name(name)?), MAX_FILE_BYTES)
            .map_err(|error| ParseError::value(name, "a readable file", error.source))
    }
}

/// Refuses a name that leads out of the folder, on any operating system.
fn plain_file_name(name: &str) -> Result<&str, ParseError> {
    let mut components = Path::new(name).components();
    match (components.next(), components.next()) {
        (Some(Component::Normal(only)), None)
            if only == name && !name.contains(['/', '\\', ':']) =>
        {
            Ok(name)
        }
        _ => Err(ParseError::value("files", "a plain file name", name)),
    }
}

impl Source for ZipMembers<'_> {
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ParseError> {
        self.read(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_out_of_the_folder_are_refused() {
        for name in [
            "",
            ".",
            "..",
            "/etc/passwd",
            "../means_l.webp",
            "a/b.webp",
            "a\\b.webp",
            "C:x",
            "./x",
            "x/",
            "x/.",
        ] {
            let error = plain_file_name(name).unwrap_err().to_string();
            assert!(error.starts_with("files: expected a plain file name"), "{error}");
        }
        assert!(plain_file_name("means_l.webp").is_ok());
        assert!(plain_file_name("..means.webp").is_ok());
    }
}
