//! What a rendered view is compared with.

use thiserror::Error;

/// How many bytes a pixel of the target has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// r g b.
    Rgb = 3,
    /// r g b (not premultiplied), alpha.
    Rgba = 4,
}

/// A photograph to be matched: 8 bits a channel in display space, rows top to bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TargetImage {
    width: u32,
    height: u32,
    channels: Channels,
    pixels: Vec<u8>,
    mask: Option<Vec<u8>>,
}

/// Why an image cannot be a target, or cannot be compared with one.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TargetError {
    /// A width or height of zero.
    #[error("target image: expected at least 1 x 1 pixels, found {width} x {height}")]
    Empty {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// An array does not have one entry per pixel.
    #[error("{field}: expected {expected} values, found {found}")]
    Length {
        /// Which array.
        field: &'static str,
        /// Values that the image size asks for.
        expected: usize,
        /// Values present.
        found: usize,
    },
}

impl TargetImage {
    /// An image of `width` × `height` pixels.
    ///
    /// # Errors
    /// [`TargetError`] for an image without pixels or with another number of bytes.
    pub fn new(
        width: u32,
        height: u32,
        channels: Channels,
        pixels: Vec<u8>,
    ) -> Result<Self, TargetError> {
        if width == 0 || height == 0 {
            return Err(TargetError::Empty { width, height });
        }
        let expected = width as usize * height as usize * channels as usize;
        expect_length("target pixels", expected, pixels.len())?;
        Ok(Self { width, height, channels, pixels, mask: None })
    }

    /// The same image with a weight for each pixel: 255 counts in full, 0 not at all.
    ///
    /// # Errors
    /// [`TargetError::Length`] when the mask has another size than the image.
    pub fn with_mask(mut self, mask: Vec<u8>) -> Result<Self, TargetError> {
        expect_length("mask", self.len(), mask.len())?;
        self.mask = Some(mask);
        Ok(self)
    }

    /// Pixels per row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width as usize
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height as usize
    }

    /// Number of pixels, at least 1.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "an image without pixels cannot be made")]
    pub fn len(&self) -> usize {
        self.width() * self.height()
    }

    /// Whether there is an alpha channel.
    #[must_use]
    pub fn channels(&self) -> Channels {
        self.channels
    }

    /// The bytes, [`Channels`] per pixel.
    #[must_use]
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The weight of every pixel, if not all count the same.
    #[must_use]
    pub fn mask(&self) -> Option<&[u8]> {
        self.mask.as_deref()
    }

    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.pixels.len() + self.mask.as_ref().map_or(0, Vec::len)
    }

    /// The colour of pixel `i` over `background`, and its weight in 0–1, in double precision.
    #[must_use]
    pub fn over(&self, i: usize, background: [f64; 3]) -> ([f64; 3], f64) {
        let unit = |byte: u8| f64::from(byte) / 255.0;
        let pixel = &self.pixels[i * self.channels as usize..][..self.channels as usize];
        let alpha = pixel.get(3).map_or(1.0, |&a| unit(a));
        let color = std::array::from_fn(|c| alpha * unit(pixel[c]) + (1.0 - alpha) * background[c]);
        (color, self.mask.as_ref().map_or(1.0, |mask| unit(mask[i])))
    }
}

pub(super) fn expect_length(
    field: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), TargetError> {
    if expected == found { Ok(()) } else { Err(TargetError::Length { field, expected, found }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_of_the_wrong_size_are_refused_by_name() {
        let error = TargetImage::new(2, 2, Channels::Rgb, vec![0; 11]).unwrap_err();
        assert_eq!(error.to_string(), "target pixels: expected 12 values, found 11");
        let error = TargetImage::new(0, 2, Channels::Rgb, vec![]).unwrap_err();
        assert!(error.to_string().contains("at least 1 x 1"), "{error}");
        let image = TargetImage::new(1, 1, Channels::Rgba, vec![0; 4]).unwrap();
        assert!(image.with_mask(vec![0; 2]).unwrap_err().to_string().starts_with("mask: "));
    }

    #[test]
    fn alpha_lets_the_background_through() {
        let image = TargetImage::new(1, 1, Channels::Rgba, vec![255, 0, 0, 51]).unwrap();
        let ([r, g, b], weight) = image.over(0, [0.5, 1.0, 0.0]);
        assert!((r - 0.6).abs() < 1e-15 && (g - 0.8).abs() < 1e-15 && b == 0.0 && weight == 1.0);
    }
}
