//! From quantised streams to splats.

use rayon::prelude::*;
use trapeze_scene::{Scene, ShDegree, Splats};

use super::container::SpzFile;
use super::rotation::{unpack_first_three, unpack_smallest_three};
use super::{AxisSigns, COLOR_STEPS, LOG_SCALE_OFFSET, LOG_SCALE_STEPS, SH_STEPS};
use crate::ParseError;
use crate::quantised::logit_of_byte;
use crate::recentre::recentre_f32;
use crate::splat_block::expect_memory_for;

/// Splats that one task decodes.
const CHUNK: usize = 1 << 14;

/// Decodes a file whose streams have the lengths that its header promises.
pub(super) fn scene(file: &SpzFile) -> Result<Scene, ParseError> {
    let degree = ShDegree::try_from(u32::from(file.header.sh_degree).min(3))?;
    expect_memory_for(file.header.splats as usize, degree)?;
    let [positions, alphas, colors, scales, rotations, sh] = &file.streams;
    let signs = &file.signs;
    let log_scale = |b: u8| f32::from(b) / LOG_SCALE_STEPS + LOG_SCALE_OFFSET;
    let color = |b: u8| ((f64::from(b) - 127.5) / COLOR_STEPS) as f32;
    let (sh_rest, sh_degree) = sh_rest(file, sh)?;
    let mut positions = decode_positions(positions, file.header.fractional_bits, signs);
    let origin = recentre_f32(&mut positions);
    let splats = Splats {
        positions,
        log_scales: map_splats(scales, |b: [u8; 3]| b.map(log_scale)),
        rotations: if file.header.version == 2 {
            map_splats(rotations, |b| to_our_axes(unpack_first_three(b), signs))
        } else {
            map_splats(rotations, |b| to_our_axes(unpack_smallest_three(b), signs))
        },
        opacity_logits: map_splats(alphas, |[b]| logit_of_byte(b)),
        sh_dc: map_splats(colors, |b: [u8; 3]| b.map(color)),
        sh_rest,
        sh_degree,
    };
    splats.validate()?;
    let antialiased = file.header.antialiased;
    Ok(Scene { origin, antialiased, ..Scene::from_splats(splats) })
}

/// Applies `f` to the `N` bytes of each splat.
fn map_splats<const N: usize, T: Send>(
    stream: &[u8],
    f: impl Fn([u8; N]) -> T + Sync + Send,
) -> Vec<T> {
    let (splats, _) = stream.as_chunks::<N>();
    splats.par_iter().with_min_len(CHUNK).map(|&bytes| f(bytes)).collect()
}

/// Every 24-bit integer and every power of two is exact in single precision, and so is their
/// product.
fn decode_positions(stream: &[u8], fractional_bits: u8, signs: &AxisSigns) -> Vec<[f32; 3]> {
    let step = 1.0 / (1_u32 << fractional_bits) as f32;
    map_splats(stream, |b: [u8; 9]| {
        std::array::from_fn(|axis| {
            // In the upper three bytes, so that the shift back extends the sign.
            let fixed = i32::from_le_bytes([0, b[3 * axis], b[3 * axis + 1], b[3 * axis + 2]]) >> 8;
            fixed as f32 * step * signs.position[axis]
        })
    })
}

/// From (x, y, z, w) in the file's axes to (w, x, y, z) in ours.
fn to_our_axes([x, y, z, w]: [f32; 4], signs: &AxisSigns) -> [f32; 4] {
    let [sx, sy, sz] = signs.rotation;
    [w, sx * x, sy * y, sz * z]
}

/// The SH bands that a scene can hold: degree 4 is cut to 3.
fn sh_rest(file: &SpzFile, stream: &[u8]) -> Result<(Vec<f32>, ShDegree), ParseError> {
    let stored = u32::from(file.header.sh_degree);
    if stored > 3 {
        tracing::warn!("SPZ shDegree {stored}: bands above 3 are left out");
    }
    let degree = ShDegree::try_from(stored.min(3))?;
    let kept = degree.rest_coefficients() * 3;
    if kept == 0 {
        return Ok((Vec::new(), degree));
    }
    let mut rest = vec![0.0; file.header.splats as usize * kept];
    let stride = file.header.sh_coefficients() * 3;
    rest.par_chunks_exact_mut(kept)
        .zip(stream.par_chunks_exact(stride))
        .with_min_len(CHUNK)
        .for_each(|(values, bytes)| {
            for ((value, &byte), j) in values.iter_mut().zip(bytes).zip(0..) {
                *value = (f32::from(byte) - 128.0) / SH_STEPS * file.signs.sh[j / 3];
            }
        });
    Ok((rest, degree))
}
