//! PLY files of splats: INRIA's and TRASE's vertex properties, and PlayCanvas's compressed form.
//!
//! Sources: Kerbl et al. 2023, reference implementation (`save_ply`); the TRASE release for
//! `gaussian_feats_*`; PlayCanvas's `splat-transform` for the compressed form.

mod body;
mod compressed;
mod header;
mod layout;
mod points;
mod read;
mod scalar;
mod write;

use std::path::Path;

use trapeze_scene::Scene;

use crate::error::InFile;
use crate::{ParseError, ReadError, open};
pub use compressed::{encode_compressed_ply, write_compressed_ply};
pub(crate) use points::parse_points;
pub use write::{encode_ply, write_ply};

/// Reads a PLY file of splats, plain or compressed.
///
/// # Errors
/// [`ReadError`] names the file, the field and what was expected.
pub fn read_ply(path: &Path) -> Result<Scene, ReadError> {
    let bytes = open::map(path).in_file(path)?;
    parse_ply(&bytes).in_file(path)
}

/// Parses the bytes of a PLY file of splats, plain or compressed: text or binary in either byte
/// order, numbers of any type, properties in any order, SH degree 0 to 3. Properties and elements
/// that do not belong to splats are ignored. Values that are not finite are kept as they are.
///
/// # Errors
/// [`ParseError`] names the field and what was expected.
pub fn parse_ply(bytes: &[u8]) -> Result<Scene, ParseError> {
    let (header, body) = header::split_header(bytes)?;
    if compressed::is_compressed(&header) {
        return compressed::read_compressed(&header, body);
    }
    read::read_splats(&header, body)
}
