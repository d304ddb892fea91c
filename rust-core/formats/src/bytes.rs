//! A cursor over untrusted bytes: every read names its field and is checked against what is left.

use crate::ParseError;

/// Reads little-endian values from a byte slice.
#[derive(Clone, Debug)]
pub(crate) struct ByteReader<'a> {
    rest: &'a [u8],
}

impl<'a> ByteReader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Bytes that have not been read.
    pub(crate) fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// The bytes that have not been read, without reading them.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// The next `count` bytes.
    pub(crate) fn take(&mut self, count: usize, field: &str) -> Result<&'a [u8], ParseError> {
        let (taken, rest) =
            self.rest.split_at_checked(count).ok_or_else(|| self.truncated(count as u64, field))?;
        self.rest = rest;
        Ok(taken)
    }

    /// The next `count` elements of `size` bytes each; the product is checked, so a hostile count
    /// cannot wrap, and nothing is allocated before it is known to be there.
    pub(crate) fn take_array(
        &mut self,
        count: u64,
        size: usize,
        field: &str,
    ) -> Result<&'a [u8], ParseError> {
        let bytes = count.saturating_mul(size as u64);
        match usize::try_from(bytes) {
            Ok(bytes) => self.take(bytes, field),
            Err(_) => Err(self.truncated(bytes, field)),
        }
    }

    /// The bytes before the next newline, which is skipped.
    pub(crate) fn take_line(&mut self, field: &str) -> Result<&'a [u8], ParseError> {
        let length = self.rest.iter().position(|&byte| byte == b'\n');
        let length = length.ok_or_else(|| self.truncated(self.rest.len() as u64 + 1, field))?;
        let line = self.take(length, field)?;
        self.rest = &self.rest[1..];
        Ok(line)
    }

    pub(crate) fn u8(&mut self, field: &str) -> Result<u8, ParseError> {
        Ok(self.array::<1>(field)?[0])
    }

    pub(crate) fn u32(&mut self, field: &str) -> Result<u32, ParseError> {
        Ok(u32::from_le_bytes(self.array(field)?))
    }

    pub(crate) fn u64(&mut self, field: &str) -> Result<u64, ParseError> {
        Ok(u64::from_le_bytes(self.array(field)?))
    }

    /// Refuses bytes after the last field.
    pub(crate) fn expect_end(&self, field: &str) -> Result<(), ParseError> {
        if self.rest.is_empty() {
            return Ok(());
        }
        Err(ParseError::value(field, "end of file", format!("{} more bytes", self.rest.len())))
    }

    pub(crate) fn array<const N: usize>(&mut self, field: &str) -> Result<[u8; N], ParseError> {
        let bytes = self.take(N, field)?;
        let mut array = [0; N];
        array.copy_from_slice(bytes);
        Ok(array)
    }

    fn truncated(&self, expected: u64, field: &str) -> ParseError {
        ParseError::Truncated { field: field.into(), expected, found: self.rest.len() as u64 }
    }
}

/// Little-endian floats, whatever the alignment of the bytes.
///
/// `bytes` must be a multiple of four long, as [`ByteReader::take_array`] makes it.
pub(crate) fn f32s_from_le(bytes: &[u8]) -> impl ExactSizeIterator<Item = f32> + '_ {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_that_would_wrap_is_reported_as_truncated() {
        let mut reader = ByteReader::new(&[0; 16]);
        for count in [5, 1 << 32, 1 << 63, u64::MAX] {
            let error = reader.take_array(count, 4, "ids").unwrap_err().to_string();
            assert!(error.starts_with("ids: expected "), "{error}");
        }
        assert_eq!(reader.take_array(4, 4, "ids").unwrap().len(), 16);
        assert!(reader.expect_end("ids").is_ok());
    }
}
