//! The header of an SPZ file and the sizes that follow from it.

use crate::ParseError;
use crate::bytes::ByteReader;
use crate::decompression::{check_unpacked_size, scene_bytes};

/// "NGSP", little-endian.
pub(super) const MAGIC: u32 = 0x5053_474e;
/// Header of versions 2 and 3, inside the gzip stream.
pub(super) const GZIP_HEADER_BYTES: u64 = 16;
/// Header of version 4, before the zstd streams.
pub(super) const ZSTD_HEADER_BYTES: u32 = 32;
/// Flag: trained with the 2-D Mip filter.
const ANTIALIASED: u8 = 0x1;
/// Flag: extension records are present.
const HAS_EXTENSIONS: u8 = 0x2;

/// The attributes in file order.
pub(super) const STREAM_NAMES: [&str; 6] =
    ["positions", "alphas", "colors", "scales", "rotations", "sh"];

/// What every version's header says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) version: u32,
    pub(super) splats: u32,
    /// 0 to 4; one more than a scene can hold.
    pub(super) sh_degree: u8,
    pub(super) fractional_bits: u8,
    pub(super) antialiased: bool,
    pub(super) has_extensions: bool,
}

impl Header {
    /// The first 15 bytes, which all versions share.
    pub(super) fn parse(
        reader: &mut ByteReader<'_>,
        versions: std::ops::RangeInclusive<u32>,
    ) -> Result<Self, ParseError> {
        let magic = reader.u32("magic")?;
        if magic != MAGIC {
            return Err(ParseError::value("magic", "\"NGSP\" (SPZ)", format!("{magic:#010x}")));
        }
        let version = reader.u32("version")?;
        if !versions.contains(&version) {
            let expected = versions.map(|v| v.to_string()).collect::<Vec<_>>().join(" or ");
            return Err(ParseError::value("version", expected, version));
        }
        let header = Self {
            version,
            splats: reader.u32("numPoints")?,
            sh_degree: reader.u8("shDegree")?,
            fractional_bits: reader.u8("fractionalBits")?,
            antialiased: false,
            has_extensions: false,
        };
        if header.sh_degree > 4 {
            return Err(ParseError::value("shDegree", "0 to 4", header.sh_degree));
        }
        if header.fractional_bits > 30 {
            return Err(ParseError::value("fractionalBits", "0 to 30", header.fractional_bits));
        }
        let flags = reader.u8("flags")?;
        // An unknown flag may change what the streams mean: 0x80 of another program, for example,
        // mixes the nodes of a level-of-detail tree among the splats.
        if flags & !(ANTIALIASED | HAS_EXTENSIONS) != 0 {
            let expected = "antialiased (0x1) and extensions (0x2) only";
            return Err(ParseError::value("flags", expected, format!("{flags:#04x}")));
        }
        Ok(Self {
            antialiased: flags & ANTIALIASED != 0,
            has_extensions: flags & HAS_EXTENSIONS != 0,
            ..header
        })
    }

    /// The bytes that [`Header::parse`] reads.
    pub(super) fn to_bytes(self) -> [u8; 15] {
        let mut bytes = [0; 15];
        bytes[..4].copy_from_slice(&MAGIC.to_le_bytes());
        bytes[4..8].copy_from_slice(&self.version.to_le_bytes());
        bytes[8..12].copy_from_slice(&self.splats.to_le_bytes());
        bytes[12] = self.sh_degree;
        bytes[13] = self.fractional_bits;
        bytes[14] = u8::from(self.antialiased) * ANTIALIASED
            + u8::from(self.has_extensions) * HAS_EXTENSIONS;
        bytes
    }

    /// SH coefficients above band 0, per channel: 0, 3, 8, 15 or 24.
    pub(super) fn sh_coefficients(self) -> usize {
        let bands = usize::from(self.sh_degree) + 1;
        bands * bands - 1
    }

    /// Bytes of each stream, in the order of [`STREAM_NAMES`].
    pub(super) fn stream_bytes(self) -> [u64; 6] {
        let rotation = if self.version == 2 { 3 } else { 4 };
        [9, 1, 3, 3, rotation, 3 * self.sh_coefficients() as u64]
            .map(|bytes| bytes * u64::from(self.splats))
    }

    /// Refuses a number of splats that no file of this size holds, before anything is allocated.
    pub(super) fn check_splats(self, file_bytes: usize) -> Result<(), ParseError> {
        let streams: u64 = self.stream_bytes().iter().sum();
        let scene = scene_bytes(self.splats.into(), self.sh_coefficients());
        check_unpacked_size(streams + scene, file_bytes, "numPoints")
    }
}
