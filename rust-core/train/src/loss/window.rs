//! The Gaussian window of SSIM: 11 × 11, σ = 1.5, separable.

/// Taps on each side of the centre.
pub(super) const RADIUS: usize = 5;
/// Width of the window.
pub(super) const TAPS: usize = 2 * RADIUS + 1;
/// Standard deviation in pixels (Wang et al. 2004).
const SIGMA: f64 = 1.5;

/// The window's one-dimensional factor, normalised to sum 1.
pub(super) fn weights() -> [f64; TAPS] {
    let bell: [f64; TAPS] = std::array::from_fn(|i| {
        let d = i as f64 - RADIUS as f64;
        (-d * d / (2.0 * SIGMA * SIGMA)).exp()
    });
    let sum: f64 = bell.iter().sum();
    bell.map(|w| w / sum)
}

/// A plane of `width` × `height` values convolved with the window, in f64; what lies outside the
/// plane counts as zero. The operator is symmetric, so it is its own transpose: the gradient of
/// anything that depends on a blurred plane is the blurred gradient.
pub(super) fn blur(plane: &[f64], width: usize, height: usize) -> Vec<f64> {
    let mut down = vec![0.0; plane.len()];
    for (y, out) in down.chunks_exact_mut(width).enumerate() {
        for (tap, weight) in weights().into_iter().enumerate() {
            if let Some(row) = (y + tap).checked_sub(RADIUS).filter(|&row| row < height) {
                add_scaled(out, &plane[row * width..(row + 1) * width], weight);
            }
        }
    }
    let mut both = vec![0.0; plane.len()];
    for (out, row) in both.chunks_exact_mut(width).zip(down.chunks_exact(width)) {
        for (tap, weight) in weights().into_iter().enumerate() {
            // Output column x takes row[x + tap − RADIUS].
            let (left, right) = (RADIUS.saturating_sub(tap), tap.saturating_sub(RADIUS));
            if left < width && right < width {
                add_scaled(&mut out[left..width - right], &row[right..width - left], weight);
            }
        }
    }
    both
}

fn add_scaled(out: &mut [f64], values: &[f64], weight: f64) {
    for (out, value) in out.iter_mut().zip(values) {
        *out += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_passes_equal_the_two_dimensional_window() {
        for (width, height) in [(13, 7), (1, 1), (3, 20), (20, 2)] {
            check(width, height);
        }
    }

    fn check(width: usize, height: usize) {
        let plane: Vec<f64> = (0..width * height).map(|i| ((i * 37) % 101) as f64).collect();
        let (found, w) = (blur(&plane, width, height), weights());
        for y in 0..height {
            for x in 0..width {
                let mut expected = 0.0;
                for (j, wj) in w.iter().enumerate() {
                    for (i, wi) in w.iter().enumerate() {
                        let (yy, xx) = ((y + j).wrapping_sub(RADIUS), (x + i).wrapping_sub(RADIUS));
                        if yy < height && xx < width {
                            expected += wj * wi * plane[yy * width + xx];
                        }
                    }
                }
                // 121 products of values up to 100, summed in another order.
                assert!((found[y * width + x] - expected).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn the_window_is_symmetric_and_sums_to_one() {
        let w = weights();
        assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert!((0..TAPS).all(|i| w[i] == w[TAPS - 1 - i]));
    }
}
