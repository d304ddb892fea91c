//! NumPy's `.npz`: named arrays in a zip archive.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::InFile;
use crate::npy::{NpyArray, parse_npy};
use crate::regular_file::read_regular_file;
use crate::zip_members::ZipMembers;
use crate::{ParseError, ReadError};

/// Most bytes that an archive may decode to. The files that are read here are reference data of
/// a few megabytes.
const MAX_DECODED_BYTES: u64 = 1 << 30;

/// Parses a `.npz`, stored or compressed.
///
/// # Errors
/// [`ParseError`] names the member and what was not understood in it.
pub fn parse_npz(bytes: &[u8]) -> Result<BTreeMap<String, NpyArray>, ParseError> {
    let mut members = ZipMembers::open(bytes, MAX_DECODED_BYTES)?;
    let names: Vec<String> = members.names().collect();
    let mut arrays = BTreeMap::new();
    for member in names {
        let array = parse_npy(&members.read(&member)?).map_err(|error| error.within(&member))?;
        let name = member.strip_suffix(".npy").unwrap_or(&member);
        arrays.insert(name.to_owned(), array);
    }
    Ok(arrays)
}

/// Reads a `.npz`.
///
/// # Errors
/// [`ReadError`] with the path, the member and what was not understood in it.
pub fn read_npz(path: &Path) -> Result<BTreeMap<String, NpyArray>, ReadError> {
    parse_npz(&read_regular_file(path, MAX_DECODED_BYTES)?).in_file(path)
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Write};

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;
    use crate::npy::NpyValues;

    fn npz(members: &[(&str, &[u8])]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in members {
            writer.start_file(*name, SimpleFileOptions::default()).unwrap();
            writer.write_all(content).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    fn npy(values: &[u8]) -> Vec<u8> {
        let header =
            format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({},), }}\n", values.len());
        let length = (header.len() as u16).to_le_bytes();
        [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), values].concat()
    }

    #[test]
    fn arrays_have_the_names_that_numpy_gave_them() {
        let bytes = npz(&[("t0.5.npy", &npy(&[1, 2])), ("index.npy", &npy(&[]))]);
        let arrays = parse_npz(&bytes).unwrap();
        assert_eq!(arrays.keys().collect::<Vec<_>>(), ["index", "t0.5"]);
        assert_eq!(arrays["t0.5"].values, NpyValues::U8(vec![1, 2]));
    }

    #[test]
    fn a_bad_array_is_refused_by_the_member_name() {
        let error = parse_npz(&npz(&[("a.npy", b"no")])).unwrap_err().to_string();
        assert!(error.starts_with("a.npy.magic: expected 6 bytes, found 2"), "{error}");
        let error = parse_npz(b"\x93NUMPY").unwrap_err().to_string();
        assert!(error.starts_with("zip archive: expected a readable directory"), "{error}");
    }
}
