//! The checkpoint file.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `TRPZCKPT` |
//! | 4 | version, 1 |
//! | 4 | length h of the header |
//! | h | header, JSON: `step`, `splats`, `sh_degree`, `config`, `progress` |
//! | 4·m | parameters as f32: positions, log_scales, rotations, opacity_logits, sh_dc, sh_rest |
//! | 4·m | first moments, likewise |
//! | 4·m | second moments, likewise |
//! | 4 | CRC-32 (IEEE) of everything before it |
//!
//! All little-endian; m = splats · (14 + 3·((sh_degree + 1)² − 1)). The length of the file follows
//! from the header, and is compared before anything is allocated.

use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;

use crc32fast::Hasher;
use serde::{Deserialize, Serialize};
use trapeze_formats::{ParseError, ReadError, WriteError, write_atomically};
use trapeze_scene::{ShDegree, Splats};

use super::{Checkpoint, Progress};
use crate::TrainingState;
use crate::config::TrainingConfig;
use crate::parameters::{ParameterGroup, zeros_like};

const MAGIC: [u8; 8] = *b"TRPZCKPT";
const VERSION: u32 = 1;
/// Bytes before the header.
const PREFIX: u64 = 16;
/// A header has a few hundred bytes; far more is damage.
const LONGEST_HEADER: u32 = 1 << 20;
/// Floats that are converted at a time.
const BLOCK: usize = 16_384;

#[derive(Serialize, Deserialize)]
struct Header {
    step: u32,
    splats: u32,
    sh_degree: u32,
    config: TrainingConfig,
    progress: Progress,
}

/// Writes a checkpoint so that `path` holds either what it held before or all of the new one.
///
/// # Errors
/// [`WriteError`]: the operating system's reason, a full disk among them, or a state whose arrays
/// do not belong together.
pub fn write_checkpoint(path: &Path, checkpoint: &Checkpoint) -> Result<(), WriteError> {
    let state = &checkpoint.state;
    let refuse = |error: &dyn std::fmt::Display| WriteError::Unrepresentable {
        path: path.into(),
        what: "training state".into(),
        expected: "arrays of one length".into(),
        found: error.to_string(),
    };
    state.validate().map_err(|error| refuse(&error))?;
    let header = serde_json::to_vec(&Header {
        step: state.step,
        splats: state.splats.len() as u32,
        sh_degree: state.splats.sh_degree as u32,
        config: checkpoint.config.clone(),
        progress: checkpoint.progress.clone(),
    })
    .map_err(|error| refuse(&error))?;
    write_atomically(path, |file| {
        let mut out = Checksummed { inner: file, hasher: Hasher::new() };
        out.write_all(&MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        out.write_all(&(header.len() as u32).to_le_bytes())?;
        out.write_all(&header)?;
        for part in [&state.splats, &state.first_moments, &state.second_moments] {
            for group in ParameterGroup::ALL {
                write_floats(&mut out, group.of(part))?;
            }
        }
        let checksum = out.hasher.finalize();
        out.inner.write_all(&checksum.to_le_bytes())
    })
}

/// Reads a checkpoint.
///
/// # Errors
/// [`ReadError`] names the file and the field: a truncated, damaged or foreign file is refused
/// before any of it is used.
pub fn read_checkpoint(path: &Path) -> Result<Checkpoint, ReadError> {
    let open = || -> Result<Checkpoint, ParseError> {
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        parse(BufReader::with_capacity(1 << 20, file), length)
    };
    open().map_err(|error| ReadError::new(path, error))
}

/// Parses `length` bytes.
fn parse(source: impl Read, length: u64) -> Result<Checkpoint, ParseError> {
    let mut input = Checksummed { inner: source, hasher: Hasher::new() };
    if length < PREFIX {
        return Err(truncated("checkpoint", PREFIX, length));
    }
    let magic: [u8; 8] = input.array()?;
    if magic != MAGIC {
        let found = String::from_utf8_lossy(&magic).into_owned();
        return Err(ParseError::value("magic", "\"TRPZCKPT\"", found));
    }
    let version = u32::from_le_bytes(input.array()?);
    if version != VERSION {
        return Err(ParseError::value("version", VERSION.to_string(), version));
    }
    let header_length = u32::from_le_bytes(input.array()?);
    if header_length > LONGEST_HEADER {
        let expected = format!("at most {LONGEST_HEADER}");
        return Err(ParseError::value("header length", expected, header_length));
    }
    if u64::from(header_length) > length - PREFIX {
        return Err(truncated("header", header_length.into(), length - PREFIX));
    }
    let mut header = vec![0; header_length as usize];
    input.read_exact(&mut header)?;
    let header: Header = serde_json::from_slice(&header)
        .map_err(|error| ParseError::value("header", "the settings of a run", error))?;
    header
        .config
        .validate()
        .map_err(|error| ParseError::value("config", "valid settings", error))?;
    let degree = ShDegree::try_from(header.sh_degree)?;
    // At most 2³² · 59 · 12 bytes: no overflow in 64 bits.
    let arrays = TrainingState::bytes(header.splats.into(), degree);
    let expected = PREFIX + u64::from(header_length) + arrays + 4;
    if length < expected {
        return Err(truncated("checkpoint", expected, length));
    }
    if length > expected {
        return Err(ParseError::value("length", format!("{expected} bytes"), length));
    }
    let state = read_state(&mut input, &header, degree)?;
    let computed = input.hasher.finalize();
    let mut stored = [0; 4];
    input.inner.read_exact(&mut stored)?;
    let stored = u32::from_le_bytes(stored);
    if computed != stored {
        let expected = format!("{stored:08x} as stored");
        return Err(ParseError::value("checksum", expected, format!("{computed:08x}: damaged")));
    }
    Ok(Checkpoint { config: header.config, progress: header.progress, state })
}

fn read_state<R: Read>(
    input: &mut Checksummed<R>,
    header: &Header,
    degree: ShDegree,
) -> std::io::Result<TrainingState> {
    let n = header.splats as usize;
    let empty = Splats {
        positions: vec![[0.0; 3]; n],
        sh_rest: vec![0.0; n * degree.rest_coefficients() * 3],
        sh_degree: degree,
        ..Splats::default()
    };
    let mut state = TrainingState::new(zeros_like(&empty));
    state.step = header.step;
    for part in [&mut state.splats, &mut state.first_moments, &mut state.second_moments] {
        for group in ParameterGroup::ALL {
            read_floats(input, group.of_mut(part))?;
        }
    }
    Ok(state)
}

fn truncated(field: &str, expected: u64, found: u64) -> ParseError {
    ParseError::Truncated { field: field.into(), expected, found }
}

/// Passes bytes on and keeps their checksum.
struct Checksummed<T> {
    inner: T,
    hasher: Hasher,
}

impl<T: Write> Write for Checksummed<T> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.inner.flush()
    }
}

impl<T: Read> Checksummed<T> {
    fn read_exact(&mut self, bytes: &mut [u8]) -> std::io::Result<()> {
        self.inner.read_exact(bytes)?;
        self.hasher.update(bytes);
        Ok(())
    }

    fn array<const N: usize>(&mut self) -> std::io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}

fn write_floats(out: &mut impl Write, values: &[f32]) -> std::io::Result<()> {
    let mut bytes = Vec::with_capacity(4 * BLOCK.min(values.len()));
    for block in values.chunks(BLOCK) {
        bytes.clear();
        bytes.extend(block.iter().flat_map(|value| value.to_le_bytes()));
        out.write_all(&bytes)?;
    }
    Ok(())
}

fn read_floats<R: Read>(input: &mut Checksummed<R>, values: &mut [f32]) -> std::io::Result<()> {
    let mut bytes = vec![0; 4 * BLOCK.min(values.len())];
    for block in values.chunks_mut(BLOCK) {
        let bytes = &mut bytes[..4 * block.len()];
        input.read_exact(bytes)?;
        for (value, bytes) in block.iter_mut().zip(bytes.as_chunks::<4>().0) {
            *value = f32::from_le_bytes(*bytes);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::tests::random_splats;
    use crate::random::{Purpose, Stream, below};

    fn checkpoint(degree: ShDegree) -> Checkpoint {
        let mut state = TrainingState::new(random_splats(1, 21, degree));
        state.first_moments = random_splats(2, 21, degree);
        state.second_moments = random_splats(3, 21, degree);
        state.step = 1234;
        Checkpoint {
            config: TrainingConfig { seed: u64::MAX, ..TrainingConfig::default() },
            progress: Progress {
                // Not a short decimal: survives only if JSON keeps every bit.
                rate_factor: 0.1 + 0.2,
                extent: std::f64::consts::PI / 3.0,
                dataset: "fern, 17 views".into(),
                ..Progress::default()
            },
            state,
        }
    }

    fn bytes_of(checkpoint: &Checkpoint) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        write_checkpoint(&path, checkpoint).unwrap();
        std::fs::read(&path).unwrap()
    }

    fn parse_bytes(bytes: &[u8]) -> Result<Checkpoint, ParseError> {
        parse(bytes, bytes.len() as u64)
    }

    #[test]
    fn a_checkpoint_is_read_as_it_was_written_bit_for_bit() {
        for degree in ShDegree::ALL {
            let mut written = checkpoint(degree);
            written.state.splats.positions[3][1] = -0.0;
            written.state.splats.positions[3][2] = f32::from_bits(1);
            let read = parse_bytes(&bytes_of(&written)).unwrap();
            assert_eq!(read, written);
            assert_eq!(read.state.splats.positions[3][1].to_bits(), (-0.0f32).to_bits());
        }
    }

    #[test]
    fn every_truncation_is_refused_in_one_line() {
        let bytes = bytes_of(&checkpoint(ShDegree::Zero));
        for length in 0..bytes.len() {
            let error = parse_bytes(&bytes[..length]).unwrap_err().to_string();
            assert!(error.contains("expected") && !error.contains('\n'), "{length}: {error}");
        }
        let mut longer = bytes.clone();
        longer.push(0);
        let error = parse_bytes(&longer).unwrap_err().to_string();
        assert!(error.starts_with("length: "), "{error}");
    }

    #[test]
    fn two_thousand_damaged_files_are_all_refused() {
        let bytes = bytes_of(&checkpoint(ShDegree::One));
        let stream = Stream::new(11, Purpose::Initialisation, 0);
        for trial in 0..2500 {
            let mut damaged = bytes.clone();
            let [count, ..] = stream.words(trial);
            for i in 0..=below(count, 4) {
                let [place, bit, kind, value] = stream.more_words(trial, i + 1);
                let place = below(place, damaged.len() as u32) as usize;
                match kind % 4 {
                    0 => damaged[place] ^= 1 << (bit % 8),
                    1 => damaged[place] = value as u8,
                    2 => drop(damaged.remove(place)),
                    _ => damaged.insert(place, value as u8),
                }
            }
            if damaged == bytes {
                continue;
            }
            let error = parse_bytes(&damaged).unwrap_err().to_string();
            assert!(!error.contains('\n') && error.len() < 400, "{error}");
        }
    }

    #[test]
    fn hostile_counts_are_refused_before_anything_is_allocated() {
        for splats in [1u64 << 31, (1 << 32) - 1, 1 << 32, 1 << 63] {
            let header = serde_json::to_string(&Header {
                step: 0,
                splats: 777_777,
                sh_degree: 3,
                config: TrainingConfig::default(),
                progress: Progress::default(),
            })
            .unwrap()
            .replace("777777", &splats.to_string());
            let mut bytes = MAGIC.to_vec();
            bytes.extend(VERSION.to_le_bytes());
            bytes.extend((header.len() as u32).to_le_bytes());
            bytes.extend(header.bytes());
            assert!(parse_bytes(&bytes).is_err());
            for length in [u32::MAX, LONGEST_HEADER + 1] {
                bytes[12..16].copy_from_slice(&length.to_le_bytes());
                let error = parse_bytes(&bytes).unwrap_err().to_string();
                assert!(error.starts_with("header length: "), "{error}");
            }
        }
    }

    #[test]
    fn other_files_and_versions_are_refused_by_field() {
        let mut bytes = bytes_of(&checkpoint(ShDegree::Zero));
        bytes[8] = 9;
        let error = parse_bytes(&bytes).unwrap_err().to_string();
        assert_eq!(error, "version: expected 1, found 9");
        let error = parse_bytes(b"ply\nformat ascii 1.0\n").unwrap_err().to_string();
        assert!(error.starts_with("magic: expected \"TRPZCKPT\""), "{error}");
        let folder = tempfile::tempdir().unwrap();
        assert!(read_checkpoint(folder.path()).is_err());
    }
}
