//! From pixels to planes and back: what is compared, and what the rasteriser's backward pass wants.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4};
use fearless_simd_macros::simd;

use super::target::Channels;

const UNIT: f32 = 1.0 / 255.0;
/// Pixels that are turned from interleaved to planar at a time.
const PIXELS: usize = 4;

/// One row of the target, and the weight of its pixels.
#[derive(Clone, Copy)]
pub(super) struct TargetRow<'a> {
    pub(super) channels: Channels,
    pub(super) pixels: &'a [u8],
    pub(super) mask: Option<&'a [u8]>,
}

/// One row of the render over the background, channel by channel.
#[simd]
pub(super) fn composite_row<S: Simd>(
    simd: S,
    render: &[[f32; 4]],
    background: [f32; 3],
    planes: [&mut [f32]; 3],
) {
    let [plane_r, plane_g, plane_b] = planes;
    let [behind_r, behind_g, behind_b] = background;
    let (blocks, rest) = render.as_chunks::<PIXELS>();
    for (block, pixels) in blocks.iter().enumerate() {
        let at = block * PIXELS..(block + 1) * PIXELS;
        let [r, g, b, a] = f32x4::load_four_interleaved(simd, pixels.as_flattened());
        let through = f32x4::splat(simd, 1.0) - a;
        (r + through * behind_r).store_slice(&mut plane_r[at.clone()]);
        (g + through * behind_g).store_slice(&mut plane_g[at.clone()]);
        (b + through * behind_b).store_slice(&mut plane_b[at]);
    }
    for (i, &[r, g, b, a]) in (blocks.len() * PIXELS..).zip(rest) {
        let through = 1.0 - a;
        plane_r[i] = r + through * behind_r;
        plane_g[i] = g + through * behind_g;
        plane_b[i] = b + through * behind_b;
    }
}

/// One channel of a row of the target over the background.
#[simd]
pub(super) fn target_row<S: Simd>(
    _: S,
    target: TargetRow<'_>,
    channel: usize,
    behind: f32,
    plane: &mut [f32],
) {
    match target.channels {
        Channels::Rgb => {
            for (y, pixel) in plane.iter_mut().zip(target.pixels.as_chunks::<3>().0) {
                *y = f32::from(pixel[channel]) * UNIT;
            }
        }
        Channels::Rgba => {
            for (y, pixel) in plane.iter_mut().zip(target.pixels.as_chunks::<4>().0) {
                let alpha = f32::from(pixel[3]) * UNIT;
                *y = alpha * (f32::from(pixel[channel]) * UNIT) + (1.0 - alpha) * behind;
            }
        }
    }
}

/// Lets the target stand in for the render where the mask says so, see
/// [`reference`](super::reference).
#[simd]
pub(super) fn mask_row<S: Simd>(_: S, mask: &[u8], x: &mut [f32], y: &[f32]) {
    for ((x, &y), &weight) in x.iter_mut().zip(y).zip(mask) {
        let weight = f32::from(weight) * UNIT;
        *x = weight * *x + (1.0 - weight) * y;
    }
}

/// Gathers one row of ∂loss/∂x into ∂loss/∂(r, g, b premultiplied, alpha): x = rgb + (1 − α)·bg, so
/// the derivative by alpha is −Σ g·bg.
#[simd]
pub(super) fn join_row<S: Simd>(
    simd: S,
    [plane_r, plane_g, plane_b]: [&[f32]; 3],
    mask: Option<&[u8]>,
    background: [f32; 3],
    out: &mut [[f32; 4]],
) {
    let [behind_r, behind_g, behind_b] = background;
    let (blocks, rest) = out.as_chunks_mut::<PIXELS>();
    let rest_start = blocks.len() * PIXELS;
    for (block, pixels) in blocks.iter_mut().enumerate() {
        let at = block * PIXELS..(block + 1) * PIXELS;
        let r = f32x4::from_slice(simd, &plane_r[at.clone()]);
        let g = f32x4::from_slice(simd, &plane_g[at.clone()]);
        let b = f32x4::from_slice(simd, &plane_b[at]);
        let a = -(r * behind_r + g * behind_g + b * behind_b);
        f32x4::store_four_interleaved([r, g, b, a], pixels.as_flattened_mut());
    }
    for (i, out) in (rest_start..).zip(rest) {
        let (r, g, b) = (plane_r[i], plane_g[i], plane_b[i]);
        *out = [r, g, b, -(r * behind_r + g * behind_g + b * behind_b)];
    }
    if let Some(mask) = mask {
        for (out, &weight) in out.iter_mut().zip(mask) {
            let weight = f32::from(weight) * UNIT;
            for component in out {
                *component *= weight;
            }
        }
    }
}
