//! Which of a surface's formats is used, and what values it takes.

use wgpu::TextureFormat;

/// What the values in a texture mean to the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Encoding {
    /// Display (sRGB-encoded) values, as the scene was trained: stored as they are.
    Display,
    /// Linear light: the texture encodes on write, or is read as linear.
    Linear,
}

/// Formats that can be presented, best first: eight bits of display values need no conversion, and
/// are what the training images were.
const PREFERRED: [(TextureFormat, Encoding); 6] = [
    (TextureFormat::Bgra8Unorm, Encoding::Display),
    (TextureFormat::Rgba8Unorm, Encoding::Display),
    (TextureFormat::Rgb10a2Unorm, Encoding::Display),
    (TextureFormat::Bgra8UnormSrgb, Encoding::Linear),
    (TextureFormat::Rgba8UnormSrgb, Encoding::Linear),
    // wgpu's default for it is extended linear sRGB.
    (TextureFormat::Rgba16Float, Encoding::Linear),
];

/// The best of the formats that a surface offers.
pub(crate) fn choose(offered: &[TextureFormat]) -> Option<(TextureFormat, Encoding)> {
    PREFERRED.into_iter().find(|(format, _)| offered.contains(format))
}

/// What a format takes; `None` for formats that are not presented.
pub(crate) fn encoding(format: TextureFormat) -> Option<Encoding> {
    choose(&[format]).map(|(_, encoding)| encoding)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_format_that_stores_display_values_is_preferred() {
        use TextureFormat::{Bgra8Unorm, Bgra8UnormSrgb, Rgb10a2Unorm, Rgba16Float};
        // What Metal offers, and what many Vulkan drivers offer, each in its own order.
        let metal = [Bgra8Unorm, Bgra8UnormSrgb, Rgba16Float, Rgb10a2Unorm];
        let vulkan = [Bgra8UnormSrgb, Rgba16Float, Bgra8Unorm];
        for offered in [&metal[..], &vulkan] {
            assert_eq!(choose(offered), Some((Bgra8Unorm, Encoding::Display)));
        }
        assert_eq!(
            choose(&[Rgba16Float, Bgra8UnormSrgb]),
            Some((Bgra8UnormSrgb, Encoding::Linear))
        );
        assert_eq!(choose(&[TextureFormat::R8Unorm]), None);
    }
}
