//! The header of a `.npy`: a Python dictionary literal with exactly three keys.

use crate::ParseError;

use super::NpyValues;

/// More dimensions than NumPy itself allows an array to have.
const MAX_DIMENSIONS: usize = 64;

/// Types of elements that are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ElementType {
    F16,
    F32,
    F64,
    U8,
    U32,
    I32,
    I64,
}

impl ElementType {
    fn from_descr(descr: &str) -> Option<Self> {
        Some(match descr {
            "<f2" => Self::F16,
            "<f4" => Self::F32,
            "<f8" => Self::F64,
            "|u1" | "<u1" => Self::U8,
            "<u4" => Self::U32,
            "<i4" => Self::I32,
            "<i8" => Self::I64,
            _ => return None,
        })
    }

    pub(super) fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::F16 => 2,
            Self::F32 | Self::U32 | Self::I32 => 4,
            Self::F64 | Self::I64 => 8,
        }
    }
}

#[derive(Debug, PartialEq)]
pub(super) struct Header {
    pub(super) element: ElementType,
    pub(super) fortran_order: bool,
    pub(super) shape: Vec<usize>,
}

impl Header {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, ParseError> {
        let text = std::str::from_utf8(bytes)
            .map_err(|_| ParseError::value("header", "text", bytes.escape_ascii()))?;
        let mut literal = Literal { rest: text };
        let (mut element, mut fortran_order, mut shape) = (None, None, None);
        literal.expect("{")?;
        while !literal.skip("}") {
            let key = literal.text()?;
            literal.expect(":")?;
            match key {
                "descr" => element = Some(literal.element()?),
                "fortran_order" => fortran_order = Some(literal.boolean()?),
                "shape" => shape = Some(literal.shape()?),
                _ => {
                    let expected = "descr, fortran_order or shape";
                    return Err(ParseError::value("header", expected, key));
                }
            }
            if !literal.skip(",") {
                literal.expect("}")?;
                break;
            }
        }
        if !literal.rest.trim().is_empty() {
            return Err(ParseError::value("header", "nothing after }", literal.rest));
        }
        let missing = |key| ParseError::value(key, "a value in the header", "none");
        Ok(Self {
            element: element.ok_or_else(|| missing("descr"))?,
            fortran_order: fortran_order.ok_or_else(|| missing("fortran_order"))?,
            shape: shape.ok_or_else(|| missing("shape"))?,
        })
    }

    /// Number of elements. Checked without regard to extents of zero, so that every product of
    /// some of the extents fits as well.
    pub(super) fn element_count(&self) -> Result<u64, ParseError> {
        let non_zero = self.shape.iter().map(|&extent| extent.max(1) as u64);
        let product = non_zero.into_iter().try_fold(1_u64, u64::checked_mul).ok_or_else(|| {
            let found = format!("{:?}", self.shape);
            ParseError::value("shape", "less than 2^64 elements", found)
        })?;
        Ok(if self.shape.contains(&0) { 0 } else { product })
    }

    /// Elements that are stored with the first dimension fastest, rearranged.
    pub(super) fn to_c_order(&self, stored: NpyValues) -> NpyValues {
        match stored {
            NpyValues::F32(v) => NpyValues::F32(c_order(&self.shape, &v)),
            NpyValues::F64(v) => NpyValues::F64(c_order(&self.shape, &v)),
            NpyValues::U8(v) => NpyValues::U8(c_order(&self.shape, &v)),
            NpyValues::U32(v) => NpyValues::U32(c_order(&self.shape, &v)),
            NpyValues::I32(v) => NpyValues::I32(c_order(&self.shape, &v)),
            NpyValues::I64(v) => NpyValues::I64(c_order(&self.shape, &v)),
        }
    }
}

/// Walks the array in C order and picks each element from where Fortran order stored it.
fn c_order<T: Copy>(shape: &[usize], stored: &[T]) -> Vec<T> {
    let strides: Vec<usize> = shape
        .iter()
        .scan(1, |stride, &extent| {
            let own = *stride;
            *stride *= extent;
            Some(own)
        })
        .collect();
    let mut index = vec![0; shape.len()];
    let mut position = 0;
    let mut arranged = Vec::with_capacity(stored.len());
    for _ in 0..stored.len() {
        arranged.push(stored[position]);
        for axis in (0..shape.len()).rev() {
            index[axis] += 1;
            position += strides[axis];
            if index[axis] < shape[axis] {
                break;
            }
            position -= index[axis] * strides[axis];
            index[axis] = 0;
        }
    }
    arranged
}

/// A cursor over the few forms of Python literals that the header may have. Nothing nests, so
/// nothing recurses.
struct Literal<'a> {
    rest: &'a str,
}

impl<'a> Literal<'a> {
    fn skip(&mut self, token: &str) -> bool {
        let rest = self.rest.trim_start();
        let after = rest.strip_prefix(token);
        self.rest = after.unwrap_or(rest);
        after.is_some()
    }

    fn expect(&mut self, token: &str) -> Result<(), ParseError> {
        if self.skip(token) {
            return Ok(());
        }
        Err(ParseError::value("header", format!("\"{token}\""), self.rest))
    }

    fn text(&mut self) -> Result<&'a str, ParseError> {
        let quote = if self.skip("'") { '\'' } else { '"' };
        if quote == '"' {
            self.expect("\"")?;
        }
        let (text, rest) = self
            .rest
            .split_once(quote)
            .ok_or_else(|| ParseError::value("header", "a closing quote", self.rest))?;
        self.rest = rest;
        Ok(text)
    }

    fn element(&mut self) -> Result<ElementType, ParseError> {
        let expected = "<f2, <f4, <f8, |u1, <u4, <i4 or <i8";
        let refused = |found: &str| ParseError::value("descr", expected, found);
        // A structured type is a list, which is refused as a whole.
        let descr = self.text().map_err(|_| refused(self.rest))?;
        ElementType::from_descr(descr).ok_or_else(|| refused(descr))
    }

    fn boolean(&mut self) -> Result<bool, ParseError> {
        if self.skip("False") {
            return Ok(false);
        }
        if self.skip("True") {
            return Ok(true);
        }
        Err(ParseError::value("fortran_order", "True or False", self.rest))
    }

    fn shape(&mut self) -> Result<Vec<usize>, ParseError> {
        let mut shape = Vec::new();
        let refused = |found: &str| {
            let expected = format!("at most {MAX_DIMENSIONS} whole numbers in brackets");
            ParseError::value("shape", expected, found)
        };
        self.expect("(").map_err(|_| refused(self.rest))?;
        while !self.skip(")") {
            let rest = self.rest;
            let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
            let extent = rest[..digits].parse().map_err(|_| refused(rest))?;
            shape.push(extent);
            self.rest = &rest[digits..];
            if shape.len() > MAX_DIMENSIONS {
                return Err(refused(rest));
            }
            if !self.skip(",") {
                self.expect(")").map_err(|_| refused(self.rest))?;
                break;
            }
        }
        Ok(shape)
    }
}

/// The header of a C-ordered f32 array, padded so that the data starts at a multiple of 64 bytes.
pub(super) fn padded(shape: &[usize]) -> String {
    const PREFIX: usize = 10;
    let extents: String = shape.iter().map(|extent| format!("{extent}, ")).collect();
    let extents =
        if shape.len() == 1 { extents.trim_end() } else { extents.trim_end_matches(", ") };
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({extents}), }}");
    let length = (PREFIX + header.len() + 1).next_multiple_of(64) - PREFIX;
    format!("{header:<width$}\n", width = length - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_written_as_numpy_writes_them() {
        for (shape, text) in [
            (&[][..], "{'descr': '<f4', 'fortran_order': False, 'shape': (), }"),
            (&[7], "{'descr': '<f4', 'fortran_order': False, 'shape': (7,), }"),
            (&[2, 3], "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }"),
        ] {
            let header = padded(shape);
            assert_eq!(header.trim_end(), text);
            assert!(header.ends_with('\n') && (header.len() + 10).is_multiple_of(64));
            let parsed = Header::parse(header.as_bytes()).unwrap();
            assert_eq!(parsed.shape, shape);
        }
    }

    #[test]
    fn keys_may_come_in_any_order_and_must_all_be_there() {
        let parse = |text: &str| Header::parse(text.as_bytes());
        let header = parse("{ \"shape\":(3,4),'descr':'<i8' , 'fortran_order':True}  \n").unwrap();
        let expected = Header { element: ElementType::I64, fortran_order: true, shape: vec![3, 4] };
        assert_eq!(header, expected);
        for (text, expected) in [
            ("{'shape': (3,), 'descr': '<f4'}", "fortran_order: expected a value"),
            ("{'fortran_order': False, 'descr': '<f4'}", "shape: expected a value"),
            ("{'shape': (3,), 'fortran_order': False}", "descr: expected a value"),
            ("{'shape': (-3,)}", "shape: expected"),
            ("{'shape': (3 4)}", "shape: expected"),
            ("{'shape': (99999999999999999999,)}", "shape: expected"),
            ("{'shape': [3]}", "shape: expected"),
            ("{'descr': [('a', '<f4')]}", "descr: expected"),
            ("{'fortran_order': 1}", "fortran_order: expected True or False"),
            ("{'spam': 1}", "header: expected descr, fortran_order or shape, found spam"),
            ("{'shape", "header: expected a closing quote"),
            ("{} x", "header: expected nothing after }"),
        ] {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{text} gave {error}");
        }
    }
}
