//! How far one image is from another.

/// Error of an image against a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageError {
    /// Peak signal-to-noise ratio of r g b clamped to 0–1, dB; infinite for equal images.
    pub psnr: f64,
    /// Largest absolute difference of any channel, alpha included, not clamped.
    pub max: f64,
    /// 99.9th percentile of the absolute differences of all channels.
    pub p999: f64,
}

impl ImageError {
    /// Error of `image` against `reference`, both r g b a per pixel.
    ///
    /// # Panics
    /// When the images differ in size.
    #[must_use]
    pub fn between(image: &[[f32; 4]], reference: &[[f32; 4]]) -> Self {
        assert_eq!(image.len(), reference.len(), "images of one size");
        let mut differences: Vec<f32> = image
            .as_flattened()
            .iter()
            .zip(reference.as_flattened())
            // A NaN on either side must not pass as no difference.
            .map(
                |(a, b)| if a.is_finite() && b.is_finite() { (a - b).abs() } else { f32::INFINITY },
            )
            .collect();
        let Some(last) = differences.len().checked_sub(1) else {
            return Self { psnr: f64::INFINITY, max: 0.0, p999: 0.0 };
        };
        let rank = last - last / 1000;
        let (_, &mut p999, above) = differences.select_nth_unstable_by(rank, f32::total_cmp);
        let max = above.iter().copied().fold(p999, f32::max);
        Self { psnr: psnr(image, reference), max: f64::from(max), p999: f64::from(p999) }
    }

    /// The worse of two, number by number.
    #[must_use]
    pub fn worst(self, other: Self) -> Self {
        Self {
            psnr: self.psnr.min(other.psnr),
            max: self.max.max(other.max),
            p999: self.p999.max(other.p999),
        }
    }
}

/// Peak signal-to-noise ratio of r g b clamped to 0–1, dB: −10 log₁₀ of the mean squared
/// difference. Infinite for equal images, −∞ where a channel is not a number.
///
/// # Panics
/// When the images differ in size.
#[must_use]
pub fn psnr(image: &[[f32; 4]], reference: &[[f32; 4]]) -> f64 {
    assert_eq!(image.len(), reference.len(), "images of one size");
    let mut sum = 0.0;
    for (a, b) in image.iter().zip(reference) {
        for channel in 0..3 {
            let (a, b) = (a[channel], b[channel]);
            if a.is_nan() || b.is_nan() {
                return f64::NEG_INFINITY;
            }
            let difference = f64::from(a.clamp(0.0, 1.0)) - f64::from(b.clamp(0.0, 1.0));
            sum += difference * difference;
        }
    }
    if sum == 0.0 { f64::INFINITY } else { -10.0 * (sum / (3 * image.len()) as f64).log10() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_images_have_no_error() {
        let image = vec![[0.1, 0.2, 0.3, 1.0]; 50];
        let error = ImageError::between(&image, &image);
        assert_eq!(error, ImageError { psnr: f64::INFINITY, max: 0.0, p999: 0.0 });
    }

    #[test]
    fn a_uniform_difference_gives_its_own_psnr() {
        let a = vec![[0.5, 0.5, 0.5, 1.0]; 10];
        let b = vec![[0.6, 0.6, 0.6, 1.0]; 10];
        assert!((psnr(&a, &b) - 20.0).abs() < 1e-5, "{}", psnr(&a, &b));
    }

    #[test]
    fn one_pixel_in_ten_thousand_shows_in_the_maximum_only() {
        let a = vec![[0.5; 4]; 10_000];
        let mut b = a.clone();
        b[17][2] = 0.9;
        let error = ImageError::between(&a, &b);
        assert!((error.max - 0.4).abs() < 1e-6 && error.p999 == 0.0, "{error:?}");
    }

    #[test]
    fn nan_is_the_worst_error_there_is() {
        let good = vec![[0.5; 4]; 4];
        let mut bad = good.clone();
        bad[0][1] = f32::NAN;
        assert_eq!(psnr(&bad, &good), f64::NEG_INFINITY);
        assert_eq!(ImageError::between(&bad, &good).max, f64::INFINITY);
    }

    #[test]
    fn brightness_beyond_the_display_counts_in_max_but_not_in_psnr() {
        let a = vec![[3.0, 1.0, 1.0, 1.0]];
        let b = vec![[1.0, 1.0, 1.0, 1.0]];
        assert_eq!(psnr(&a, &b), f64::INFINITY);
        assert_eq!(ImageError::between(&a, &b).max, 2.0);
    }
}
