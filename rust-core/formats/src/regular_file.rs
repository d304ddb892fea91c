//! Reading a whole file without trusting what is at its path.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use crate::error::InFile;
use crate::{ParseError, ReadError};

/// Opens a regular file (or a link to one) for reading and returns it with its length in bytes.
///
/// Opening a pipe would wait for a writer that may never come, and a device has no end, so the
/// kind is looked at before the file is opened.
///
/// # Errors
/// When there is no such file, it may not be read, or it is a folder, pipe or device.
pub(crate) fn open_regular_file(path: &Path) -> io::Result<(File, u64)> {
    let refused = |kind, found: &str| {
        Err(io::Error::new(kind, format!("expected a regular file, found {found}")))
    };
    let metadata = std::fs::metadata(path)?;
    if metadata.is_dir() {
        return refused(ErrorKind::IsADirectory, "a folder");
    }
    if !metadata.is_file() {
        return refused(ErrorKind::InvalidInput, "a pipe, socket or device");
    }
    Ok((File::open(path)?, metadata.len()))
}

/// The content of a regular file of at most `limit` bytes.
///
/// # Errors
/// As [`open_regular_file`], and when the file is longer than `limit`.
pub(crate) fn read_regular_file(path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
    let (file, length) = open_regular_file(path).in_file(path)?;
    let too_long = |found| {
        Err(ParseError::value("file length", format!("at most {limit} bytes"), found)).in_file(path)
    };
    if length > limit {
        return too_long(length);
    }
    let mut bytes = Vec::with_capacity(length as usize);
    // The file may grow while it is read.
    file.take(limit + 1).read_to_end(&mut bytes).in_file(path)?;
    if bytes.len() as u64 > limit {
        return too_long(bytes.len() as u64);
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_missing_files_are_one_line_errors() {
        let folder = tempfile::tempdir().unwrap();
        let error = read_regular_file(folder.path(), 10).unwrap_err().to_string();
        assert!(error.ends_with(": expected a regular file, found a folder"), "{error}");
        let missing = folder.path().join("missing.bin");
        let error = read_regular_file(&missing, 10).unwrap_err().to_string();
        assert!(error.contains("missing.bin") && !error.contains('\n'), "{error}");
    }

    #[test]
    fn a_file_over_the_limit_is_refused_and_one_at_the_limit_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ten");
        std::fs::write(&path, [7; 10]).unwrap();
        assert_eq!(read_regular_file(&path, 10).unwrap(), [7; 10]);
        let error = read_regular_file(&path, 9).unwrap_err().to_string();
        assert!(error.contains("at most 9 bytes, found 10"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_a_pipe_is_refused_without_waiting() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        std::fs::write(&file, b"content").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        assert_eq!(read_regular_file(&link, 100).unwrap(), b"content");

        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success());
        let error = read_regular_file(&pipe, 100).unwrap_err().to_string();
        assert!(error.contains("found a pipe, socket or device"), "{error}");
    }
}
