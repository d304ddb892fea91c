//! `deform.pth`: the state dict of a deformation network.

use std::path::Path;

use trapeze_scene::DeformationNetwork;
use trapeze_scene::deformation::{NamedTensors, Tensor};

use super::MAX_CHECKPOINT_BYTES;
use super::archive::Checkpoint;
use super::machine::Entry;
use crate::error::InFile;
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError};

/// Parses `deform.pth`. Any published variant of the network is recognised by its shapes.
///
/// # Errors
/// [`ParseError`] names the tensor, Python name, opcode or zip member that is refused.
pub fn parse_deform_pth(bytes: &[u8]) -> Result<DeformationNetwork, ParseError> {
    let mut checkpoint = Checkpoint::open(bytes)?;
    let entries = std::mem::take(&mut checkpoint.entries);
    let mut tensors = NamedTensors::new();
    for (name, entry) in entries {
        let tensor = match entry {
            Entry::Tensor(tensor) => tensor,
            Entry::Other(kind) => return Err(ParseError::value(name, "a tensor", kind)),
        };
        let storage = checkpoint.storage_of(&tensor)?;
        let Some(data) = tensor.floats(&storage) else {
            let found = format!("{:?}", tensor.element());
            return Err(ParseError::value(name, "a tensor of floats", found));
        };
        tensors.insert(name, Tensor { shape: tensor.shape().to_vec(), data });
    }
    Ok(DeformationNetwork::from_tensors(tensors)?)
}

/// Reads `deform.pth`.
///
/// # Errors
/// [`ReadError`] with the path and what is refused.
pub fn read_deform_pth(path: &Path) -> Result<DeformationNetwork, ReadError> {
    parse_deform_pth(&read_regular_file(path, MAX_CHECKPOINT_BYTES)?).in_file(path)
}
