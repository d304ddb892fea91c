//! What a path leads to: which of the formats, by its name and its first bytes.

use std::io::Read;
use std::path::Path;

use crate::regular_file::open_regular_file;
use crate::{ParseError, ReadError};

/// A way to store splats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplatFormat {
    /// INRIA/TRASE or plain PLY; the reader tells compressed files by their header.
    Ply,
    /// SuperSplat compressed PLY.
    CompressedPly,
    /// 32 bytes per splat.
    Splat,
    /// Niantic SPZ.
    Spz,
    /// PlayCanvas SOG, one zip file.
    Sog,
}

/// Endings of file names, the longer ones first.
const ENDINGS: [(&str, SplatFormat); 5] = [
    (".compressed.ply", SplatFormat::CompressedPly),
    (".ply", SplatFormat::Ply),
    (".splat", SplatFormat::Splat),
    (".spz", SplatFormat::Spz),
    (".sog", SplatFormat::Sog),
];

impl SplatFormat {
    /// The format that a file name ends in, whatever its case.
    #[must_use]
    pub fn of_name(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        ENDINGS.into_iter().find(|(ending, _)| name.ends_with(ending)).map(|(_, format)| format)
    }

    /// The format of an existing file: by its first bytes, and for `.splat` files, which have no
    /// mark of their own, by name.
    pub(crate) fn of_file(path: &Path) -> Result<Self, ReadError> {
        let in_file = |error: ParseError| ReadError::new(path, error);
        let (mut file, _) = open_regular_file(path).map_err(|e| in_file(e.into()))?;
        let mut start = Vec::new();
        file.by_ref().take(4).read_to_end(&mut start).map_err(|e| in_file(e.into()))?;
        match start[..] {
            [b'p', b'l', b'y', ..] => Ok(Self::Ply),
            // gzip (SPZ 2 and 3), or SPZ 4's own mark.
            [0x1f, 0x8b, ..] | [b'N', b'G', b'S', b'P'] => Ok(Self::Spz),
            [b'P', b'K', 3, 4] => Ok(Self::Sog),
            _ => Self::of_name(path).ok_or_else(|| {
                let expected =
                    "a splat file (.ply, .compressed.ply, .splat, .spz, .sog) or a scene folder";
                in_file(ParseError::value("format", expected, format!("{start:02x?}")))
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_recognised_by_their_longest_ending() {
        let of = |name: &str| SplatFormat::of_name(Path::new(name));
        assert_eq!(of("a/scene.COMPRESSED.ply"), Some(SplatFormat::CompressedPly));
        assert_eq!(of("scene.ply"), Some(SplatFormat::Ply));
        assert_eq!(of("x.splat"), Some(SplatFormat::Splat));
        assert_eq!(of("x.spz"), Some(SplatFormat::Spz));
        assert_eq!(of("folder"), None);
    }

    #[test]
    fn the_first_bytes_decide_and_not_the_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("misnamed.splat");
        std::fs::write(&path, b"ply\nformat").unwrap();
        assert_eq!(SplatFormat::of_file(&path).unwrap(), SplatFormat::Ply);
        let path = folder.path().join("unknown.bin");
        std::fs::write(&path, b"????").unwrap();
        let message = SplatFormat::of_file(&path).unwrap_err().to_string();
        assert!(message.contains("unknown.bin: format: expected a splat file"), "{message}");
    }
}
