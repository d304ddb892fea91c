//! From pixels to splats.

use std::f64::consts::SQRT_2;

use glam::DVec3;
use rayon::prelude::*;
use trapeze_scene::{Scene, ShDegree, Splats};

use super::image::{Images, Pixels};
use super::meta::{Meta, Palette};
use crate::ParseError;
use crate::recentre::recentre_f64;
use crate::splat_block::expect_memory_for;

/// Splats that one task decodes.
const CHUNK: usize = 1 << 14;
/// Entries of a palette in one row of its image.
const PALETTE_COLUMNS: usize = 64;
/// Alpha of a quaternion whose largest component is w; 253 to 255 stand for x, y, z.
const LARGEST_IS_W: u8 = 252;

/// Decodes images that have at least `meta.count` pixels each.
pub(super) fn scene(meta: &Meta, images: &Images) -> Result<Scene, ParseError> {
    let n = meta.count as usize;
    let highest = if meta.palette.is_some() { ShDegree::Three } else { ShDegree::Zero };
    expect_memory_for(n, highest)?;
    let (sh_rest, sh_degree) = match (&meta.palette, &images.palette) {
        (Some(palette), Some([centroids, labels])) => sh_rest(palette, centroids, labels, n)?,
        _ => (Vec::new(), ShDegree::Zero),
    };
    let (positions, origin) = positions(meta, images);
    let splats = Splats {
        positions,
        log_scales: images.scales.first(n).map(|p| lookup(&meta.scales, p)).collect(),
        rotations: rotations(&images.quats, n)?,
        opacity_logits: images.sh0.first(n).map(|p| meta.opacity[usize::from(p[3])]).collect(),
        sh_dc: images.sh0.first(n).map(|p| lookup(&meta.sh0, p)).collect(),
        sh_rest,
        sh_degree,
    };
    splats.validate()?;
    Ok(Scene { origin, antialiased: meta.antialiased, ..Scene::from_splats(splats) })
}

impl Pixels {
    /// The pixels of the first `n` splats.
    fn first(&self, n: usize) -> impl IndexedParallelIterator<Item = &[u8; 4]> {
        self.rgba[..n].par_iter().with_min_len(CHUNK)
    }
}

fn lookup(tables: &[[f32; 256]; 3], pixel: &[u8; 4]) -> [f32; 3] {
    std::array::from_fn(|c| tables[c][usize::from(pixel[c])])
}

/// 16 bits per axis over the range of sign(x)·ln(1 + |x|), relative to the origin that is returned.
fn positions(meta: &Meta, images: &Images) -> (Vec<[f32; 3]>, DVec3) {
    let n = meta.count as usize;
    let decode = |(low, high): (&[u8; 4], &[u8; 4])| {
        std::array::from_fn(|axis| {
            let [min, max] = meta.means[axis];
            let fraction = f64::from(u16::from_le_bytes([low[axis], high[axis]])) / 65535.0;
            let logarithm = min + (max - min) * fraction;
            logarithm.abs().exp_m1().copysign(logarithm)
        })
    };
    let world: Vec<[f64; 3]> =
        images.means_l.first(n).zip(images.means_u.first(n)).map(decode).collect();
    recentre_f64(&world)
}

fn rotations(quats: &Pixels, n: usize) -> Result<Vec<[f32; 4]>, ParseError> {
    let rotation = |(i, pixel): (usize, &[u8; 4])| {
        unpack_rotation(*pixel).ok_or_else(|| {
            let field = format!("{}: alpha of pixel {i}", quats.name);
            ParseError::value(field, "252 to 255", pixel[3])
        })
    };
    quats.first(n).enumerate().map(rotation).collect()
}

/// (w, x, y, z) from the three smallest components in that order; the largest is positive and
/// follows from the unit length.
fn unpack_rotation([a, b, c, mode]: [u8; 4]) -> Option<[f32; 4]> {
    let largest = usize::from(mode.checked_sub(LARGEST_IS_W)?);
    let smallest = [a, b, c].map(|byte| (f64::from(byte) / 127.5 - 1.0) / SQRT_2);
    let mut q = [0.0; 4];
    for (slot, value) in (0..4).filter(|&i| i != largest).zip(smallest) {
        q[slot] = value;
    }
    let squares: f64 = smallest.iter().map(|x| x * x).sum();
    q[largest] = (1.0 - squares).max(0.0).sqrt();
    Some(q.map(|component| component as f32))
}

/// Copies each splat's entry of the palette.
fn sh_rest(
    palette: &Palette,
    centroids: &Pixels,
    labels: &Pixels,
    n: usize,
) -> Result<(Vec<f32>, ShDegree), ParseError> {
    let degree = palette_degree(palette, centroids)?;
    let coefficients = degree.rest_coefficients();
    if coefficients == 0 {
        return Ok((Vec::new(), degree));
    }
    let entries = palette_entries(palette, centroids, coefficients)?;
    let values: Vec<f32> = centroids
        .rgba
        .par_iter()
        .flat_map_iter(|p| p[..3].iter().map(|&byte| palette.table[usize::from(byte)]))
        .collect();
    let stride = coefficients * 3;
    let mut rest = vec![0.0; n * stride];
    let copy = |(i, (target, pixel)): (usize, (&mut [f32], &[u8; 4]))| {
        let label = usize::from(u16::from_le_bytes([pixel[0], pixel[1]]));
        if label >= entries {
            let field = format!("{}: label of splat {i}", labels.name);
            return Err(ParseError::value(field, format!("below {entries}"), label));
        }
        target.copy_from_slice(&values[label * stride..][..stride]);
        Ok(())
    };
    rest.par_chunks_exact_mut(stride).zip(labels.first(n)).enumerate().try_for_each(copy)?;
    Ok((rest, degree))
}

/// Number of entries. They lie one after the other, row by row, so the image is the palette in
/// order, and what version 2 states is at most what the image holds.
fn palette_entries(
    palette: &Palette,
    centroids: &Pixels,
    coefficients: usize,
) -> Result<usize, ParseError> {
    let held = centroids.rgba.len() / coefficients;
    match palette.entries {
        Some(stated) if stated > held as u64 => {
            let expected = format!("at most the {held} of {}", centroids.name);
            Err(ParseError::value("shN.count", expected, stated))
        }
        Some(stated) => Ok(stated as usize),
        None => Ok(held),
    }
}

/// The degree whose coefficients fill the width of the palette's image.
fn palette_degree(palette: &Palette, centroids: &Pixels) -> Result<ShDegree, ParseError> {
    let by_width = ShDegree::ALL
        .into_iter()
        .find(|d| d.rest_coefficients() * PALETTE_COLUMNS == centroids.width);
    match (palette.degree, by_width) {
        // A palette without bands has no image to speak of.
        (Some(ShDegree::Zero), _) => Ok(ShDegree::Zero),
        (None, Some(degree)) => Ok(degree),
        (Some(stated), Some(degree)) if stated == degree => Ok(degree),
        (stated, _) => {
            let expected = stated.map_or("a width of 192, 512 or 960".into(), |d| {
                format!("a width of {}", d.rest_coefficients() * PALETTE_COLUMNS)
            });
            Err(ParseError::value(&centroids.name, expected, centroids.width))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_alpha_of_a_quaternion_says_which_component_is_missing() {
        for largest in 0..4 {
            let q = unpack_rotation([128, 127, 128, LARGEST_IS_W + largest as u8]).unwrap();
            assert!(q[largest] > 0.99, "{q:?}");
            assert!((q.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-6);
        }
        assert_eq!(unpack_rotation([0, 0, 0, 251]), None);
    }
}
