//! The loss of a view and its gradient, in parallel over bands of rows.

use std::sync::Mutex;

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::band::{BAND_ROWS, BandBuffers, BandInput, BandSums};
use super::kernels::GradientScale;
use super::target::{TargetError, TargetImage, expect_length};
use super::window;

/// The loss of one view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LossValue {
    /// Mean of |render − target| over pixels and channels.
    pub l1: f64,
    /// Mean structural similarity over pixels and channels.
    pub ssim: f64,
    /// (1 − λ)·L1 + λ·(1 − SSIM).
    pub total: f64,
}

/// Evaluates the loss of views of any size. Keeps its working memory, one band per thread.
pub struct ImageLoss {
    level: Level,
    weights: [f32; window::TAPS],
    /// Buffers that no thread is using. Which thread gets which does not matter: a band reads
    /// nothing that it has not written.
    idle: Mutex<Vec<BandBuffers>>,
}

impl Default for ImageLoss {
    fn default() -> Self {
        Self::with_level(Level::new())
    }
}

impl ImageLoss {
    /// With the instructions of `level`, to compare them; [`ImageLoss::default`] takes the best.
    #[must_use]
    pub fn with_level(level: Level) -> Self {
        Self { level, weights: window::weights().map(|w| w as f32), idle: Mutex::default() }
    }

    /// Loss of `render` (premultiplied r g b, alpha, row by row) against `target`, both over
    /// `background`, with λ = `ssim_weight`, and its gradient by every component of the render.
    ///
    /// [`reference_loss`](super::reference::reference_loss) says what is computed. The result does
    /// not depend on the number of threads: bands are fixed rows, and their sums are added in order.
    ///
    /// # Errors
    /// [`TargetError::Length`] when the render or the gradient has another number of pixels than
    /// the target.
    pub fn evaluate(
        &self,
        render: &[[f32; 4]],
        target: &TargetImage,
        background: [f32; 3],
        ssim_weight: f32,
        gradient: &mut [[f32; 4]],
    ) -> Result<LossValue, TargetError> {
        expect_length("rendered pixels", target.len(), render.len())?;
        expect_length("gradient pixels", target.len(), gradient.len())?;
        let values = (3 * target.len()) as f64;
        let lambda = f64::from(ssim_weight);
        let scale =
            GradientScale { l1: ((1.0 - lambda) / values) as f32, ssim: (lambda / values) as f32 };
        let input = BandInput { render, target, background, scale, weights: &self.weights };
        let bands: Vec<BandSums> = gradient
            .par_chunks_mut(BAND_ROWS * target.width())
            .enumerate()
            .map(|(index, out)| self.process_band(&input, index, out))
            .collect();
        let difference: f64 = bands.iter().map(|band| band.difference).sum();
        let dissimilarity: f64 = bands.iter().map(|band| band.dissimilarity).sum();
        let (l1, dissimilarity) = (difference / values, dissimilarity / values);
        Ok(LossValue {
            l1,
            ssim: 1.0 - dissimilarity,
            total: (1.0 - lambda) * l1 + lambda * dissimilarity,
        })
    }

    fn process_band(&self, input: &BandInput<'_>, index: usize, out: &mut [[f32; 4]]) -> BandSums {
        let first = index * BAND_ROWS;
        let rows = first..(first + BAND_ROWS).min(input.target.height());
        let mut buffers = self.lock_idle().pop().unwrap_or_default();
        let sums = dispatch!(self.level, simd => buffers.process(simd, input, rows.clone(), out));
        self.lock_idle().push(buffers);
        sums
    }

    fn lock_idle(&self) -> std::sync::MutexGuard<'_, Vec<BandBuffers>> {
        // Buffers carry nothing from one use to the next, so a panic elsewhere spoils none.
        self.idle.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}
