//! Frames in 8 bits, as they are looked at and written to image files.

use crate::Frame;

/// An image of 8-bit r g b a, not premultiplied, rows top to bottom.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rgba8 {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `4 × width × height` bytes.
    pub pixels: Vec<u8>,
}

impl Rgba8 {
    /// The colours of a frame: over a background and opaque, or with their own alpha.
    #[must_use]
    pub fn of_colors(frame: &Frame, background: Option<[f32; 3]>) -> Self {
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
        Self { width: frame.width, height: frame.height, pixels }
    }

    /// Depth as brightness: near is bright, from the 1st to the 99th percentile of what was hit;
    /// transparent where nothing was (NaN).
    #[must_use]
    pub fn of_depth(depth: &[f32], width: u32, height: u32) -> Self {
        let mut hit: Vec<f32> = depth.iter().copied().filter(|d| d.is_finite()).collect();
        hit.sort_unstable_by(f32::total_cmp);
        let at =
            |share: f64| hit.get((share * hit.len().saturating_sub(1) as f64) as usize).copied();
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
        Self { width, height, pixels }
    }
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
        assert_eq!(Rgba8::of_colors(&frame, None).pixels, [128, 0, 255, 128, 0, 0, 0, 0]);
        assert_eq!(Rgba8::of_colors(&frame, Some([1.0; 3])).pixels[..4], [191, 128, 255, 255]);
    }

    #[test]
    fn depth_is_brightest_where_it_is_nearest_and_clear_where_nothing_is() {
        let image = Rgba8::of_depth(&[1.0, 2.0, f32::NAN], 3, 1);
        assert_eq!(image.pixels[0], 255);
        assert!(image.pixels[4] < 255);
        assert_eq!(image.pixels[8..], [0; 4]);
    }

    #[test]
    fn depth_of_an_empty_view_is_an_empty_image() {
        assert_eq!(Rgba8::of_depth(&[f32::NAN; 4], 2, 2).pixels, [0; 16]);
        assert!(Rgba8::of_depth(&[], 0, 0).pixels.is_empty());
    }
}
