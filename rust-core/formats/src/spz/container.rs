//! The two containers: quantised streams out of a file and into one.

use std::io::{self, Read, Write};

use flate2::Compression;
use flate2::bufread::GzDecoder;
use flate2::write::GzEncoder;
use rayon::prelude::*;
use ruzstd::decoding::{FrameDecoder, StreamingDecoder};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};

use super::header::{GZIP_HEADER_BYTES, Header, MAGIC, STREAM_NAMES, ZSTD_HEADER_BYTES};
use super::{AxisSigns, extensions};
use crate::ParseError;
use crate::bytes::ByteReader;
use crate::decompression::{damaged, expect_stream_end, read_exactly};

/// Most bytes of extension records after the splats of a gzip stream.
const MAX_TRAILER_BYTES: u64 = 1 << 20;
/// A zstd window that every decoder is asked to support (RFC 8878, 3.1.1.1.2), and what the
/// reference writer stays below.
const USUAL_WINDOW_BYTES: u64 = 8 << 20;

/// The content of a file after decompression.
pub(super) struct SpzFile {
    pub(super) header: Header,
    /// From the file's axes to ours.
    pub(super) signs: AxisSigns,
    /// Quantised attributes, in the order of [`STREAM_NAMES`] and with the lengths of
    /// [`Header::stream_bytes`].
    pub(super) streams: [Vec<u8>; 6],
}

/// Decompresses a file of any supported version.
pub(super) fn unpack(bytes: &[u8]) -> Result<SpzFile, ParseError> {
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return unpack_gzip(bytes);
    }
    if bytes.starts_with(&MAGIC.to_le_bytes()) {
        return unpack_zstd(bytes);
    }
    let found = format!("{:02x?}", &bytes[..bytes.len().min(4)]);
    Err(ParseError::value("magic", "1f 8b (gzip) or \"NGSP\" (SPZ version 4)", found))
}

fn unpack_gzip(mut bytes: &[u8]) -> Result<SpzFile, ParseError> {
    let file_bytes = bytes.len();
    let mut decoder = GzDecoder::new(&mut bytes);
    let start = read_exactly(&mut decoder, GZIP_HEADER_BYTES, "gzip", "header")?;
    let header = Header::parse(&mut ByteReader::new(&start), 2..=3)?;
    header.check_splats(file_bytes)?;
    let mut streams = [const { Vec::new() }; 6];
    for ((stream, name), size) in streams.iter_mut().zip(STREAM_NAMES).zip(header.stream_bytes()) {
        *stream = read_exactly(&mut decoder, size, "gzip", name)?;
    }
    let signs = if header.has_extensions {
        trailing_extensions(&mut decoder)?
    } else {
        AxisSigns::right_up_back().clone()
    };
    expect_stream_end(&mut decoder, "gzip", "end of the splats")?;
    ByteReader::new(bytes).expect_end("end of the gzip stream")?;
    Ok(SpzFile { header, signs, streams })
}

/// Records after the splats. Those of early writers carry no length, so a record that does not
/// add up says nothing about the splats before it.
fn trailing_extensions(decoder: &mut impl Read) -> Result<AxisSigns, ParseError> {
    let mut trailer = Vec::new();
    decoder
        .take(MAX_TRAILER_BYTES)
        .read_to_end(&mut trailer)
        .map_err(|e| damaged("gzip", "extensions", e))?;
    match extensions::parse(&trailer) {
        Err(error @ ParseError::Truncated { .. }) => {
            tracing::warn!("SPZ extensions are not read: {error}");
            Ok(AxisSigns::right_up_back().clone())
        }
        result => result,
    }
}

fn unpack_zstd(bytes: &[u8]) -> Result<SpzFile, ParseError> {
    let mut reader = ByteReader::new(bytes);
    let header = Header::parse(&mut reader, 4..=4)?;
    header.check_splats(bytes.len())?;
    let stream_count = reader.u8("numStreams")?;
    let table_offset = reader.u32("tocByteOffset")?;
    reader.take(12, "reserved")?;
    let extension_bytes = table_offset.checked_sub(ZSTD_HEADER_BYTES).ok_or_else(|| {
        ParseError::value("tocByteOffset", format!("at least {ZSTD_HEADER_BYTES}"), table_offset)
    })?;
    let extension_block = reader.take_array(extension_bytes.into(), 1, "extensions")?;
    let signs = if header.has_extensions {
        extensions::parse(extension_block)?
    } else {
        AxisSigns::right_up_back().clone()
    };
    let parts = parse_table(&mut reader, header, stream_count)?;
    let unpacked = parts
        .into_par_iter()
        .map(|part| part.map_or(Ok(Vec::new()), Part::decompress))
        .collect::<Result<Vec<_>, _>>()?;
    let mut streams = [const { Vec::new() }; 6];
    for (stream, bytes) in streams.iter_mut().zip(unpacked) {
        *stream = bytes;
    }
    Ok(SpzFile { header, signs, streams })
}

/// One compressed stream.
struct Part<'a> {
    name: &'static str,
    compressed: &'a [u8],
    unpacked_bytes: u64,
}

/// Reads the table of contents, `u64 compressed, u64 unpacked` per stream that is not empty, and
/// cuts the rest of the file accordingly.
fn parse_table<'a>(
    reader: &mut ByteReader<'a>,
    header: Header,
    stream_count: u8,
) -> Result<[Option<Part<'a>>; 6], ParseError> {
    let sizes = header.stream_bytes();
    let expected_count = sizes.iter().filter(|&&size| size > 0).count();
    if usize::from(stream_count) != expected_count {
        return Err(ParseError::value("numStreams", expected_count.to_string(), stream_count));
    }
    let mut table = ByteReader::new(reader.take(expected_count * 16, "table of contents")?);
    let mut parts = [const { None }; 6];
    for ((part, name), expected) in parts.iter_mut().zip(STREAM_NAMES).zip(sizes) {
        if expected == 0 {
            continue;
        }
        let compressed_bytes = table.u64("table of contents")?;
        let unpacked_bytes = table.u64("table of contents")?;
        if unpacked_bytes != expected {
            let field = format!("{name}: uncompressed size");
            return Err(ParseError::value(field, expected.to_string(), unpacked_bytes));
        }
        let compressed = reader.take_array(compressed_bytes, 1, name)?;
        *part = Some(Part { name, compressed, unpacked_bytes });
    }
    reader.expect_end("end of the last stream")?;
    Ok(parts)
}

impl Part<'_> {
    /// Decompresses the one frame of the stream and compares its checksum, if it carries one.
    fn decompress(self) -> Result<Vec<u8>, ParseError> {
        // The decoder allocates the window that a frame asks for before it reads a block.
        let window = self.unpacked_bytes.max(USUAL_WINDOW_BYTES);
        let mut decoder = StreamingDecoder::new_with_max_window_size(self.compressed, window)
            .map_err(|e| damaged("zstd", self.name, e))?;
        let bytes = read_exactly(&mut decoder, self.unpacked_bytes, "zstd", self.name)?;
        expect_stream_end(&mut decoder, "zstd", self.name)?;
        let (rest, frame) = decoder.into_parts();
        ByteReader::new(rest).expect_end(self.name)?;
        check_sum(&frame, self.name)?;
        Ok(bytes)
    }
}

fn check_sum(frame: &FrameDecoder, field: &str) -> Result<(), ParseError> {
    let (Some(stored), Some(found)) =
        (frame.get_checksum_from_data(), frame.get_calculated_checksum())
    else {
        return Ok(());
    };
    if stored == found {
        return Ok(());
    }
    Err(ParseError::value(field, format!("checksum {stored:08x}"), format!("{found:08x}")))
}

/// Compresses a file in the container of its version.
pub(super) fn write(file: &SpzFile, writer: &mut impl Write) -> io::Result<()> {
    if file.header.version == 4 { write_zstd(file, writer) } else { write_gzip(file, writer) }
}

fn write_gzip(file: &SpzFile, writer: &mut impl Write) -> io::Result<()> {
    let mut encoder = GzEncoder::new(writer, Compression::default());
    encoder.write_all(&file.header.to_bytes())?;
    encoder.write_all(&[0])?;
    for stream in &file.streams {
        encoder.write_all(stream)?;
    }
    encoder.finish()?;
    Ok(())
}

fn write_zstd(file: &SpzFile, writer: &mut impl Write) -> io::Result<()> {
    let frames: Vec<(u64, Vec<u8>)> = file
        .streams
        .par_iter()
        .filter(|stream| !stream.is_empty())
        .map(|stream| {
            (stream.len() as u64, compress_to_vec(&stream[..], CompressionLevel::Fastest))
        })
        .collect();
    writer.write_all(&file.header.to_bytes())?;
    writer.write_all(&[frames.len() as u8])?;
    writer.write_all(&ZSTD_HEADER_BYTES.to_le_bytes())?;
    writer.write_all(&[0; 12])?;
    for (unpacked_bytes, frame) in &frames {
        writer.write_all(&(frame.len() as u64).to_le_bytes())?;
        writer.write_all(&unpacked_bytes.to_le_bytes())?;
    }
    for (_, frame) in &frames {
        writer.write_all(frame)?;
    }
    Ok(())
}
