//! From an image file to the image that a view's camera sees.

use std::io::{BufRead, BufReader, Cursor, Seek};
use std::path::Path;

use image::{DynamicImage, ImageError, ImageReader, Limits};
use trapeze_scene::MAX_IMAGE_SIDE;

use super::resample::{Intrinsics, reduce, undistort};
use super::{Distortion, Image, Lens, View};
use crate::error::InFile;
use crate::regular_file::{open_regular_file, read_regular_file};
use crate::{ParseError, ReadError};

/// Largest image file that is read.
const MAX_FILE_BYTES: u64 = 1 << 30;
/// Largest number of bytes that decoding one image may allocate.
const MAX_DECODED_BYTES: u64 = 1 << 30;

/// Decodes the image of a view: see the [module](super) for what is done to it.
///
/// The result depends on the files alone.
///
/// # Errors
/// [`ReadError`] names the image or the mask that cannot be used.
pub fn load_image(view: &View) -> Result<Image, ReadError> {
    let path = &view.image_path;
    let mut image = parse_image(&read_regular_file(path, MAX_FILE_BYTES)?).in_file(path)?;
    expect_size(view, &image).in_file(path)?;
    if let Some(mask_path) = &view.mask_path {
        let bytes = read_regular_file(mask_path, MAX_FILE_BYTES)?;
        let mask = parse_mask(&bytes).in_file(mask_path)?;
        image.weights = Some(mask.stretched_to(image.width, image.height));
    }
    if view.distortion != Distortion::None {
        image = undistort(&image, photograph_intrinsics(view), &Lens::new(view.distortion));
    }
    if view.reduction > 1 {
        image = reduce(&image, view.reduction);
    }
    Ok(image)
}

/// The view's intrinsics before the image is reduced.
fn photograph_intrinsics(view: &View) -> Intrinsics {
    let factor = f64::from(view.reduction);
    let camera = &view.camera;
    Intrinsics {
        fx: camera.fx * factor,
        fy: camera.fy * factor,
        cx: camera.cx * factor,
        cy: camera.cy * factor,
    }
}

/// The file must still be of the size that it had when the dataset was read.
fn expect_size(view: &View, image: &Image) -> Result<(), ParseError> {
    let reduced = [image.width / view.reduction, image.height / view.reduction];
    if reduced == [view.camera.width, view.camera.height] {
        return Ok(());
    }
    let expected = format!(
        "{} x {} pixels as when the dataset was read",
        view.camera.width * view.reduction,
        view.camera.height * view.reduction
    );
    let found = format!("{} x {}", image.width, image.height);
    Err(ParseError::value("image size", expected, found))
}

/// Width and height from the header of an image file.
pub(super) fn image_size(path: &Path) -> Result<[u32; 2], ReadError> {
    let (file, length) = open_regular_file(path).in_file(path)?;
    let read = || {
        // The JPEG decoder takes the whole file into memory even for its header.
        if length > MAX_FILE_BYTES {
            let expected = format!("at most {MAX_FILE_BYTES} bytes");
            return Err(ParseError::value("file length", expected, length));
        }
        let (width, height) =
            reader(BufReader::new(file))?.into_dimensions().map_err(unreadable)?;
        if width == 0 || height == 0 || width > MAX_IMAGE_SIDE || height > MAX_IMAGE_SIDE {
            let expected = format!("1 to {MAX_IMAGE_SIDE} pixels a side");
            return Err(ParseError::value("image size", expected, format!("{width} x {height}")));
        }
        Ok([width, height])
    };
    read().in_file(path)
}

fn reader<R: BufRead + Seek>(source: R) -> Result<ImageReader<R>, ParseError> {
    let mut reader = ImageReader::new(source).with_guessed_format()?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_IMAGE_SIDE);
    limits.max_image_height = Some(MAX_IMAGE_SIDE);
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    reader.limits(limits);
    Ok(reader)
}

fn unreadable(error: ImageError) -> ParseError {
    match error {
        ImageError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
            error.into()
        }
        error => ParseError::value("image", "a readable PNG, JPEG or WebP", error),
    }
}

/// Decodes a PNG, JPEG or WebP file of any bit depth to eight bits a channel.
///
/// # Errors
/// [`ParseError`] for what is damaged, truncated, or larger than 16 384 pixels a side.
pub(crate) fn parse_image(bytes: &[u8]) -> Result<Image, ParseError> {
    let decoded = decode(bytes)?;
    let (width, height) = (decoded.width(), decoded.height());
    let has_alpha = decoded.color().has_alpha();
    let (channels, values) = if has_alpha {
        let rgba = decoded.into_rgba8().into_raw();
        if rgba.chunks_exact(4).all(|pixel| pixel[3] == u8::MAX) {
            (3, rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect())
        } else {
            (4, rgba)
        }
    } else {
        (3, decoded.into_rgb8().into_raw())
    };
    Ok(Image { width, height, channels, values, weights: None })
}

/// A mask before it is fitted to its image.
struct Mask {
    width: u32,
    height: u32,
    weights: Vec<u8>,
}

fn parse_mask(bytes: &[u8]) -> Result<Mask, ParseError> {
    let grey = decode(bytes)?.into_luma8();
    Ok(Mask { width: grey.width(), height: grey.height(), weights: grey.into_raw() })
}

impl Mask {
    /// The nearest mask pixel for each pixel of an image: masks often come in the full size only.
    fn stretched_to(self, width: u32, height: u32) -> Vec<u8> {
        if (self.width, self.height) == (width, height) {
            return self.weights;
        }
        let nearest = |at: u32, from: u32, to: u32| {
            ((2 * u64::from(at) + 1) * u64::from(to) / (2 * u64::from(from))) as usize
        };
        let columns: Vec<usize> = (0..width).map(|x| nearest(x, width, self.width)).collect();
        (0..height)
            .map(|y| nearest(y, height, self.height) * self.width as usize)
            .flat_map(|row| columns.iter().map(move |column| row + column))
            .map(|pixel| self.weights[pixel])
            .collect()
    }
}

fn decode(bytes: &[u8]) -> Result<DynamicImage, ParseError> {
    expect_jpeg_end(bytes)?;
    let decoded = reader(Cursor::new(bytes))?.decode().map_err(unreadable)?;
    if decoded.width() == 0 || decoded.height() == 0 {
        return Err(ParseError::value("image size", "at least one pixel", "none"));
    }
    Ok(decoded)
}

/// Refuses a JPEG that ends before its end marker: the decoder would fill the rest with grey,
/// and training would learn it.
fn expect_jpeg_end(bytes: &[u8]) -> Result<(), ParseError> {
    if !bytes.starts_with(&[0xff, 0xd8]) {
        return Ok(());
    }
    let last = |marker: u8| bytes.windows(2).rposition(|pair| pair == [0xff, marker]);
    // The end marker of an embedded thumbnail comes before the scan of the image itself.
    let (scan, end) = (last(0xda), last(0xd9));
    if scan.is_some() && end > scan {
        return Ok(());
    }
    Err(ParseError::value("image", "a JPEG with an end marker", "none (file truncated?)"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayImage, ImageBuffer, ImageFormat, Luma, Rgb, RgbImage, Rgba, RgbaImage};

    fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.into().write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn sixteen_bit_values_are_rounded_to_eight() {
        // 257·v is the exact 16-bit form of v; 128 more rounds up only where it reaches a half.
        let values = [0u16, 128, 129, 257 * 100 + 127, 257 * 100 + 129, u16::MAX];
        let source = ImageBuffer::<Rgb<u16>, _>::from_raw(2, 1, values.to_vec()).unwrap();
        let image = parse_image(&encoded(source, ImageFormat::Png)).unwrap();
        assert_eq!(image.values, [0, 0, 1, 100, 101, 255]);
    }

    #[test]
    fn grey_becomes_rgb_and_an_opaque_alpha_channel_is_dropped() {
        let grey = GrayImage::from_pixel(2, 1, Luma([77]));
        let image = parse_image(&encoded(grey, ImageFormat::Png)).unwrap();
        assert_eq!((image.channels, image.values), (3, vec![77; 6]));

        let mut rgba = RgbaImage::from_pixel(2, 1, Rgba([1, 2, 3, 255]));
        let image = parse_image(&encoded(rgba.clone(), ImageFormat::Png)).unwrap();
        assert_eq!((image.channels, image.values), (3, vec![1, 2, 3, 1, 2, 3]));
        rgba.put_pixel(1, 0, Rgba([4, 5, 6, 0]));
        let image = parse_image(&encoded(rgba, ImageFormat::Png)).unwrap();
        assert_eq!((image.channels, image.values), (4, vec![1, 2, 3, 255, 4, 5, 6, 0]));
    }

    #[test]
    fn a_jpeg_cut_anywhere_is_refused() {
        let noise = RgbImage::from_fn(40, 30, |x, y| Rgb([(x * 7 + y * 13) as u8, x as u8, 9]));
        let bytes = encoded(noise, ImageFormat::Jpeg);
        assert!(parse_image(&bytes).is_ok());
        for length in 0..bytes.len() - 1 {
            assert!(parse_image(&bytes[..length]).is_err(), "{length} of {}", bytes.len());
        }
    }

    #[test]
    fn a_mask_of_another_size_is_read_at_the_nearest_pixel() {
        let mask = || Mask { width: 2, height: 1, weights: vec![0, 255] };
        assert_eq!(mask().stretched_to(4, 2), [0, 0, 255, 255, 0, 0, 255, 255]);
        assert_eq!(mask().stretched_to(1, 1), [255]);
        assert_eq!(mask().stretched_to(2, 1), [0, 255]);
    }
}
