//! Pressure towards few and small splats (Kheradmand et al. 2024, eq. 7).

use fearless_simd::{Level, Simd, dispatch};
use fearless_simd_macros::simd;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use trapeze_scene::Splats;

use crate::exponential::{exp, sigmoid};

/// Weights of λₒ·mean(opacity) + λₛ·mean(standard deviation) in the loss.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Regularisers {
    /// λₒ, over the opacities of all splats.
    pub opacity: f64,
    /// λₛ, over the three standard deviations of all splats, in world units.
    pub scale: f64,
}

impl Regularisers {
    /// Adds the gradient to `gradients`: λₒ·σ(1 − σ)/n by an opacity logit, λₛ·s/(3n) by a
    /// log-scale. With both weights zero nothing runs.
    ///
    /// A parameter that is NaN makes its gradient NaN, which the optimiser skips and counts.
    pub fn add_gradient(&self, level: Level, splats: &Splats, gradients: &mut Splats) {
        let n = splats.len() as f64;
        if self.opacity != 0.0 {
            let weight = (self.opacity / n) as f32;
            let gradients = gradients.opacity_logits.par_chunks_mut(CHUNK);
            gradients.zip(splats.opacity_logits.par_chunks(CHUNK)).for_each(
                |(g, x)| dispatch!(level, simd => add_opacity_gradient(simd, g, x, weight)),
            );
        }
        if self.scale != 0.0 {
            let weight = (self.scale / (3.0 * n)) as f32;
            let gradients = gradients.log_scales.as_flattened_mut().par_chunks_mut(CHUNK);
            gradients.zip(splats.log_scales.as_flattened().par_chunks(CHUNK)).for_each(
                |(g, x)| dispatch!(level, simd => add_scale_gradient(simd, g, x, weight)),
            );
        }
    }

    /// The value that is added to the loss, in double precision.
    #[must_use]
    pub fn value(&self, splats: &Splats) -> f64 {
        let n = splats.len().max(1) as f64;
        let opacities = splats.opacity_logits.iter();
        let opacity: f64 = opacities.map(|&x| trapeze_scene::sigmoid(f64::from(x))).sum();
        let scales = splats.log_scales.as_flattened().iter();
        let scale: f64 = scales.map(|&x| f64::from(x).exp()).sum();
        self.opacity * opacity / n + self.scale * scale / (3.0 * n)
    }
}

const CHUNK: usize = 8192;

#[simd]
fn add_opacity_gradient<S: Simd>(_: S, gradients: &mut [f32], logits: &[f32], weight: f32) {
    for (g, &x) in gradients.iter_mut().zip(logits) {
        // σ(x)·σ(−x) has no cancellation near σ = 1.
        *g += weight * (sigmoid(x) * sigmoid(-x));
    }
}

#[simd]
fn add_scale_gradient<S: Simd>(_: S, gradients: &mut [f32], log_scales: &[f32], weight: f32) {
    for (g, &x) in gradients.iter_mut().zip(log_scales) {
        *g += weight * exp(x);
    }
}

#[cfg(test)]
mod tests {
    use trapeze_scene::ShDegree;

    use super::*;
    use crate::parameters::tests::random_splats;
    use crate::parameters::zeros_like;

    #[test]
    fn the_gradient_is_the_derivative_of_the_value() {
        let regularisers = Regularisers { opacity: 0.01, scale: 0.02 };
        let splats = random_splats(1, 40, ShDegree::One);
        let mut gradients = zeros_like(&splats);
        regularisers.add_gradient(Level::new(), &splats, &mut gradients);
        // Differences of h = 2⁻⁷ (exact in f32) on functions whose third derivative is at most
        // their value: truncation h²/6 = 1e-5, relatively; the f32 gradient adds a few ulp.
        let h = 1.0 / 128.0;
        for i in 0..40 {
            let mut moved = splats.clone();
            moved.opacity_logits[i] += h;
            let above = regularisers.value(&moved);
            moved.opacity_logits[i] -= 2.0 * h;
            let difference = (above - regularisers.value(&moved)) / f64::from(2.0 * h);
            let g = f64::from(gradients.opacity_logits[i]);
            assert!((difference - g).abs() <= 2e-5 * 0.01 / 40.0 * 0.25, "{difference} {g}");
            for axis in 0..3 {
                let mut moved = splats.clone();
                moved.log_scales[i][axis] += h;
                let above = regularisers.value(&moved);
                moved.log_scales[i][axis] -= 2.0 * h;
                let difference = (above - regularisers.value(&moved)) / f64::from(2.0 * h);
                let g = f64::from(gradients.log_scales[i][axis]);
                assert!((difference - g).abs() <= 2e-5 * g.abs(), "{difference} {g}");
            }
        }
        assert_eq!(gradients.positions, zeros_like(&splats).positions);
    }

    #[test]
    fn extreme_parameters_have_finite_gradients() {
        let mut splats = random_splats(1, 4, ShDegree::Zero);
        splats.opacity_logits = vec![1e4, -1e4, f32::INFINITY, f32::NEG_INFINITY];
        splats.log_scales[0] = [40.0, -40.0, 1e9];
        let mut gradients = zeros_like(&splats);
        Regularisers { opacity: 0.01, scale: 0.01 }.add_gradient(
            Level::new(),
            &splats,
            &mut gradients,
        );
        assert!(gradients.opacity_logits.iter().all(|&g| g.abs() < 1e-30));
        assert!(gradients.log_scales.as_flattened().iter().all(|g| g.is_finite()));
    }
}
