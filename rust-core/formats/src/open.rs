//! Opening a file for a parser of byte slices.

use std::io;
use std::path::Path;

use memmap2::Mmap;

use crate::regular_file::open_regular_file;

/// The content of a file, mapped into memory: a parser touches only what it needs, and the pages
/// stay the operating system's to reclaim.
///
/// The file must not be cut short by another program while it is mapped: the operating system
/// answers an access to the missing part with a signal, for which no program of this kind has a
/// good answer. Our own writer replaces files by renaming, which leaves old mappings intact.
pub(crate) fn map(path: &Path) -> io::Result<Mmap> {
    let (file, _) = open_regular_file(path)?;
    // SAFETY: the mapping is private and read-only, and the bytes are read as plain integers, for
    // which every bit pattern is valid. That the file is not shortened meanwhile is the caller's
    // condition stated above.
    unsafe { Mmap::map(&file) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_refused_as_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let error = map(folder.path()).unwrap_err();
        assert!(error.to_string().contains("found a folder"), "{error}");
    }

    #[test]
    fn an_empty_file_has_no_bytes() {
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(map(file.path()).unwrap().is_empty());
    }

    #[test]
    fn a_mapping_outlives_an_atomic_replacement_of_its_file() {
        use std::io::Write;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.ply");
        crate::write_atomically(&path, |w| w.write_all(&[7; 100_000])).unwrap();
        let mapped = map(&path).unwrap();
        crate::write_atomically(&path, |w| w.write_all(b"short")).unwrap();
        assert!(mapped.iter().all(|&b| b == 7) && mapped.len() == 100_000);
    }
}
