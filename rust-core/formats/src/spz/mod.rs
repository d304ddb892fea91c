//! SPZ, the compressed splat files of Niantic Labs: versions 2 and 3 (one gzip stream) and 4 (one
//! zstd stream per attribute behind a plain header).
//!
//! A file is quantised to 20–64 bytes a splat before it is compressed:
//!
//! | stream | bytes per splat | value |
//! |---|---|---|
//! | positions | 9 | x, y, z, signed 24-bit fixed point with the header's number of fractional bits |
//! | alphas | 1 | opacity × 255 |
//! | colors | 3 | (SH band 0 × 0.15 + 0.5) × 255 |
//! | scales | 3 | (log-scale + 10) × 16 |
//! | rotations | 4 | the three smallest components (version 2: 3 bytes, x y z) |
//! | sh | 0, 9, 24, 45 or 72 | coefficient × 128 + 128, coefficient-major, r g b innermost |
//!
//! The axes are right, up, back; ours, as in a PLY file, are right, down, front. Positions,
//! quaternions and the odd SH terms change sign on the way in and out (`AxisSigns`).
//!
//! [`write_spz`] writes version 3 unless asked for 4: every SPZ reader opens it, while version 4
//! (2026) is read by few programs and gains nothing here but a parallel decode.
//!
//! Source: the format's description and reference implementation, <https://github.com/nianticlabs/spz>.

mod axes;
mod container;
mod decode;
mod encode;
mod extensions;
mod header;
mod rotation;

use std::path::Path;

use trapeze_scene::Scene;

use crate::error::InFile;
use crate::{ParseError, ReadError, WriteError, open, write_atomically};

use axes::AxisSigns;
pub use encode::{SpzOptions, SpzVersion};

/// Byte steps per unit of the SH coefficient of band 0.
const COLOR_STEPS: f64 = 0.15 * 255.0;
/// Byte steps per unit of log-scale.
const LOG_SCALE_STEPS: f32 = 16.0;
/// The log-scale of byte 0.
const LOG_SCALE_OFFSET: f32 = -10.0;
/// Byte steps per unit of the SH coefficients above band 0.
const SH_STEPS: f32 = 128.0;

/// Reads a scene from the bytes of an SPZ file.
///
/// A file whose splats were trained with the 2-D Mip filter is flagged in
/// [`Scene::antialiased`]. SH bands above 3 are left out with a warning.
///
/// # Errors
/// [`ParseError`] names the field that is truncated, damaged or not supported.
pub fn parse_spz(bytes: &[u8]) -> Result<Scene, ParseError> {
    let file = container::unpack(bytes)?;
    let scene = decode::scene(&file)?;
    if scene.antialiased {
        tracing::warn!(
            "SPZ flag `antialiased` (0x1): the splats were trained with the 2-D Mip filter, which \
             is not applied; small splats may look too large or too bright"
        );
    }
    Ok(scene)
}

/// Reads an SPZ file.
///
/// # Errors
/// [`ReadError`] names the file and the field.
pub fn read_spz(path: &Path) -> Result<Scene, ReadError> {
    let bytes = open::map(path).in_file(path)?;
    parse_spz(&bytes).in_file(path)
}

/// Writes the splats of a scene as an SPZ file. What lies outside the range of the format is
/// clamped, with one warning that counts it; splats that no renderer draws because a value is not
/// finite are written invisible.
///
/// # Errors
/// [`WriteError::Unrepresentable`] when world coordinates ([`Scene::origin`] included) do not fit
/// 24 bits, [`WriteError::Io`] when the operating system refuses.
pub fn write_spz(path: &Path, scene: &Scene, options: &SpzOptions) -> Result<(), WriteError> {
    let packed = encode::pack(scene, options).map_err(|misfit| WriteError::Unrepresentable {
        path: path.into(),
        what: misfit.what.into(),
        expected: misfit.expected,
        found: misfit.found,
    })?;
    write_atomically(path, |writer| container::write(&packed, writer))
}
