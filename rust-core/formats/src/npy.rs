//! NumPy's `.npy`: one dense array, written for images and read for reference data.
//!
//! Our own few lines, because the crates for it parse the header with a recursive grammar (which
//! a header of nested brackets can overflow) and multiply shapes unchecked.
//! Format: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

mod header;

use std::io::Write;
use std::path::Path;

use half::f16;

use crate::bytes::ByteReader;
use crate::error::InFile;
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError, WriteError, write_atomically};
use header::{ElementType, Header};

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Largest `.npy` that is read: an 8K RGBA frame in double precision is half as long.
const MAX_NPY_BYTES: u64 = 2 << 30;

/// A dense array in C order (last dimension fastest), whatever the order in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct NpyArray {
    /// Extent of each dimension; empty for a single number.
    pub shape: Vec<usize>,
    /// The numbers.
    pub values: NpyValues,
}

/// Numbers of an array, in the narrowest type here that holds those of the file exactly.
#[derive(Clone, Debug, PartialEq)]
pub enum NpyValues {
    /// From `f2` and `f4`.
    F32(Vec<f32>),
    /// From `f8`.
    F64(Vec<f64>),
    /// From `u1`.
    U8(Vec<u8>),
    /// From `u4`.
    U32(Vec<u32>),
    /// From `i4`.
    I32(Vec<i32>),
    /// From `i8`.
    I64(Vec<i64>),
}

impl NpyValues {
    /// How many numbers there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
            Self::U8(v) => v.len(),
            Self::U32(v) => v.len(),
            Self::I32(v) => v.len(),
            Self::I64(v) => v.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers in double precision; only integers beyond 2⁵³ lose digits.
    #[must_use]
    pub fn to_f64(&self) -> Vec<f64> {
        match self {
            Self::F32(v) => v.iter().map(|&x| x.into()).collect(),
            Self::F64(v) => v.clone(),
            Self::U8(v) => v.iter().map(|&x| x.into()).collect(),
            Self::U32(v) => v.iter().map(|&x| x.into()).collect(),
            Self::I32(v) => v.iter().map(|&x| x.into()).collect(),
            Self::I64(v) => v.iter().map(|&x| x as f64).collect(),
        }
    }
}

/// Parses a `.npy` of versions 1 to 3 with elements `f2`, `f4`, `f8`, `u1`, `u4`, `i4` or `i8`,
/// little-endian.
///
/// # Errors
/// [`ParseError`] names the part of the header that is not understood, or the lengths expected and
/// found.
pub fn parse_npy(bytes: &[u8]) -> Result<NpyArray, ParseError> {
    let mut reader = ByteReader::new(bytes);
    let magic = reader.array::<6>("magic")?;
    if &magic != MAGIC {
        return Err(ParseError::value("magic", "\\x93NUMPY", magic.escape_ascii()));
    }
    let [major, minor] = reader.array::<2>("version")?;
    let header_length = match major {
        1 => reader.array::<2>("header length").map(u16::from_le_bytes)?.into(),
        2 | 3 => reader.u32("header length")?,
        _ => return Err(ParseError::value("version", "1 to 3", format!("{major}.{minor}"))),
    };
    let header = Header::parse(reader.take_array(header_length.into(), 1, "header")?)?;
    let count = header.element_count()?;
    let data = reader.take_array(count, header.element.bytes(), "array data")?;
    reader.expect_end("array data")?;
    let values = header.element.decode(data);
    let values = if header.fortran_order { header.to_c_order(values) } else { values };
    Ok(NpyArray { shape: header.shape, values })
}

/// Reads a `.npy`; see [`parse_npy`].
///
/// # Errors
/// [`ReadError`] with the path and what was not understood.
pub fn read_npy(path: &Path) -> Result<NpyArray, ReadError> {
    parse_npy(&read_regular_file(path, MAX_NPY_BYTES)?).in_file(path)
}

/// Writes f32 numbers in C order as a `.npy` of version 1.0.
///
/// # Panics
/// When the shape does not hold as many numbers as `values`.
///
/// # Errors
/// [`WriteError::Io`].
pub fn write_npy(path: &Path, shape: &[usize], values: &[f32]) -> Result<(), WriteError> {
    assert_eq!(shape.iter().product::<usize>(), values.len(), "shape {shape:?}");
    let header = header::padded(shape);
    write_atomically(path, |file| {
        file.write_all(MAGIC)?;
        file.write_all(&[1, 0])?;
        file.write_all(&(header.len() as u16).to_le_bytes())?;
        file.write_all(header.as_bytes())?;
        values.iter().try_for_each(|value| file.write_all(&value.to_le_bytes()))
    })
}

impl ElementType {
    /// The numbers in `data`, which is a whole number of elements long.
    fn decode(self, data: &[u8]) -> NpyValues {
        fn numbers<const N: usize, T>(data: &[u8], number: impl Fn([u8; N]) -> T) -> Vec<T> {
            data.as_chunks::<N>().0.iter().map(|&bytes| number(bytes)).collect()
        }
        match self {
            Self::F16 => NpyValues::F32(numbers(data, |b| f16::from_le_bytes(b).to_f32())),
            Self::F32 => NpyValues::F32(numbers(data, f32::from_le_bytes)),
            Self::F64 => NpyValues::F64(numbers(data, f64::from_le_bytes)),
            Self::U8 => NpyValues::U8(data.to_vec()),
            Self::U32 => NpyValues::U32(numbers(data, u32::from_le_bytes)),
            Self::I32 => NpyValues::I32(numbers(data, i32::from_le_bytes)),
            Self::I64 => NpyValues::I64(numbers(data, i64::from_le_bytes)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn npy(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn header(descr: &str, fortran: &str, shape: &str) -> String {
        format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
    }

    #[test]
    fn written_images_read_back_and_are_aligned() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.npy");
        for shape in [&[2, 3, 4][..], &[24], &[24, 1], &[]] {
            let values: Vec<f32> = (0..shape.iter().product()).map(|i| i as f32 - 0.5).collect();
            write_npy(&path, shape, &values).unwrap();
            let bytes = std::fs::read(&path).unwrap();
            // NumPy maps arrays whose data starts at a multiple of 64.
            assert_eq!((bytes.len() - values.len() * 4) % 64, 0);
            let array = read_npy(&path).unwrap();
            assert_eq!(array, NpyArray { shape: shape.into(), values: NpyValues::F32(values) });
        }
    }

    #[test]
    fn every_element_type_keeps_its_numbers() {
        let check = |descr: &str, data: &[u8], values: NpyValues| {
            let array = parse_npy(&npy(&header(descr, "False", "(2,)"), data)).unwrap();
            assert_eq!(array, NpyArray { shape: vec![2], values });
        };
        check("<f2", &[0x00, 0x3c, 0x01, 0x00], NpyValues::F32(vec![1.0, 2.0_f32.powi(-24)]));
        check("<f4", &[0, 0, 0, 0x40, 0, 0, 0x80, 0xbf], NpyValues::F32(vec![2.0, -1.0]));
        let doubles = [1.5_f64, -0.1].map(f64::to_le_bytes).concat();
        check("<f8", &doubles, NpyValues::F64(vec![1.5, -0.1]));
        check("|u1", &[3, 255], NpyValues::U8(vec![3, 255]));
        let integers = [7_u32, u32::MAX].map(u32::to_le_bytes).concat();
        check("<u4", &integers, NpyValues::U32(vec![7, u32::MAX]));
        let integers = [7_i32, -8].map(i32::to_le_bytes).concat();
        check("<i4", &integers, NpyValues::I32(vec![7, -8]));
        let integers = [i64::MAX, -9].map(i64::to_le_bytes).concat();
        check("<i8", &integers, NpyValues::I64(vec![i64::MAX, -9]));
    }

    #[test]
    fn fortran_order_becomes_c_order() {
        // [[0, 1, 2], [3, 4, 5]] stored by columns.
        let array = parse_npy(&npy(&header("|u1", "True", "(2, 3)"), &[0, 3, 1, 4, 2, 5])).unwrap();
        assert_eq!(array.values, NpyValues::U8(vec![0, 1, 2, 3, 4, 5]));
        // Element (i, j, k) of a 2 × 3 × 2 array holds 100 i + 10 j + k.
        let stored = [0, 100, 10, 110, 20, 120, 1, 101, 11, 111, 21, 121];
        let array = parse_npy(&npy(&header("|u1", "True", "(2, 3, 2)"), &stored)).unwrap();
        let expected = vec![0, 1, 10, 11, 20, 21, 100, 101, 110, 111, 120, 121];
        assert_eq!(array.values, NpyValues::U8(expected));
    }

    #[test]
    fn versions_two_and_three_have_a_longer_length_field() {
        for version in [2, 3] {
            let header = header("|u1", "False", "()");
            let mut bytes = b"\x93NUMPY".to_vec();
            bytes.extend([version, 0]);
            bytes.extend((header.len() as u32).to_le_bytes());
            bytes.extend(header.as_bytes());
            bytes.push(42);
            assert_eq!(parse_npy(&bytes).unwrap().values, NpyValues::U8(vec![42]));
        }
    }

    #[test]
    fn what_is_not_understood_is_refused_by_field() {
        let huge = "(4294967296, 4294967296, 4294967296)";
        for (bytes, expected) in [
            (b"PK\x03\x04\x00\x00\x00\x00".to_vec(), "magic: expected"),
            (b"\x93NUMPY\x04\x00".to_vec(), "version: expected 1 to 3, found 4.0"),
            (npy(&header(">f4", "False", "(1,)"), &[0; 4]), "descr: expected"),
            (npy(&header("|O", "False", "(1,)"), &[0; 8]), "descr: expected"),
            (npy(&header("<f4", "False", huge), &[0; 4]), "shape: expected"),
            (npy(&header("<f4", "False", "(4611686018427387904,)"), &[0; 4]), "array data: "),
            (npy(&header("<f4", "False", "(2,)"), &[0; 4]), "array data: expected 8 bytes"),
            (npy(&header("<f4", "False", "(1,)"), &[0; 5]), "array data: expected end of file"),
            (npy(&"(".repeat(60_000), &[]), "header: expected"),
        ] {
            let error = parse_npy(&bytes).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        // A zero among huge extents has no elements; it must not hide an overflow either.
        let empty = parse_npy(&npy(&header("<f4", "False", "(0, 3)"), &[])).unwrap();
        assert!(empty.values.is_empty());
    }
}
