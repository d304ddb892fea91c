//! `weights.bin`: the original app's network file. No header, so only the one architecture it was
//! made for: eight layers of 256, 84 inputs, three heads.

use std::io::Write;
use std::path::Path;

use trapeze_scene::DeformationNetwork;
use trapeze_scene::deformation::{NamedTensors, Tensor};

use crate::bytes::{ByteReader, f32s_from_le};
use crate::error::InFile;
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError, WriteError, write_atomically};

/// Layers in file order, with outputs and inputs. Each is a weight (row-major, out × in), then a
/// bias; all f32, little-endian.
const LAYERS: [(&str, usize, usize); 11] = [
    ("linear.0", 256, 84),
    ("linear.1", 256, 256),
    ("linear.2", 256, 256),
    ("linear.3", 256, 256),
    ("linear.4", 256, 256),
    ("linear.5", 256, 340),
    ("linear.6", 256, 256),
    ("linear.7", 256, 256),
    ("gaussian_warp", 3, 256),
    ("gaussian_rotation", 4, 256),
    ("gaussian_scaling", 3, 256),
];

/// Length of every `weights.bin`: 506 378 floats.
pub const WEIGHTS_BIN_BYTES: u64 = 2_025_512;

/// Parses `weights.bin`.
///
/// # Errors
/// [`ParseError`] when the length is not exactly [`WEIGHTS_BIN_BYTES`].
pub fn parse_weights_bin(bytes: &[u8]) -> Result<DeformationNetwork, ParseError> {
    if bytes.len() as u64 != WEIGHTS_BIN_BYTES {
        let expected =
            format!("{WEIGHTS_BIN_BYTES} bytes (8 × 256 network with 84 inputs, no header)");
        return Err(ParseError::value("file length", expected, bytes.len()));
    }
    let mut reader = ByteReader::new(bytes);
    let mut tensors = NamedTensors::new();
    for (name, outputs, inputs) in LAYERS {
        for (part, shape) in [("weight", vec![outputs, inputs]), ("bias", vec![outputs])] {
            let name = format!("{name}.{part}");
            let count = shape.iter().product::<usize>();
            let data = f32s_from_le(reader.take_array(count as u64, 4, &name)?).collect();
            tensors.insert(name, Tensor { shape, data });
        }
    }
    reader.expect_end("weights")?;
    Ok(DeformationNetwork::from_tensors(tensors)?)
}

/// Reads `weights.bin`.
///
/// # Errors
/// [`ReadError`] with the path and the lengths expected and found.
pub fn read_weights_bin(path: &Path) -> Result<DeformationNetwork, ReadError> {
    parse_weights_bin(&read_regular_file(path, WEIGHTS_BIN_BYTES)?).in_file(path)
}

/// Writes `weights.bin`. Its layout cannot say which architecture it holds, so any network but the
/// standard one is refused instead of being written into a file that would be misread.
///
/// # Errors
/// [`WriteError::Unrepresentable`] for another architecture, [`WriteError::Io`].
pub fn write_weights_bin(path: &Path, network: &DeformationNetwork) -> Result<(), WriteError> {
    expect_standard(path, network)?;
    write_atomically(path, |file| {
        for layer in network.layers() {
            for value in layer.weight.iter().chain(&layer.bias) {
                file.write_all(&value.to_le_bytes())?;
            }
        }
        Ok(())
    })
}

/// Refuses a network that the format cannot hold.
pub(crate) fn expect_standard(path: &Path, network: &DeformationNetwork) -> Result<(), WriteError> {
    if network.is_standard() {
        return Ok(());
    }
    Err(WriteError::Unrepresentable {
        path: path.into(),
        what: "deformation network".into(),
        expected: "8 × 256, 84 inputs (xyz 10 octaves, t 10 octaves)".into(),
        found: network.describe(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes of a network in which every parameter is another number.
    fn counting_bytes() -> Vec<u8> {
        (0..WEIGHTS_BIN_BYTES as u32 / 4).flat_map(|i| (i as f32 * 0.5).to_le_bytes()).collect()
    }

    #[test]
    fn the_layers_add_up_to_the_documented_length() {
        let floats: usize = LAYERS.iter().map(|(_, o, i)| o * i + o).sum();
        assert_eq!(4 * floats as u64, WEIGHTS_BIN_BYTES);
    }

    #[test]
    fn a_network_survives_the_round_trip_bit_for_bit() {
        let bytes = counting_bytes();
        let network = parse_weights_bin(&bytes).unwrap();
        assert!(network.is_standard());
        assert_eq!(network.hidden[0].weight[1], 0.5);
        assert_eq!(network.hidden[0].bias[0], 256.0 * 84.0 * 0.5);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("weights.bin");
        write_weights_bin(&path, &network).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
        assert_eq!(read_weights_bin(&path).unwrap(), network);
    }

    #[test]
    fn any_other_length_is_refused_with_both_numbers() {
        let bytes = counting_bytes();
        for length in [0, 4, bytes.len() - 4, bytes.len() - 1] {
            let error = parse_weights_bin(&bytes[..length]).unwrap_err().to_string();
            assert!(error.contains("2025512"), "{error}");
            assert!(error.ends_with(&format!("found {length}")), "{error}");
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.bin");
        std::fs::write(&path, [bytes, vec![0]].concat()).unwrap();
        let error = read_weights_bin(&path).unwrap_err().to_string();
        assert!(error.contains("2025512 bytes, found 2025513"), "{error}");
    }

    #[test]
    fn a_network_of_another_shape_is_not_written() {
        let mut network = parse_weights_bin(&counting_bytes()).unwrap();
        network.position_encoding.octaves = 3;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("weights.bin");
        let error = write_weights_bin(&path, &network).unwrap_err().to_string();
        assert!(error.contains("xyz 3 octaves") && !path.exists(), "{error}");
    }
}
