//! The images: lossless WebP, decoded with bounded memory.

use std::io::Cursor;

use image_webp::{DecodingError, WebPDecoder};
use rayon::prelude::*;
use trapeze_scene::ShDegree;

use super::meta::Meta;
use super::source::Source;
use crate::ParseError;
use crate::decompression::{check_unpacked_size, damaged, scene_bytes};

/// Place of the centroids among the images of a scene that has a palette; the only image without a
/// pixel per splat.
const CENTROIDS: usize = 5;

/// The images of a scene.
pub(super) struct Images {
    pub(super) means_l: Pixels,
    pub(super) means_u: Pixels,
    pub(super) scales: Pixels,
    pub(super) quats: Pixels,
    pub(super) sh0: Pixels,
    /// Centroids and labels.
    pub(super) palette: Option<[Pixels; 2]>,
}

/// One image, rows from the top.
pub(super) struct Pixels {
    /// Its file name, for errors.
    pub(super) name: String,
    pub(super) width: usize,
    /// Red, green, blue, alpha; not premultiplied.
    pub(super) rgba: Vec<[u8; 4]>,
}

/// A WebP file whose header has been read.
struct Header<'a> {
    name: &'a str,
    decoder: WebPDecoder<Cursor<Vec<u8>>>,
}

/// Loads the images that a description names, checks that together they are of a size that its
/// files can hold, and decodes them in parallel.
pub(super) fn load_all(meta: &Meta, source: &mut dyn Source) -> Result<Images, ParseError> {
    let mut headers = Vec::new();
    let mut file_bytes = 0;
    let palette_files = meta.palette.iter().flat_map(|palette| &palette.files);
    for name in meta.files.iter().chain(palette_files) {
        let bytes = source.load(name)?;
        file_bytes += bytes.len();
        headers.push(Header::parse(name, bytes)?);
    }
    check_sizes(meta, &headers, file_bytes)?;
    let images = headers.into_par_iter().map(Header::decode).collect::<Result<Vec<_>, _>>()?;
    let mut images = images.into_iter();
    let mut next =
        || images.next().ok_or_else(|| ParseError::value("files", "an image", "nothing"));
    Ok(Images {
        means_l: next()?,
        means_u: next()?,
        scales: next()?,
        quats: next()?,
        sh0: next()?,
        palette: if meta.palette.is_some() { Some([next()?, next()?]) } else { None },
    })
}

/// Each image but the centroids has a pixel for every splat; all of them, and the splats that they
/// become, are bounded by the bytes they come from.
fn check_sizes(meta: &Meta, headers: &[Header<'_>], file_bytes: usize) -> Result<(), ParseError> {
    for (i, header) in headers.iter().enumerate() {
        if i != CENTROIDS && header.pixels() < meta.count {
            let expected = format!("at least {} pixels, one per splat", meta.count);
            return Err(ParseError::value(header.name, expected, header.pixels()));
        }
    }
    let pixels: u64 = headers.iter().map(Header::pixels).sum();
    let coefficients = if meta.palette.is_some() { ShDegree::Three.rest_coefficients() } else { 0 };
    let scene = scene_bytes(meta.count, coefficients);
    check_unpacked_size(scene.saturating_add(4 * pixels), file_bytes, "images")
}

impl<'a> Header<'a> {
    fn parse(name: &'a str, bytes: Vec<u8>) -> Result<Self, ParseError> {
        let mut decoder =
            WebPDecoder::new(Cursor::new(bytes)).map_err(|e| damaged("WebP", name, e))?;
        if decoder.is_lossy() || decoder.is_animated() {
            let found = if decoder.is_lossy() { "lossy compression" } else { "an animation" };
            return Err(ParseError::value(name, "a lossless WebP image", found));
        }
        Ok(Self { name, decoder })
    }

    /// At most 2²⁸: a WebP side has 14 bits.
    fn pixels(&self) -> u64 {
        let (width, height) = self.decoder.dimensions();
        u64::from(width) * u64::from(height)
    }

    fn decode(mut self) -> Result<Pixels, ParseError> {
        let pixels = self.pixels() as usize;
        let refused = |e: DecodingError| damaged("WebP", self.name, e);
        let rgba = if self.decoder.has_alpha() {
            let mut rgba = vec![[0; 4]; pixels];
            self.decoder.read_image(rgba.as_flattened_mut()).map_err(refused)?;
            rgba
        } else {
            let mut rgb = vec![[0; 3]; pixels];
            self.decoder.read_image(rgb.as_flattened_mut()).map_err(refused)?;
            rgb.into_iter().map(|[r, g, b]| [r, g, b, 255]).collect()
        };
        let width = self.decoder.dimensions().0 as usize;
        Ok(Pixels { name: self.name.into(), width, rgba })
    }
}

#[cfg(test)]
mod tests {
    use image_webp::{ColorType, WebPEncoder};

    use super::*;

    #[test]
    fn every_byte_of_a_lossless_image_comes_back_whatever_its_alpha() {
        let rgba: Vec<u8> = (0..64 * 64)
            .flat_map(|i| [i as u8, (i >> 4) as u8, 255 - i as u8, (i * 7) as u8])
            .collect();
        let mut file = Vec::new();
        WebPEncoder::new(&mut file).encode(&rgba, 64, 64, ColorType::Rgba8).unwrap();
        let pixels = Header::parse("x.webp", file).unwrap().decode().unwrap();
        assert_eq!(pixels.rgba.as_flattened(), rgba);
    }
}
