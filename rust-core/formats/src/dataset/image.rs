//! An image as training keeps it: eight bits a channel, converted when it is used.

/// A photograph, row by row from the top left.
///
/// Kept as bytes because a training set is read over and over and is the largest thing that a
/// training run on the CPU holds; a byte is all that the files have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// 3 for red, green, blue; 4 with alpha. A file whose alpha is 255 everywhere has 3.
    pub channels: u8,
    /// `height` × `width` × `channels` values in display space; colour is not premultiplied.
    pub values: Vec<u8>,
    /// `height` × `width` loss weights, 0 to ignore a pixel and 255 to count it; `None` counts
    /// every pixel. Comes from a mask, and from pixels that undistortion left without a source.
    pub weights: Option<Vec<u8>>,
}

impl Image {
    /// Number of pixels.
    #[must_use]
    pub fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Bytes that the image occupies.
    #[must_use]
    pub fn byte_size(&self) -> usize {
        self.values.len() + self.weights.as_ref().map_or(0, Vec::len)
    }

    /// Whether the image has an alpha channel.
    #[must_use]
    pub fn has_alpha(&self) -> bool {
        self.channels == 4
    }

    /// Red, green, blue (not premultiplied) and alpha of a pixel, 0 to 1.
    ///
    /// # Panics
    /// When `pixel` is not below [`pixel_count`](Self::pixel_count).
    #[must_use]
    pub fn rgba(&self, pixel: usize) -> [f32; 4] {
        let channels = usize::from(self.channels);
        let values = &self.values[pixel * channels..][..channels];
        let alpha = if self.has_alpha() { values[3] } else { u8::MAX };
        [values[0], values[1], values[2], alpha].map(|v| f32::from(v) / 255.0)
    }

    /// Loss weight of a pixel, 0 to 1.
    ///
    /// # Panics
    /// When `pixel` is not below [`pixel_count`](Self::pixel_count).
    #[must_use]
    pub fn weight(&self, pixel: usize) -> f32 {
        self.weights.as_ref().map_or(1.0, |weights| f32::from(weights[pixel]) / 255.0)
    }

    /// The image over a background, as `height` × `width` × 3 floats.
    ///
    /// `rgb` is cleared first and keeps its allocation, so that one buffer serves every step.
    pub fn composite_over(&self, background: [f32; 3], rgb: &mut Vec<f32>) {
        rgb.clear();
        if !self.has_alpha() {
            rgb.extend(self.values.iter().map(|&v| f32::from(v) / 255.0));
            return;
        }
        rgb.reserve(self.pixel_count() * 3);
        for pixel in 0..self.pixel_count() {
            let [r, g, b, alpha] = self.rgba(pixel);
            for (color, behind) in [r, g, b].into_iter().zip(background) {
                rgb.push(color * alpha + behind * (1.0 - alpha));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_composites_over_the_background_and_opaque_images_ignore_it() {
        let mut rgb = vec![9.0; 2];
        let image = Image {
            width: 2,
            height: 1,
            channels: 4,
            values: vec![255, 0, 0, 51, 0, 255, 0, 255],
            weights: None,
        };
        image.composite_over([0.0, 0.0, 1.0], &mut rgb);
        let expected = [0.2, 0.0, 0.8, 0.0, 1.0, 0.0];
        assert!(rgb.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{rgb:?}");

        let image = Image { channels: 3, values: vec![255, 0, 51, 0, 0, 0], ..image };
        image.composite_over([1.0; 3], &mut rgb);
        assert_eq!(rgb, [1.0, 0.0, 0.2, 0.0, 0.0, 0.0]);
    }
}
