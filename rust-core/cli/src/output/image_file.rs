//! Images as files.

use std::io::Write;
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use trapeze_formats::write_atomically;
use trapeze_scene::Frame;

use crate::error::CliError;

/// An image of 8-bit r g b a, not premultiplied.
#[derive(Clone, Debug)]
pub(crate) struct Rgba8 {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pixels: Vec<u8>,
}

/// The frame in 8 bits: over a background and opaque, or with its own alpha.
pub(crate) fn to_rgba8(frame: &Frame, background: Option<[f32; 3]>) -> Rgba8 {
    let quantise = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
    let pixels = match background {
        Some(background) => frame
            .over(background)
            .iter()
            .flat_map(|&[r, g, b, _]| [r, g, b, 1.0].map(quantise))
            .collect(),
        None => frame
            .color
            .iter()
            .flat_map(|&[r, g, b, a]| {
                let straight = |c: f32| if a > 0.0 { c / a } else { 0.0 };
                [straight(r), straight(g), straight(b), a].map(quantise)
            })
            .collect(),
    };
    Rgba8 { width: frame.width, height: frame.height, pixels }
}

/// Depth as brightness: near is bright, from the 1st to the 99th percentile of what was hit;
/// transparent where nothing was.
pub(crate) fn depth_image(depth: &[f32], width: u32, height: u32) -> Rgba8 {
    let mut hit: Vec<f32> = depth.iter().copied().filter(|d| d.is_finite()).collect();
    hit.sort_unstable_by(f32::total_cmp);
    let at = |share: f64| hit.get((share * hit.len().saturating_sub(1) as f64) as usize).copied();
    let (near, far) = (at(0.01).unwrap_or(0.0), at(0.99).unwrap_or(1.0));
    let range = (far - near).max(f32::MIN_POSITIVE);
    let pixels = depth
        .iter()
        .flat_map(|&d| {
            if !d.is_finite() {
                return [0; 4];
            }
            let brightness = 1.0 - ((d - near) / range).clamp(0.0, 1.0);
            let v = (30.0 + 225.0 * brightness).round() as u8;
            [v, v, v, 255]
        })
        .collect();
    Rgba8 { width, height, pixels }
}

/// Writes a PNG file, without alpha where the image is opaque.
pub(crate) fn write_png(path: &Path, image: &Rgba8) -> Result<(), CliError> {
    let opaque = image.pixels.chunks_exact(4).all(|p| p[3] == 255);
    let (pixels, kind) = if opaque {
        let rgb = image.pixels.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        (rgb, ExtendedColorType::Rgb8)
    } else {
        (image.pixels.clone(), ExtendedColorType::Rgba8)
    };
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(&pixels, image.width, image.height, kind)
        .map_err(|e| CliError::Encode { path: path.into(), reason: e.to_string() })?;
    write_atomically(path, |file| file.write_all(&bytes))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_alpha_undoes_the_premultiplication() {
        let frame = Frame {
            width: 2,
            height: 1,
            color: vec![[0.25, 0.0, 0.5, 0.5], [0.0; 4]],
            ..Frame::default()
        };
        assert_eq!(to_rgba8(&frame, None).pixels, [128, 0, 255, 128, 0, 0, 0, 0]);
        assert_eq!(to_rgba8(&frame, Some([1.0; 3])).pixels[..4], [191, 128, 255, 255]);
    }

    #[test]
    fn depth_is_brightest_where_it_is_nearest_and_clear_where_nothing_is() {
        let image = depth_image(&[1.0, 2.0, f32::NAN], 3, 1);
        assert_eq!(image.pixels[0], 255);
        assert!(image.pixels[4] < 255);
        assert_eq!(image.pixels[8..], [0; 4]);
    }

    #[test]
    fn depth_of_an_empty_view_is_an_empty_image() {
        assert_eq!(depth_image(&[f32::NAN; 4], 2, 2).pixels, [0; 16]);
        assert!(depth_image(&[], 0, 0).pixels.is_empty());
    }
}
