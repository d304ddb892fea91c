//! The checkpoint file.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `TRPZCKPT` |
//! | 4 | version, 3 |
//! | 4 | length h of the header |
//! | h | header, JSON: `step`, `splats`, `sh_degree`, `network`, `moving`, `config`, `progress` |
//! | 4·m | parameters as f32: positions, log_scales, rotations, opacity_logits, sh_dc, sh_rest |
//! | 4·m | first moments, likewise |
//! | 4·m | second moments, likewise |
//! | 4·w | where `network` is true: weights and biases of the standard network, as in `weights.bin` |
//! | 4·w | their first moments, likewise |
//! | 4·w | their second moments, likewise |
//! | 4·v | where `moving` is a number v: u32 indices of the splats that the network moves, ascending |
//! | 40·(splats − v) | there too: the outputs that each other one holds, f32 |
//! | 4 | CRC-32 (IEEE) of everything before it |
//!
//! All little-endian; m = splats · (14 + 3·((sh_degree + 1)² − 1)), w = 506 378. The length of the
//! file follows from the header, and is compared before anything is allocated. Version 1 had no
//! `network`, version 2 no `moving`; both are still read.

use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;

use crc32fast::Hasher;
use serde::{Deserialize, Serialize};
use trapeze_formats::{ParseError, ReadError, WriteError, write_atomically};
use trapeze_scene::deformation::RestingSplats;
use trapeze_scene::{ShDegree, Splats};

use super::{Checkpoint, Progress};
use crate::config::TrainingConfig;
use crate::parameters::{ParameterGroup, zeros_like};
use crate::{TrainedNetwork, TrainingState, network_parameters, set_network_parameters};

const MAGIC: [u8; 8] = *b"TRPZCKPT";
const VERSION: u32 = 3;
/// The first version, which had no deformation network.
const OLDEST_VERSION: u32 = 1;
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
    /// Whether the standard deformation network follows the splats.
    #[serde(default)]
    network: bool,
    /// Splats that the network moves, where others rest.
    #[serde(default)]
    moving: Option<u32>,
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
    if state.network.as_ref().is_some_and(|trained| !trained.is_standard()) {
        return Err(WriteError::Unrepresentable {
            path: path.into(),
            what: "deformation network".into(),
            expected: "the standard one, as training starts it".into(),
            found: "another".into(),
        });
    }
    let header = serde_json::to_vec(&Header {
        step: state.step,
        splats: state.splats.len() as u32,
        sh_degree: state.splats.sh_degree as u32,
        network: state.network.is_some(),
        moving: state.resting.as_ref().map(|resting| resting.moving().len() as u32),
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
        if let Some(trained) = &state.network {
            write_floats(&mut out, &network_parameters(&trained.network))?;
            write_floats(&mut out, &trained.first_moments)?;
            write_floats(&mut out, &trained.second_moments)?;
        }
        if let Some(resting) = &state.resting {
            let moving: Vec<f32> = resting.moving().iter().copied().map(f32::from_bits).collect();
            write_floats(&mut out, &moving)?;
            write_floats(&mut out, resting.held().as_flattened())?;
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
    if !(OLDEST_VERSION..=VERSION).contains(&version) {
        let expected = format!("{OLDEST_VERSION} to {VERSION}");
        return Err(ParseError::value("version", expected, version));
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
    // At most 2³² · 59 · 12 bytes and those of one network: no overflow in 64 bits.
    let network = if header.network { TrainedNetwork::bytes() } else { 0 };
    let resting = match header.moving {
        Some(moving) if moving > header.splats => {
            let expected = format!("at most {} splats", header.splats);
            return Err(ParseError::value("moving", expected, moving));
        }
        Some(moving) => 4 * u64::from(moving) + 40 * u64::from(header.splats - moving),
        None => 0,
    };
    let arrays = TrainingState::bytes(header.splats.into(), degree) + network + resting;
    let expected = PREFIX + u64::from(header_length) + arrays + 4;
    if length < expected {
        return Err(truncated("checkpoint", expected, length));
    }
    if length > expected {
        return Err(ParseError::value("length", format!("{expected} bytes"), length));
    }
    let mut state = read_state(&mut input, &header, degree)?;
    state.resting = read_resting(&mut input, &header)?;
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
    if header.network {
        state.network = Some(read_network(input)?);
    }
    Ok(state)
}

fn read_resting<R: Read>(
    input: &mut Checksummed<R>,
    header: &Header,
) -> Result<Option<RestingSplats>, ParseError> {
    let Some(moving) = header.moving else { return Ok(None) };
    let mut indices = vec![0.0; moving as usize];
    read_floats(input, &mut indices)?;
    let mut held = vec![[0.0; 10]; (header.splats - moving) as usize];
    read_floats(input, held.as_flattened_mut())?;
    let resting = RestingSplats::new(indices.into_iter().map(f32::to_bits).collect(), held);
    resting.map(Some).map_err(|error| ParseError::value("moving", "ascending indices", error))
}

fn read_network<R: Read>(input: &mut Checksummed<R>) -> std::io::Result<TrainedNetwork> {
    let mut trained = TrainedNetwork::zeros();
    let mut parameters = vec![0.0; trained.first_moments.len()];
    read_floats(input, &mut parameters)?;
    set_network_parameters(&mut trained.network, &parameters);
    read_floats(input, &mut trained.first_moments)?;
    read_floats(input, &mut trained.second_moments)?;
    Ok(trained)
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
mod tests;
