//! `features.bin` (docs/formats.md): little-endian, with a checksum at its end.

use std::io::Read;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{ClusterState, FeatureStore, LeftOut, Record};
use crate::models::normalised;

const MAGIC: &[u8; 4] = b"TZFT";
const VERSION: u32 = 1;
/// Magic, version, scene, image and crop key, dimension, records, length of the release.
const HEADER_BYTES: usize = 32;
/// Id, key, state, quality.
const RECORD_BYTES: usize = 16;
const CHECKSUM_BYTES: usize = 4;
/// Lengths of unit vectors that were rounded to single precision stay far inside this.
const LENGTH_TOLERANCE: f32 = 1e-3;

/// Files larger than this are not read: a million clusters of 512 numbers fit.
pub const MAX_FEATURE_FILE_BYTES: u64 = 4 << 30;

/// A file that is not what was written. One line.
#[derive(Debug, Error)]
pub enum FeatureFileError {
    /// It holds something else.
    #[error("{field}: expected {expected}, found {found}")]
    Value {
        /// What is wrong.
        field: &'static str,
        /// What it should be.
        expected: String,
        /// What it is.
        found: String,
    },
    /// It cannot be read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Which file it was.
    #[error("{}: {source}", path.display())]
    In {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Box<Self>,
    },
}

impl FeatureFileError {
    fn value(
        field: &'static str,
        expected: impl Into<String>,
        found: impl std::fmt::Display,
    ) -> Self {
        Self::Value { field, expected: expected.into(), found: found.to_string() }
    }
}

impl FeatureStore {
    /// The file's bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        bytes.extend_from_slice(MAGIC);
        let counts = [self.dimension, self.records.len(), self.release.len()];
        let [dimension, records, release] = counts.map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        for number in
            [VERSION, self.scene_key(), self.image_key, self.crop_key, dimension, records, release]
        {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        bytes.extend_from_slice(self.release.as_bytes());
        for record in &self.records {
            let (state, quality, feature) = match &record.state {
                ClusterState::Encoded { feature, quality } => (0, *quality, &feature[..]),
                ClusterState::LeftOut(reason) => (code(*reason), 0.0, &[][..]),
            };
            for number in [record.id, record.key, state] {
                bytes.extend_from_slice(&number.to_le_bytes());
            }
            bytes.extend_from_slice(&quality.to_le_bytes());
            feature.iter().for_each(|number| bytes.extend_from_slice(&number.to_le_bytes()));
        }
        bytes.extend_from_slice(&crc32fast::hash(&bytes).to_le_bytes());
        bytes
    }

    /// Parses a file's bytes.
    ///
    /// # Errors
    /// [`FeatureFileError`] for another magic or version, a length that the counts do not give, a
    /// checksum or a value that cannot be right.
    pub fn parse(bytes: &[u8]) -> Result<Self, FeatureFileError> {
        let mut reader = Reader { left: bytes };
        let magic = reader.take("magic", 4)?;
        if magic != MAGIC {
            return Err(FeatureFileError::value("magic", "\"TZFT\"", magic.escape_ascii()));
        }
        let version = reader.u32("version")?;
        if version != VERSION {
            return Err(FeatureFileError::value("version", VERSION.to_string(), version));
        }
        let body = bytes.len().saturating_sub(CHECKSUM_BYTES).max(HEADER_BYTES.min(bytes.len()));
        let expected = format!("{:08x}", crc32fast::hash(&bytes[..body]));
        let found =
            bytes[body..].iter().rev().map(|byte| format!("{byte:02x}")).collect::<String>();
        if expected != found {
            return Err(FeatureFileError::value("checksum", expected, found));
        }
        let mut reader = Reader { left: &bytes[8..body] };
        let scene_key = reader.u32("scene key")?;
        let image_key = reader.u32("image key")?;
        let crop_key = reader.u32("crop key")?;
        let dimension = reader.u32("dimension")? as usize;
        let count = reader.u32("clusters")? as usize;
        let release = reader.u32("release")? as usize;
        let release = reader.take("release", release)?;
        let release = String::from_utf8(release.to_vec())
            .map_err(|_| FeatureFileError::value("release", "UTF-8", release.escape_ascii()))?;
        if count > reader.left.len() / RECORD_BYTES {
            let most = format!("at most {}", reader.left.len() / RECORD_BYTES);
            return Err(FeatureFileError::value("clusters", most, count));
        }
        let records: Vec<Record> =
            (0..count).map(|_| reader.record(dimension)).collect::<Result<_, _>>()?;
        if !reader.left.is_empty() {
            return Err(FeatureFileError::value("length", "no more bytes", reader.left.len()));
        }
        if !records.is_sorted_by(|a, b| a.id < b.id) {
            return Err(FeatureFileError::value("cluster ids", "ascending numbers", "others"));
        }
        let store = Self { release, dimension, image_key, crop_key, records };
        if store.scene_key() != scene_key {
            return Err(FeatureFileError::value(
                "scene key",
                store.scene_key().to_string(),
                scene_key,
            ));
        }
        Ok(store)
    }

    /// Reads a file; `None` when there is none.
    ///
    /// # Errors
    /// [`FeatureFileError`] with the path.
    pub fn read(path: &Path) -> Result<Option<Self>, FeatureFileError> {
        let refuse = |source| FeatureFileError::File { path: path.into(), source };
        let inside = |source| FeatureFileError::In { path: path.into(), source: Box::new(source) };
        let metadata = match std::fs::metadata(path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            other => other.map_err(refuse)?,
        };
        if !metadata.is_file() || metadata.len() > MAX_FEATURE_FILE_BYTES {
            let expected = format!("a file of at most {MAX_FEATURE_FILE_BYTES} bytes");
            return Err(inside(FeatureFileError::value("length", expected, metadata.len())));
        }
        let mut bytes = Vec::new();
        let file = std::fs::File::open(path).map_err(refuse)?;
        file.take(MAX_FEATURE_FILE_BYTES).read_to_end(&mut bytes).map_err(refuse)?;
        Self::parse(&bytes).map(Some).map_err(inside)
    }
}

fn code(reason: LeftOut) -> u32 {
    match reason {
        LeftOut::TooSmall => 1,
        LeftOut::NeverVisible => 2,
        LeftOut::Unassigned => 3,
    }
}

/// What is left of the bytes.
struct Reader<'a> {
    left: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take(&mut self, field: &'static str, count: usize) -> Result<&'a [u8], FeatureFileError> {
        let (taken, left) = self.left.split_at_checked(count).ok_or_else(|| {
            FeatureFileError::value(field, format!("{count} bytes"), self.left.len())
        })?;
        self.left = left;
        Ok(taken)
    }

    fn u32(&mut self, field: &'static str) -> Result<u32, FeatureFileError> {
        let bytes = self.take(field, 4)?;
        Ok(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    }

    fn record(&mut self, dimension: usize) -> Result<Record, FeatureFileError> {
        let id = self.u32("cluster id")?;
        let key = self.u32("cluster key")?;
        let state = self.u32("cluster state")?;
        let quality = f32::from_bits(self.u32("quality")?);
        let state = match state {
            0 => ClusterState::Encoded { feature: self.feature(dimension)?, quality },
            1 => ClusterState::LeftOut(LeftOut::TooSmall),
            2 => ClusterState::LeftOut(LeftOut::NeverVisible),
            3 => ClusterState::LeftOut(LeftOut::Unassigned),
            other => return Err(FeatureFileError::value("cluster state", "0 to 3", other)),
        };
        if !(quality.is_finite() && quality >= 0.0) {
            return Err(FeatureFileError::value("quality", "a finite number", quality));
        }
        Ok(Record { id, key, state })
    }

    fn feature(&mut self, dimension: usize) -> Result<Vec<f32>, FeatureFileError> {
        let bytes = self.take("feature", dimension.saturating_mul(4))?;
        let feature: Vec<f32> =
            bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        let unit = normalised(&feature).is_some_and(|unit| {
            unit.iter().zip(&feature).all(|(a, b)| (a - b).abs() <= LENGTH_TOLERANCE)
        });
        if unit {
            Ok(feature)
        } else {
            Err(FeatureFileError::value("feature", "unit length", "other"))
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn store() -> FeatureStore {
        let encoded = |feature: Vec<f32>| ClusterState::Encoded { feature, quality: 0.25 };
        FeatureStore {
            release: "a release".into(),
            dimension: 3,
            image_key: 0xdead_beef,
            crop_key: 7,
            records: vec![
                Record { id: 1, key: 10, state: encoded(vec![0.6, 0.0, 0.8]) },
                Record { id: 2, key: 20, state: ClusterState::LeftOut(LeftOut::NeverVisible) },
                Record { id: 4_000_000_000, key: 30, state: encoded(vec![0.0, -1.0, 0.0]) },
            ],
        }
    }

    /// The bytes with a checksum that fits.
    fn sealed(mut body: Vec<u8>) -> Vec<u8> {
        let checksum = crc32fast::hash(&body);
        body.extend_from_slice(&checksum.to_le_bytes());
        body
    }

    fn body() -> Vec<u8> {
        let mut bytes = store().to_bytes();
        bytes.truncate(bytes.len() - CHECKSUM_BYTES);
        bytes
    }

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(FeatureStore::parse(&store().to_bytes()).unwrap(), store());
    }

    #[test]
    fn a_file_cut_anywhere_or_with_one_bit_flipped_is_refused() {
        let bytes = store().to_bytes();
        for length in 0..bytes.len() {
            assert!(FeatureStore::parse(&bytes[..length]).is_err(), "{length}");
        }
        for bit in 0..bytes.len() * 8 {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(FeatureStore::parse(&damaged).is_err(), "{bit}");
        }
    }

    #[test]
    fn counts_beyond_the_file_are_refused_before_memory_is_asked_for() {
        for (at, expected) in [(20, "feature: "), (24, "clusters: "), (28, "release: ")] {
            for hostile in [u32::MAX, 1 << 30] {
                let mut bytes = body();
                bytes[at..at + 4].copy_from_slice(&hostile.to_le_bytes());
                let message = FeatureStore::parse(&sealed(bytes)).unwrap_err().to_string();
                assert!(message.starts_with(expected), "{message}");
            }
        }
    }

    #[test]
    fn messages_name_the_field() {
        let mut other = body();
        other[4] = 9;
        let message = FeatureStore::parse(&sealed(other)).unwrap_err().to_string();
        assert_eq!(message, "version: expected 1, found 9");
        let message = FeatureStore::parse(b"PK\x03\x04").unwrap_err().to_string();
        assert_eq!(message, "magic: expected \"TZFT\", found PK\\x03\\x04");
        let mut flipped = store().to_bytes();
        flipped[60] ^= 1;
        let message = FeatureStore::parse(&flipped).unwrap_err().to_string();
        assert!(message.starts_with("checksum: expected "), "{message}");
    }

    proptest! {
        #[test]
        fn bytes_that_pass_the_checksum_are_parsed_or_refused(
            changes in prop::collection::vec((8_usize..90, any::<u8>()), 1..6)
        ) {
            let mut bytes = body();
            for (at, byte) in changes {
                let at = at % bytes.len();
                bytes[at] = byte;
            }
            // Either way, but no panic and no large allocation.
            if let Ok(store) = FeatureStore::parse(&sealed(bytes)) {
                prop_assert_eq!(FeatureStore::parse(&store.to_bytes()).unwrap(), store);
            }
        }
    }
}
