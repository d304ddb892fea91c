//! Images as files.

use std::io::Write;
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use trapeze_formats::write_atomically;
use trapeze_scene::Rgba8;

use crate::error::CliError;

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
