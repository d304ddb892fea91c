//! What the image would lose without a splat, and which splats are worth keeping.
//!
//! A pixel's colour is linear in the α of each splat in it: without that splat it changes by
//! δ = −α ∂C/∂α. Since α = o·G with the splat's opacity o, the change of all pixels is −o ∂C/∂o.
//! Where training has settled the loss has no slope left, and what the squared error gains without
//! the splat is Σ ‖δ‖² over the pixels.
//!
//! That sum is the mean of (v·δ)² over images v of random signs (Hutchinson 1989), and −v·δ is o times
//! the gradient by o of the image under v. One backward pass gives it for every splat, on any backend,
//! and what is in front of a splat and behind it is accounted for.

use rayon::prelude::*;
use trapeze_scene::sigmoid;

use crate::TrainingState;
use crate::random::{Purpose, Stream};

/// The largest part of a set that leaves at once: costs are those of removing one splat alone.
const MOST_AT_ONCE: f64 = 0.75;
/// Less than this part is not worth a change.
const LEAST_AT_ONCE: f64 = 0.05;

/// Gradient by (r, g, b premultiplied, alpha) of an image of random signs over `background`: the
/// `probe`-th of those drawn after `step` steps. `mask` has a weight for each pixel, if not all count.
#[must_use]
pub fn random_signs(
    (seed, step, probe): (u64, u32, u32),
    pixels: usize,
    background: [f32; 3],
    mask: Option<&[u8]>,
) -> Vec<[f32; 4]> {
    let stream = Stream::new(seed, Purpose::RemovalProbe, step);
    let mut signs = vec![[0.0; 4]; pixels];
    // A word per channel has the signs of as many pixels as it has bits.
    signs.par_chunks_mut(32).enumerate().for_each(|(block, pixels)| {
        let [r, g, b, _] = stream.more_words(block as u32, probe);
        for (bit, pixel) in pixels.iter_mut().enumerate() {
            let weight = mask.map_or(1.0, |mask| f32::from(mask[32 * block + bit]) / 255.0);
            let [r, g, b] = [r, g, b].map(|w| if w >> bit & 1 == 1 { weight } else { -weight });
            let [under_r, under_g, under_b] = background;
            *pixel = [r, g, b, -(r * under_r + g * under_g + b * under_b)];
        }
    });
    signs
}

/// What the probed images would lose without each splat.
#[derive(Clone, Debug, PartialEq)]
pub struct RemovalCosts {
    /// Squared change of the images, by splat.
    by_splat: Vec<f64>,
    /// Colour values that were probed.
    values: f64,
}

impl RemovalCosts {
    /// Before the first probe of `splats` splats.
    #[must_use]
    pub fn new(splats: usize) -> Self {
        Self { by_splat: vec![0.0; splats], values: 0.0 }
    }

    /// Adds one probe: its image of signs, and the gradient by opacity logits under it, whose
    /// ∂o/∂logit is o·(1 − o).
    pub fn add(&mut self, signs: &[[f32; 4]], opacity_logits: &[f32], by_logits: &[f32]) {
        let weight = |[r, g, b, _]: &[f32; 4]| f64::from(r * r + g * g + b * b);
        self.values += signs.iter().map(weight).sum::<f64>();
        let splats = self.by_splat.iter_mut().zip(opacity_logits).zip(by_logits);
        for ((cost, &logit), &by_logit) in splats {
            if by_logit != 0.0 {
                *cost += (f64::from(by_logit) / sigmoid(-f64::from(logit))).powi(2);
            }
        }
    }

    /// The splats that are worth `price` dB per doubling of their number, ascending, when the image
    /// has a PSNR of `psnr` dB: those for which the loss of quality and the price of their number are
    /// least together. `None` when that is nearly all of them. A cost that is not a number is none;
    /// of equal ones the first stay.
    #[must_use]
    pub fn worth_keeping(&self, psnr: f64, price: f64) -> Option<Vec<u32>> {
        let n = self.by_splat.len();
        let cost = |i: u32| Some(self.by_splat[i as usize]).filter(|c| !c.is_nan()).unwrap_or(0.0);
        let mut order: Vec<u32> = (0..n as u32).collect();
        order.sort_by(|&a, &b| cost(a).total_cmp(&cost(b)).then(b.cmp(&a)));
        let error = self.values * 10f64.powf(-psnr / 10.0);
        let (mut removed, mut cheapest, mut least) = (0.0, 0, 0.0);
        let most = (n as f64 * MOST_AT_ONCE) as usize;
        for (k, &i) in order[..most].iter().enumerate() {
            removed += cost(i);
            let loss = 10.0 * (1.0 + removed / error).log10();
            let saved = price * (n as f64 / (n - k - 1) as f64).log2();
            if loss - saved < least {
                (cheapest, least) = (k + 1, loss - saved);
            }
        }
        if cheapest == 0 || (cheapest as f64) < LEAST_AT_ONCE * n as f64 {
            return None;
        }
        let mut kept = order.split_off(cheapest);
        kept.sort_unstable();
        Some(kept)
    }
}

/// Leaves only the splats `kept`, with their moments. All of them move again.
pub fn thin(state: &mut TrainingState, kept: &[u32]) {
    state.resting = None;
    for part in [&mut state.splats, &mut state.first_moments, &mut state.second_moments] {
        *part = part.gather(kept);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Costs after one probe of 100 pixels, so that an error of 1 is a PSNR of 10·log10(300) dB.
    fn costs(by_splat: &[f64]) -> RemovalCosts {
        RemovalCosts { by_splat: by_splat.to_vec(), values: 300.0 }
    }

    const PSNR_OF_ONE: f64 = 24.771_212_547_196_626;

    #[test]
    fn what_costs_nothing_leaves_and_what_is_dear_stays() {
        let kept = costs(&[1.0, 0.0, 2.0, f64::NAN, 3.0, 0.0]).worth_keeping(PSNR_OF_ONE, 0.1);
        assert_eq!(kept, Some(vec![0, 2, 4]));
        assert_eq!(costs(&[1.0; 6]).worth_keeping(PSNR_OF_ONE, 0.1), None);
        assert_eq!(costs(&[]).worth_keeping(PSNR_OF_ONE, 0.1), None);
        // Of equal ones the first, and never more than three quarters.
        assert_eq!(costs(&[0.0; 8]).worth_keeping(PSNR_OF_ONE, 0.1), Some(vec![0, 1]));
        assert_eq!(costs(&[0.0; 8]).worth_keeping(f64::INFINITY, 0.0), None);
    }

    #[test]
    fn splats_leave_up_to_where_the_next_costs_more_than_it_saves() {
        let n = 1000;
        let rising: Vec<f64> = (0..n).map(|i| 1e-6 * f64::from(i)).collect();
        let price = 0.2;
        let kept = costs(&rising).worth_keeping(PSNR_OF_ONE, price).unwrap();
        let left = n as usize - kept.len();
        // Removing k costs 10·log10(1 + 5e-7·k²), whose slope meets that of price·log2(n/(n − k)).
        let slope = |k: f64| 10.0 / 10f64.ln() * 1e-6 * k / (1.0 + 5e-7 * k * k);
        let saved = |k: f64| price / 2f64.ln() / (f64::from(n) - k);
        let expected = (1..n).map(f64::from).find(|&k| slope(k) > saved(k)).unwrap();
        assert!((left as f64 - expected).abs() <= 2.0, "{left} {expected}");
        assert_eq!(kept[0] as usize, left);
        let more = costs(&rising).worth_keeping(PSNR_OF_ONE, 2.0 * price).unwrap();
        assert!(more.len() < kept.len());
    }

    #[test]
    fn signs_are_even_and_masked_pixels_have_none() {
        let mut mask = vec![255; 70];
        mask[40] = 0;
        let signs = random_signs((1, 2, 3), 70, [0.25, 0.5, 1.0], Some(&mask));
        assert_eq!(signs[40], [0.0; 4]);
        for (i, [r, g, b, alpha]) in signs.iter().enumerate() {
            assert!(i == 40 || [r, g, b].iter().all(|sign| sign.abs() == 1.0));
            assert_eq!(*alpha, -(0.25 * r + 0.5 * g + b));
        }
        assert_eq!(signs, random_signs((1, 2, 3), 70, [0.25, 0.5, 1.0], Some(&mask)));
        assert_ne!(signs, random_signs((1, 2, 4), 70, [0.25, 0.5, 1.0], Some(&mask)));
        let sum: f32 = random_signs((1, 2, 3), 30_000, [0.0; 3], None).iter().map(|s| s[1]).sum();
        // Five standard deviations of a sum of as many signs.
        assert!(sum.abs() < 5.0 * 30_000f32.sqrt());
    }
}
