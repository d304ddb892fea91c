//! From a picture to the numbers that an image tower takes.

use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};

use super::{Filter, ImageTower, ResizeRule};

/// Fills what `longest` leaves.
const PADDING: Rgb<u8> = Rgb([128; 3]);

/// Resizes a picture as the tower was trained, and writes it as planes of (v / 255 − mean) / std:
/// 3 × size × size numbers. An empty picture is grey.
///
/// # Panics
/// When `planes` has another length.
pub fn prepare(image: &RgbImage, tower: &ImageTower, planes: &mut [f32]) {
    let square = resized_square(image, tower);
    let pixels = (tower.size as usize).pow(2);
    assert_eq!(planes.len(), 3 * pixels);
    for (channel, plane) in planes.chunks_exact_mut(pixels).enumerate() {
        let (mean, std) = (tower.mean[channel], tower.std[channel]);
        for (value, pixel) in plane.iter_mut().zip(square.pixels()) {
            *value = (f32::from(pixel.0[channel]) / 255.0 - mean) / std;
        }
    }
}

/// The picture as a square in 8 bits.
fn resized_square(image: &RgbImage, tower: &ImageTower) -> RgbImage {
    let size = tower.size;
    let (width, height) = image.dimensions();
    if width == 0 || height == 0 {
        return RgbImage::from_pixel(size, size, PADDING);
    }
    // Integer division as torchvision's `Resize`, rounding half to even as its `CenterCrop`.
    let scaled = |side: u32, other: u32| {
        let exact = u64::from(size) * u64::from(side) / u64::from(other);
        u32::try_from(exact).unwrap_or(u32::MAX).max(1)
    };
    let centre = |extra: u32| (f64::from(extra) / 2.0).round_ties_even() as u32;
    match tower.resize {
        ResizeRule::Squash => resized(image, size, size, tower.filter),
        ResizeRule::Shortest => {
            let image = central_part(image);
            let (width, height) = image.dimensions();
            let short = width.min(height);
            let whole = resized(&image, scaled(width, short), scaled(height, short), tower.filter);
            let (x, y) = (centre(whole.width() - size), centre(whole.height() - size));
            imageops::crop_imm(&whole, x, y, size, size).to_image()
        }
        ResizeRule::Longest => {
            let long = width.max(height);
            let whole = resized(image, scaled(width, long), scaled(height, long), tower.filter);
            let mut square = RgbImage::from_pixel(size, size, PADDING);
            let (x, y) = (centre(size - whole.width()), centre(size - whole.height()));
            imageops::replace(&mut square, &whole, x.into(), y.into());
            square
        }
    }
}

/// What `shortest` keeps of a picture, with a margin for the filter: scaling a strip of
/// 1 × 100 000 pixels as a whole would take gigabytes. Pictures of common shapes stay as they are.
fn central_part(image: &RgbImage) -> std::borrow::Cow<'_, RgbImage> {
    const MOST: u32 = 16;
    let (width, height) = image.dimensions();
    let limit = width.min(height).saturating_mul(MOST);
    if width <= limit && height <= limit {
        return std::borrow::Cow::Borrowed(image);
    }
    let (kept_width, kept_height) = (width.min(limit), height.min(limit));
    let (x, y) = ((width - kept_width) / 2, (height - kept_height) / 2);
    std::borrow::Cow::Owned(imageops::crop_imm(image, x, y, kept_width, kept_height).to_image())
}

/// The picture in another size, antialiased.
///
/// Pillow rounds to 8 bits between its two passes, this does not: with weights that sum to one and
/// are not negative (bilinear) the results are at most one level apart.
fn resized(image: &RgbImage, width: u32, height: u32, filter: Filter) -> RgbImage {
    let filter = match filter {
        Filter::Bilinear => FilterType::Triangle,
        Filter::Bicubic => FilterType::CatmullRom,
    };
    imageops::resize(image, width, height, filter)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tower(size: u32, resize: ResizeRule) -> ImageTower {
        ImageTower {
            input: String::new(),
            output: String::new(),
            crc32: String::new(),
            size,
            resize,
            filter: Filter::Bilinear,
            mean: [0.5, 0.0, 0.0],
            std: [0.5, 1.0, 1.0],
        }
    }

    #[test]
    fn a_square_of_the_right_size_is_only_scaled_in_value() {
        let image = RgbImage::from_fn(2, 2, |x, y| Rgb([255, (x * 100) as u8, (y * 50) as u8]));
        let mut planes = [0.0; 12];
        prepare(&image, &tower(2, ResizeRule::Shortest), &mut planes);
        assert_eq!(planes[..4], [1.0; 4]);
        assert_eq!(planes[4..8], [0.0, 100.0 / 255.0, 0.0, 100.0 / 255.0]);
        assert_eq!(planes[8..], [0.0, 0.0, 50.0 / 255.0, 50.0 / 255.0]);
    }

    #[test]
    fn shortest_keeps_the_centre_and_longest_the_whole() {
        // White in the middle third, black beside it.
        let image = RgbImage::from_fn(12, 4, |x, _| Rgb([if x / 4 == 1 { 255 } else { 0 }; 3]));
        let shortest = resized_square(&image, &tower(4, ResizeRule::Shortest));
        assert!(shortest.pixels().all(|p| p.0 == [255; 3]), "{shortest:?}");
        let longest = resized_square(&image, &tower(6, ResizeRule::Longest));
        assert_eq!(longest.get_pixel(0, 0), &PADDING);
        assert_eq!(longest.get_pixel(0, 3).0, [0; 3]);
        let squashed = resized_square(&image, &tower(6, ResizeRule::Squash));
        assert_eq!(squashed.get_pixel(0, 0).0, [0; 3]);
    }

    #[test]
    fn pictures_of_any_shape_become_squares() {
        for (width, height) in [(0, 0), (0, 5), (1, 1), (1, 5000), (5000, 1), (3, 300_000)] {
            for rule in [ResizeRule::Shortest, ResizeRule::Longest, ResizeRule::Squash] {
                let square = resized_square(&RgbImage::new(width, height), &tower(16, rule));
                assert_eq!(square.dimensions(), (16, 16), "{width} × {height}, {rule:?}");
            }
        }
    }
}
