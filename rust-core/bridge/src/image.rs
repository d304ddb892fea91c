//! Pictures on their way to Swift.

use trapeze_scene::Rgba8;

/// An image of 8-bit r g b a, not premultiplied, rows top to bottom.
#[derive(Debug)]
pub(crate) struct Image(Rgba8);

impl Image {
    pub(crate) fn new(picture: Rgba8) -> Self {
        Self(picture)
    }

    pub(crate) fn width(&self) -> u32 {
        self.0.width
    }

    pub(crate) fn height(&self) -> u32 {
        self.0.height
    }

    pub(crate) fn bytes(&self) -> *const u8 {
        self.0.pixels.as_ptr()
    }

    pub(crate) fn byte_count(&self) -> usize {
        self.0.pixels.len()
    }

    #[cfg(test)]
    pub(crate) fn rgba(&self) -> &[u8] {
        &self.0.pixels
    }
}
