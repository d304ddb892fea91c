//! From splats to quantised streams.

use glam::{DVec3, DVec4};
use rayon::prelude::*;
use trapeze_scene::{Scene, Splats};

use super::container::SpzFile;
use super::header::Header;
use super::rotation::pack_smallest_three;
use super::{AxisSigns, COLOR_STEPS, LOG_SCALE_OFFSET, LOG_SCALE_STEPS, SH_STEPS};
use crate::quantised::byte_of_logit;

/// Finest step of a position that is written, 2⁻²⁰: below a single-precision ulp from 8 units on.
const MOST_FRACTIONAL_BITS: u8 = 20;
/// Coarsest step for a scene that is far from the coordinate zero, 2⁻¹⁰: a millimetre of a metre,
/// and what single precision resolves where a scene is given an origin.
const LEAST_FAR_FRACTIONAL_BITS: u8 = 10;
/// Largest magnitude of a 24-bit fixed-point number.
const MOST_FIXED: f64 = ((1 << 23) - 1) as f64;

/// The version of the format to write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpzVersion {
    /// One gzip stream; opened by every program that reads SPZ.
    #[default]
    V3,
    /// One zstd stream per attribute (2026).
    V4,
}

/// How an SPZ file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpzOptions {
    /// The version of the format.
    pub version: SpzVersion,
    /// Bits kept of each SH coefficient, limited to 1–8: of band 1, and of bands 2 and 3. A
    /// coefficient has eight bits in every file; those dropped compress away. The reference writer
    /// keeps 5 and 4, which costs up to 1/16 per coefficient of the higher bands; the default keeps
    /// all.
    pub sh_bits: [u8; 2],
}

impl Default for SpzOptions {
    fn default() -> Self {
        Self { version: SpzVersion::default(), sh_bits: [8; 2] }
    }
}

/// A part of the scene that the format cannot hold.
#[derive(Debug)]
pub(super) struct Misfit {
    pub(super) what: &'static str,
    pub(super) expected: String,
    pub(super) found: String,
}

/// Quantises a scene.
pub(super) fn pack(scene: &Scene, options: &SpzOptions) -> Result<SpzFile, Misfit> {
    let splats = &scene.splats;
    let signs = AxisSigns::right_up_back();
    let fractional_bits = fractional_bits(scene)?;
    let count = u32::try_from(splats.len()).map_err(|_| Misfit {
        what: "splats",
        expected: "at most 4294967295".into(),
        found: splats.len().to_string(),
    })?;
    warn_about_clamping(splats);
    let header = Header {
        version: if options.version == SpzVersion::V4 { 4 } else { 3 },
        splats: count,
        sh_degree: splats.sh_degree as u8,
        fractional_bits,
        antialiased: scene.antialiased,
        has_extensions: false,
    };
    let streams = [
        pack_positions(scene, fractional_bits, signs),
        pack_alphas(splats),
        map_bytes(&splats.sh_dc, |c| c.map(color_byte)),
        map_bytes(&splats.log_scales, |s| s.map(log_scale_byte)),
        map_bytes(&splats.rotations, |q| pack_rotation(q, signs)),
        pack_sh(splats, options.sh_bits, signs),
    ];
    Ok(SpzFile { header, signs: signs.clone(), streams })
}

/// The finest fixed point in which the largest world coordinate still fits.
fn fractional_bits(scene: &Scene) -> Result<u8, Misfit> {
    let coordinates = scene.splats.positions.par_iter().flat_map_iter(|&p| world(p, scene.origin));
    let largest = coordinates.map(f64::abs).filter(|x| x.is_finite()).reduce(|| 0.0, f64::max);
    // A geo-referenced capture would fall apart in steps of more than this.
    let least = if scene.origin == DVec3::ZERO { 0 } else { LEAST_FAR_FRACTIONAL_BITS };
    (least..=MOST_FRACTIONAL_BITS)
        .rev()
        .find(|&bits| largest * f64::from(1_u32 << bits) <= MOST_FIXED)
        .ok_or_else(|| Misfit {
            what: "positions",
            expected: format!(
                "coordinates below {}, since SPZ has 24-bit positions and no offset",
                (1 << 23) >> least
            ),
            found: largest.to_string(),
        })
}

/// World coordinates of a position.
fn world(position: [f32; 3], origin: DVec3) -> [f64; 3] {
    (DVec3::from(position.map(f64::from)) + origin).to_array()
}

/// Concatenates the bytes of each element.
fn map_bytes<T: Copy + Sync, const N: usize>(
    values: &[T],
    f: impl Fn(T) -> [u8; N] + Sync + Send,
) -> Vec<u8> {
    values.par_iter().map(|&value| f(value)).collect::<Vec<_>>().into_flattened()
}

fn pack_positions(scene: &Scene, fractional_bits: u8, signs: &AxisSigns) -> Vec<u8> {
    let steps = f64::from(1_u32 << fractional_bits);
    map_bytes(&scene.splats.positions, |p| {
        let p = world(p, scene.origin);
        let mut bytes = [0; 9];
        for axis in 0..3 {
            // The cast takes NaN to zero and infinities to the largest integers; both are
            // coordinates of splats that are written invisible.
            let fixed = (p[axis] * f64::from(signs.position[axis]) * steps).round();
            let fixed = fixed.clamp(-MOST_FIXED, MOST_FIXED) as i32;
            bytes[3 * axis..3 * axis + 3].copy_from_slice(&fixed.to_le_bytes()[..3]);
        }
        bytes
    })
}

/// Opacities; 0 for a splat that no renderer draws and that its quantised values would show.
fn pack_alphas(splats: &Splats) -> Vec<u8> {
    (0..splats.len())
        .into_par_iter()
        .map(|i| if is_drawn(splats, i) { byte_of_logit(splats.opacity_logits[i]) } else { 0 })
        .collect()
}

/// Whether the centre and the scales of a splat are numbers.
fn is_drawn(splats: &Splats, i: usize) -> bool {
    splats.positions[i].iter().all(|x| x.is_finite())
        && splats.log_scales[i].iter().all(|s| !s.is_nan() && *s < f32::INFINITY)
}

fn color_byte(coefficient: f32) -> u8 {
    // Casts from float to integer saturate, and take NaN to zero.
    (f64::from(coefficient) * COLOR_STEPS + 127.5).round() as u8
}

fn log_scale_byte(log_scale: f32) -> u8 {
    ((log_scale - LOG_SCALE_OFFSET) * LOG_SCALE_STEPS).round() as u8
}

/// A quaternion without a direction (zero, not finite) is written as it is drawn: no rotation.
fn pack_rotation([w, x, y, z]: [f32; 4], signs: &AxisSigns) -> [u8; 4] {
    let [sx, sy, sz] = signs.rotation.map(f64::from);
    let [w, x, y, z] = [w, x, y, z].map(f64::from);
    let q = DVec4::new(sx * x, sy * y, sz * z, w);
    let q = q.try_normalize().unwrap_or(DVec4::W);
    pack_smallest_three(q.as_vec4().to_array())
}

/// SH coefficients, rounded to the nearest multiple of what the dropped bits are worth; zero stays
/// exactly zero.
fn pack_sh(splats: &Splats, bits: [u8; 2], signs: &AxisSigns) -> Vec<u8> {
    let stride = splats.sh_rest_stride();
    if stride == 0 {
        return Vec::new();
    }
    let bucket = bits.map(|bits| f32::from(1_u16 << (8 - bits.clamp(1, 8))));
    let mut bytes = vec![0; splats.sh_rest.len()];
    let quantise = |(bytes, coefficients): (&mut [u8], &[f32])| {
        for (i, (byte, &c)) in bytes.iter_mut().zip(coefficients).enumerate() {
            let bucket = bucket[usize::from(i >= 9)];
            let steps = (c * signs.sh[i / 3] * (SH_STEPS / bucket)).round() * bucket;
            *byte = (if steps.is_nan() { 128.0 } else { steps + 128.0 }) as u8;
        }
    };
    bytes
        .par_chunks_exact_mut(stride)
        .zip(splats.sh_rest.par_chunks_exact(stride))
        .for_each(quantise);
    bytes
}

/// One warning for everything that the byte ranges cut off.
fn warn_about_clamping(splats: &Splats) {
    let outside = |values: &[f32], low: f32, high: f32| {
        values.par_iter().filter(|&&x| x < low || x > high).count()
    };
    let log_scales = outside(splats.log_scales.as_flattened(), LOG_SCALE_OFFSET, 5.9375);
    let most = (127.5 / COLOR_STEPS) as f32;
    let colors = outside(splats.sh_dc.as_flattened(), -most, most);
    let sh = outside(&splats.sh_rest, -1.0, 1.0);
    let invisible = (0..splats.len()).into_par_iter().filter(|&i| !is_drawn(splats, i)).count();
    if log_scales + colors + sh + invisible > 0 {
        tracing::warn!(
            "SPZ: clamped {log_scales} log-scales to [-10, 5.94], {colors} colours to [-3.33, \
             3.33] and {sh} SH coefficients to [-1, 1]; wrote {invisible} splats whose position or \
             scale is not finite as invisible"
        );
    }
}
