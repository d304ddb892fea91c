//! Decompression that a small hostile file cannot turn into a full memory.

use std::io::Read;

use trapeze_scene::GEOMETRY_BYTES_PER_SPLAT;

use crate::ParseError;

/// What any file may unpack to, however small it is.
const FREE_BYTES: u64 = 16 << 20;
/// What a file may unpack to for each of its own bytes, beyond [`FREE_BYTES`].
const BYTES_PER_BYTE: u64 = 64;

/// The most bytes that a file of `compressed_bytes` may unpack to.
///
/// Deflate expands up to 1 : 1032, zstd and lossless WebP without any useful limit, and only on
/// constant data. From a compressed capture to the arrays of a scene it is about 1 : 10, with higher
/// SH bands that are all zero 1 : 30, so the limit refuses bombs and nothing else.
pub(crate) fn unpacked_limit(compressed_bytes: usize) -> u64 {
    (compressed_bytes as u64).saturating_mul(BYTES_PER_BYTE).saturating_add(FREE_BYTES)
}

/// Bytes of the arrays that `splats` become, with `sh_rest_coefficients` above band 0 per channel.
pub(crate) fn scene_bytes(splats: u64, sh_rest_coefficients: usize) -> u64 {
    splats.saturating_mul(GEOMETRY_BYTES_PER_SPLAT + 12 * sh_rest_coefficients as u64)
}

/// Refuses a claimed size before anything is allocated for it.
pub(crate) fn check_unpacked_size(
    claimed: u64,
    compressed_bytes: usize,
    field: &str,
) -> Result<(), ParseError> {
    let limit = unpacked_limit(compressed_bytes);
    if claimed <= limit {
        return Ok(());
    }
    Err(ParseError::value(
        field,
        format!("at most {limit} bytes unpacked from a file of {compressed_bytes} bytes"),
        format!("{claimed} bytes"),
    ))
}

/// The next `expected` bytes of a decompressor. The vector grows with the bytes that arrive, not
/// with the claim. `codec` names the compression in the error of a damaged stream.
pub(crate) fn read_exactly(
    decoder: &mut impl Read,
    expected: u64,
    codec: &str,
    field: &str,
) -> Result<Vec<u8>, ParseError> {
    let mut bytes = Vec::with_capacity(expected.min(FREE_BYTES) as usize);
    decoder.take(expected).read_to_end(&mut bytes).map_err(|e| damaged(codec, field, e))?;
    if (bytes.len() as u64) < expected {
        let found = bytes.len() as u64;
        return Err(ParseError::Truncated { field: field.into(), expected, found });
    }
    Ok(bytes)
}

/// Refuses bytes after the last expected one. Reading to the end is also what makes a decompressor
/// compare its checksum.
pub(crate) fn expect_stream_end(
    decoder: &mut impl Read,
    codec: &str,
    field: &str,
) -> Result<(), ParseError> {
    match decoder.read(&mut [0]).map_err(|e| damaged(codec, field, e))? {
        0 => Ok(()),
        _ => Err(ParseError::value(field, "end of data", "more bytes")),
    }
}

/// The error of a stream that its decompressor refuses.
pub(crate) fn damaged(codec: &str, field: &str, error: impl std::fmt::Display) -> ParseError {
    ParseError::value(field, format!("an intact {codec} stream"), error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claim_beyond_the_limit_is_refused_before_it_is_allocated() {
        assert!(check_unpacked_size(FREE_BYTES + 64 * 100, 100, "x").is_ok());
        let error = check_unpacked_size(u64::MAX, 100, "positions").unwrap_err().to_string();
        assert!(error.starts_with("positions: expected at most "), "{error}");
        // Nothing but what arrives is kept, whatever is claimed.
        let error = read_exactly(&mut &[1_u8, 2][..], u64::MAX, "gzip", "alphas").unwrap_err();
        assert!(error.to_string().contains("alphas: expected 18446744073709551615 bytes, found 2"));
    }
}
