//! `.splat` files: 32 bytes per splat, no header, SH degree 0.
//!
//! | bytes | content |
//! |---|---|
//! | 0–11 | position, 3 little-endian floats |
//! | 12–23 | scale, 3 little-endian floats, linear |
//! | 24–27 | red, green, blue, opacity: bytes, 0–255 for 0–1 |
//! | 28–31 | quaternion (w, x, y, z): bytes, (b − 128) / 128 |
//!
//! Source: antimatter15's WebGL viewer.

use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;
use trapeze_scene::{Scene, SceneError, ShDegree};

use crate::bytes::f32s_from_le;
use crate::error::InFile;
use crate::quantised::{
    byte_of_logit, byte_of_unit, color_of_sh_dc, logit_of_byte, sh_dc_of_color,
};
use crate::recentre::recentre_f32;
use crate::splat_block::{SplatBlock, zeroed_splats};
use crate::{ParseError, ReadError, WriteError, open, write_atomically};

/// Bytes of one splat.
const SPLAT_BYTES: usize = 32;

/// Reads a `.splat` file.
///
/// # Errors
/// [`ReadError`] names the file and what was expected.
pub fn read_splat_file(path: &Path) -> Result<Scene, ReadError> {
    let bytes = open::map(path).in_file(path)?;
    parse_splat_file(&bytes).in_file(path)
}

/// Parses the bytes of a `.splat` file. The format has no mark of its own: any bytes of the right
/// length are splats.
///
/// # Errors
/// [`ParseError::Value`] when the length is not a multiple of 32.
pub fn parse_splat_file(bytes: &[u8]) -> Result<Scene, ParseError> {
    let (records, rest) = bytes.as_chunks::<SPLAT_BYTES>();
    if !rest.is_empty() {
        let expected = "a multiple of 32 bytes (one splat each)";
        return Err(ParseError::value("file size", expected, bytes.len()));
    }
    if records.len() > u32::MAX as usize {
        return Err(SceneError::TooManySplats { found: records.len() }.into());
    }
    let mut splats = zeroed_splats(records.len(), ShDegree::Zero)?;
    SplatBlock::all(&mut splats, &mut []).for_each_part(&|mut block| {
        for i in 0..block.len() {
            store(&records[block.first + i], &mut block, i);
        }
    });
    let origin = recentre_f32(&mut splats.positions);
    Ok(Scene { origin, ..Scene::from_splats(splats) })
}

fn store(record: &[u8; SPLAT_BYTES], block: &mut SplatBlock<'_>, i: usize) {
    let mut floats = f32s_from_le(&record[..24]);
    let mut three = || std::array::from_fn(|_| floats.next().unwrap_or(f32::NAN));
    block.positions[i] = three();
    // The covariance has the squares of the scales: their signs mean nothing.
    block.log_scales[i] = three().map(|scale: f32| scale.abs().ln());
    let [red, green, blue, alpha] = [record[24], record[25], record[26], record[27]];
    block.sh_dc[i] = [red, green, blue].map(|c| sh_dc_of_color(f64::from(c) / 255.0));
    block.opacity_logits[i] = logit_of_byte(alpha);
    block.rotations[i] = [28, 29, 30, 31].map(|at| (f32::from(record[at]) - 128.0) / 128.0);
}

/// Writes a `.splat` file. SH bands above 0 and feature vectors have no place in it and are left
/// out; colours are clamped to 0–1.
///
/// # Errors
/// [`WriteError::Unrepresentable`] when single precision, which the format has for positions, does
/// not hold the world coordinates of the scene; [`WriteError::Io`] with the operating system's
/// reason.
pub fn write_splat_file(path: &Path, scene: &Scene) -> Result<(), WriteError> {
    if let Some(found) = (0..scene.len()).find_map(|i| lost_in_single_precision(scene, i)) {
        return Err(WriteError::Unrepresentable {
            path: path.into(),
            what: "position".into(),
            expected: "world coordinates that single precision holds".into(),
            found: found.to_string(),
        });
    }
    write_atomically(path, |out| encode(scene, out))
}

/// World position of splat `i`, in double precision.
fn world_position(scene: &Scene, i: usize) -> DVec3 {
    DVec3::from(scene.splats.positions[i].map(f64::from)) + scene.origin
}

/// The first finite world coordinate of a splat that rounding to single precision changes.
fn lost_in_single_precision(scene: &Scene, i: usize) -> Option<f64> {
    let world = world_position(scene, i).to_array();
    world.into_iter().find(|&c| c.is_finite() && f64::from(c as f32) != c)
}

fn encode(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    for i in 0..scene.len() {
        out.write_all(&record(scene, i))?;
    }
    Ok(())
}

fn record(scene: &Scene, i: usize) -> [u8; SPLAT_BYTES] {
    let splats = &scene.splats;
    let position = world_position(scene, i).as_vec3().to_array();
    // Finite: e^88.8 is infinite in single precision, but such a scale is only very large.
    let scale = splats.log_scales[i].map(|s| s.exp().clamp(0.0, f32::MAX));
    let color = splats.sh_dc[i].map(|c| byte_of_unit(color_of_sh_dc(c)));
    let mut record = [0; SPLAT_BYTES];
    for (bytes, value) in record.chunks_exact_mut(4).zip(position.into_iter().chain(scale)) {
        bytes.copy_from_slice(&value.to_le_bytes());
    }
    record[24..27].copy_from_slice(&color);
    record[27] = byte_of_logit(splats.opacity_logits[i]);
    record[28..].copy_from_slice(&quaternion_bytes(splats.rotations[i]));
    record
}

/// Nearest bytes of the unit quaternion; one without a direction (zero, NaN) becomes the identity.
fn quaternion_bytes(rotation: [f32; 4]) -> [u8; 4] {
    let q = rotation.map(f64::from);
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    let unit = if length > 0.0 && length.is_finite() {
        q.map(|c| c / length)
    } else {
        [1.0, 0.0, 0.0, 0.0]
    };
    // The cast saturates: +1 would be 256.
    unit.map(|c| (c * 128.0 + 128.0).round() as u8)
}
