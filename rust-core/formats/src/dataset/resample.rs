//! Resampling of images: lens distortion removed, sizes reduced.
//!
//! Both are weighted means of source pixels. A colour counts by its weight, its loss weight and
//! its alpha, so that neither what a mask hides nor what is transparent bleeds into what is seen.

use glam::dvec2;

use super::{Image, Lens};

/// The pinhole intrinsics of a photograph, in its own pixels: fx, fy, cx, cy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Intrinsics {
    pub(super) fx: f64,
    pub(super) fy: f64,
    pub(super) cx: f64,
    pub(super) cy: f64,
}

/// The photograph that a pinhole with the same intrinsics and size would have taken.
///
/// Each pixel of the result is a ray; the lens says where that ray met the source, which is read
/// there bilinearly. Rays that leave the photograph or the lens's field of view get weight 0.
pub(super) fn undistort(source: &Image, camera: Intrinsics, lens: &Lens) -> Image {
    let (width, height) = (f64::from(source.width), f64::from(source.height));
    let mut result = ResampledImage::like(source, source.width, source.height);
    for y in 0..source.height {
        for x in 0..source.width {
            let ray = dvec2(
                (f64::from(x) + 0.5 - camera.cx) / camera.fx,
                (f64::from(y) + 0.5 - camera.cy) / camera.fy,
            );
            let mut mean = WeightedPixel::default();
            if let Some(distorted) = lens.distort(ray) {
                let u = camera.fx * distorted.x + camera.cx;
                let v = camera.fy * distorted.y + camera.cy;
                if (0.0..=width).contains(&u) && (0.0..=height).contains(&v) {
                    mean.add_bilinear(source, u, v);
                }
            }
            result.push(&mean);
        }
    }
    result.finish()
}

/// The image with blocks of `factor` × `factor` pixels averaged into one; rows and columns that
/// fill no block are dropped.
pub(super) fn reduce(source: &Image, factor: u32) -> Image {
    let (width, height) = (source.width / factor, source.height / factor);
    let mut result = ResampledImage::like(source, width, height);
    let share = 1.0 / (factor * factor) as f32;
    for y in 0..height {
        for x in 0..width {
            let mut mean = WeightedPixel::default();
            for row in y * factor..(y + 1) * factor {
                for column in x * factor..(x + 1) * factor {
                    mean.add(source, column, row, share);
                }
            }
            result.push(&mean);
        }
    }
    result.finish()
}

/// A mean of pixels whose weights sum to at most one.
#[derive(Default)]
struct WeightedPixel {
    /// Colour × alpha × loss weight × weight.
    color: [f32; 3],
    /// Alpha × loss weight × weight.
    alpha: f32,
    /// Loss weight × weight.
    coverage: f32,
}

impl WeightedPixel {
    fn add(&mut self, source: &Image, x: u32, y: u32, weight: f32) {
        let pixel = y as usize * source.width as usize + x as usize;
        let channels = usize::from(source.channels);
        let values = &source.values[pixel * channels..][..channels];
        let coverage = weight * source.weight(pixel);
        let alpha = coverage * values.get(3).map_or(1.0, |&a| f32::from(a) / 255.0);
        for (sum, &value) in self.color.iter_mut().zip(values) {
            *sum += alpha * f32::from(value);
        }
        self.alpha += alpha;
        self.coverage += coverage;
    }

    /// The four pixels whose centres surround (u, v), in pixels from the top left corner of the
    /// image; past the outermost centres the border pixels continue.
    fn add_bilinear(&mut self, source: &Image, u: f64, v: f64) {
        let clamped = |position: f64, size: u32| {
            let position = (position - 0.5).clamp(0.0, f64::from(size - 1));
            let first = position as u32;
            (first, (first + 1).min(size - 1), (position - f64::from(first)) as f32)
        };
        let (left, right, along_x) = clamped(u, source.width);
        let (top, bottom, along_y) = clamped(v, source.height);
        self.add(source, left, top, (1.0 - along_x) * (1.0 - along_y));
        self.add(source, right, top, along_x * (1.0 - along_y));
        self.add(source, left, bottom, (1.0 - along_x) * along_y);
        self.add(source, right, bottom, along_x * along_y);
    }
}

/// An image that is written pixel after pixel.
struct ResampledImage {
    image: Image,
    weights: Vec<u8>,
}

impl ResampledImage {
    fn like(source: &Image, width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        let values = Vec::with_capacity(pixels * usize::from(source.channels));
        Self {
            image: Image { width, height, channels: source.channels, values, weights: None },
            weights: Vec::with_capacity(pixels),
        }
    }

    fn push(&mut self, mean: &WeightedPixel) {
        let byte = |value: f32| (value + 0.5) as u8;
        let per_alpha = if mean.alpha > 0.0 { 1.0 / mean.alpha } else { 0.0 };
        self.image.values.extend(mean.color.map(|sum| byte(sum * per_alpha)));
        if self.image.has_alpha() {
            let per_coverage = if mean.coverage > 0.0 { 255.0 / mean.coverage } else { 0.0 };
            self.image.values.push(byte(mean.alpha * per_coverage));
        }
        self.weights.push(byte(mean.coverage * 255.0));
    }

    fn finish(self) -> Image {
        let weights = self.weights.iter().any(|&w| w != u8::MAX).then_some(self.weights);
        Image { weights, ..self.image }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Distortion;
    use super::*;

    fn gradient(width: u32, height: u32) -> Image {
        let values = (0..height)
            .flat_map(|y| (0..width).flat_map(move |x| [(x * 3) as u8, (y * 5) as u8, 7]))
            .collect();
        Image { width, height, channels: 3, values, weights: None }
    }

    const CAMERA: Intrinsics = Intrinsics { fx: 60.0, fy: 50.0, cx: 31.0, cy: 25.0 };

    #[test]
    fn without_distortion_undistort_changes_nothing() {
        let image = gradient(64, 48);
        assert_eq!(undistort(&image, CAMERA, &Lens::new(Distortion::None)), image);
    }

    #[test]
    fn a_linear_gradient_is_read_where_the_lens_put_each_ray() {
        let image = gradient(64, 48);
        let lens = Lens::new(Distortion::perspective([-0.1, 0.02, 0.0], [0.001, -0.002]));
        let straight = undistort(&image, CAMERA, &lens);
        for (x, y) in [(10u32, 10u32), (40, 30), (31, 24)] {
            let ray = dvec2(
                (f64::from(x) + 0.5 - CAMERA.cx) / CAMERA.fx,
                (f64::from(y) + 0.5 - CAMERA.cy) / CAMERA.fy,
            );
            let at = lens.distort(ray).unwrap();
            // Red is 3·x at the pixel centre x + 0.5, so bilinear sampling is exact on it.
            let red = 3.0 * (CAMERA.fx * at.x + CAMERA.cx - 0.5);
            let green = 5.0 * (CAMERA.fy * at.y + CAMERA.cy - 0.5);
            let found = &straight.values[(y * 64 + x) as usize * 3..][..3];
            assert!((f64::from(found[0]) - red).abs() <= 0.501, "{found:?} {red}");
            assert!((f64::from(found[1]) - green).abs() <= 0.501, "{found:?} {green}");
        }
    }

    #[test]
    fn rays_that_leave_the_photograph_weigh_nothing() {
        // A pincushion lens (k₁ > 0) pushes the corners of the ideal image out of the source.
        let lens = Lens::new(Distortion::perspective([0.3, 0.0, 0.0], [0.0; 2]));
        let straight = undistort(&gradient(64, 48), CAMERA, &lens);
        let weights = straight.weights.unwrap();
        assert_eq!((weights[0], weights[24 * 64 + 31]), (0, 255));
        assert_eq!(straight.values[..3], [0, 0, 0]);
    }

    #[test]
    fn reducing_averages_blocks_and_drops_what_fills_none() {
        let image = Image {
            width: 3,
            height: 2,
            channels: 3,
            values: vec![10, 0, 0, 20, 0, 0, 99, 99, 99, 30, 4, 0, 40, 4, 0, 99, 99, 99],
            weights: None,
        };
        let small = reduce(&image, 2);
        assert_eq!((small.width, small.height, small.weights.is_none()), (1, 1, true));
        assert_eq!(small.values, [25, 2, 0]);
    }

    #[test]
    fn transparent_and_masked_pixels_do_not_bleed_into_a_mean() {
        let image = Image {
            width: 2,
            height: 2,
            channels: 4,
            // Red seen; green transparent; blue masked; red seen at half alpha.
            values: vec![200, 0, 0, 255, 0, 200, 0, 0, 0, 0, 200, 255, 200, 0, 0, 128],
            weights: Some(vec![255, 255, 0, 255]),
        };
        let small = reduce(&image, 2);
        // Alpha: (255 + 0 + 128)/3 over the three that count; weight 3/4.
        assert_eq!(small.values, [200, 0, 0, 128]);
        assert_eq!(small.weights.unwrap(), [191]);
    }
}
