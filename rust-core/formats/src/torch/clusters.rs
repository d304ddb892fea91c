//! `clusters.pt`: `{"id": n integers, "rgb": n × 3 colours}`.

use std::path::Path;

use trapeze_scene::Clusters;

use super::MAX_CHECKPOINT_BYTES;
use super::archive::Checkpoint;
use super::machine::Entry;
use super::tensor::StoredTensor;
use crate::clusters_bin::clusters_with_valid_colors;
use crate::error::InFile;
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError};

/// Parses `clusters.pt`. Colours are floats in 0–1 or integers in 0–255; entries besides `id` and
/// `rgb` are ignored.
///
/// # Errors
/// [`ParseError`] names the entry that is missing or has another type, shape or range.
pub fn parse_clusters_pt(bytes: &[u8]) -> Result<Clusters, ParseError> {
    let mut checkpoint = Checkpoint::open(bytes)?;
    let ids = read_ids(&mut checkpoint)?;
    let colors = read_colors(&mut checkpoint, ids.len())?;
    clusters_with_valid_colors(&ids, &colors)
}

/// Reads `clusters.pt`.
///
/// # Errors
/// [`ReadError`] with the path and what is refused.
pub fn read_clusters_pt(path: &Path) -> Result<Clusters, ReadError> {
    parse_clusters_pt(&read_regular_file(path, MAX_CHECKPOINT_BYTES)?).in_file(path)
}

fn read_ids(checkpoint: &mut Checkpoint<'_>) -> Result<Vec<u32>, ParseError> {
    let tensor = take_tensor(checkpoint, "id")?;
    if !matches!(tensor.shape(), [_] | [_, 1]) {
        return Err(ParseError::value("id", "shape [n]", format!("{:?}", tensor.shape())));
    }
    let storage = checkpoint.storage_of(&tensor)?;
    let Some(ids) = tensor.integers(&storage) else {
        return Err(ParseError::value("id", "integers", format!("{:?}", tensor.element())));
    };
    ids.into_iter()
        .map(|id| {
            u32::try_from(id).map_err(|_| ParseError::value("id", "numbers from 0 to 2^32 - 1", id))
        })
        .collect()
}

fn read_colors(checkpoint: &mut Checkpoint<'_>, n: usize) -> Result<Vec<[f32; 3]>, ParseError> {
    let tensor = take_tensor(checkpoint, "rgb")?;
    if tensor.shape() != [n, 3] {
        let found = format!("{:?}", tensor.shape());
        return Err(ParseError::value("rgb", format!("shape [{n}, 3]"), found));
    }
    let storage = checkpoint.storage_of(&tensor)?;
    let channels = match (tensor.floats(&storage), tensor.integers(&storage)) {
        (Some(channels), _) => channels,
        (None, integers) => {
            integers.unwrap_or_default().into_iter().map(|channel| channel as f32 / 255.0).collect()
        }
    };
    Ok(channels.as_chunks::<3>().0.to_vec())
}

fn take_tensor(checkpoint: &mut Checkpoint<'_>, name: &str) -> Result<StoredTensor, ParseError> {
    match checkpoint.entries.remove(name) {
        Some(Entry::Tensor(tensor)) => Ok(tensor),
        Some(Entry::Other(kind)) => Err(ParseError::value(name, "a tensor", kind)),
        None => Err(ParseError::value(name, "a tensor", "nothing")),
    }
}
