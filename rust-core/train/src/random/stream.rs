//! Named streams of random numbers.

use super::{normal, philox4x32};

/// What random numbers are drawn for. Each purpose has a stream of its own, so that drawing more
/// for one never shifts another.
///
/// The numbers are part of the checkpoint format: a resumed run must find the same streams.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Purpose {
    /// Order of the views; the step is the epoch, the index is the view.
    ViewOrder = 1,
    /// Background colour; the index is 0.
    Background = 2,
    /// Exploration noise of positions; the index is the splat.
    PositionNoise = 3,
    /// Which splat a dead one moves to; the index is the dead splat.
    Relocation = 4,
    /// Which splats are duplicated; the index is the new splat.
    Growth = 5,
    /// Random initial splats; the step is 0, the index is the splat.
    Initialisation = 6,
    /// Noise of the time that the deformation network sees; the index is 0.
    TimeNoise = 7,
    /// First weights of the deformation network; the step is the layer, the index a quarter of the
    /// place of the weight.
    NetworkInitialisation = 8,
    /// Signs that tell what splats are worth; the index is 32 pixels, the part is the probe.
    RemovalProbe = 9,
}

/// Random words addressed by (seed, purpose, step, index): what is drawn depends on the address
/// alone, never on what was drawn before, on threads, or on the processor.
///
/// The Philox key is the seed; the counter is (index, part, step, purpose).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    key: [u32; 2],
    purpose: Purpose,
    step: u32,
}

impl Stream {
    /// The stream of one purpose at one step.
    #[must_use]
    pub fn new(seed: u64, purpose: Purpose, step: u32) -> Self {
        Self { key: [seed as u32, (seed >> 32) as u32], purpose, step }
    }

    /// The Philox key: low and high half of the seed. With [`Self::step`] and the purpose it is all
    /// that a kernel needs to draw the same words.
    #[must_use]
    pub fn key(&self) -> [u32; 2] {
        self.key
    }

    /// The step of the stream.
    #[must_use]
    pub fn step(&self) -> u32 {
        self.step
    }

    /// Four independent words for `index`.
    #[inline]
    #[must_use]
    pub fn words(&self, index: u32) -> [u32; 4] {
        self.more_words(index, 0)
    }

    /// Further words for `index`, four per `part`; part 0 is [`Self::words`].
    #[inline]
    #[must_use]
    pub fn more_words(&self, index: u32, part: u32) -> [u32; 4] {
        philox4x32([index, part, self.step, self.purpose as u32], self.key)
    }

    /// Four numbers uniform in [0, 1), multiples of 2⁻²⁴.
    #[inline]
    #[must_use]
    pub fn uniforms(&self, index: u32) -> [f32; 4] {
        self.words(index).map(uniform)
    }

    /// Four standard normal numbers.
    #[inline]
    #[must_use]
    pub fn normals(&self, index: u32) -> [f32; 4] {
        self.words(index).map(normal)
    }
}

/// A number uniform in [0, 1) from the upper 24 bits, every value exact.
#[inline]
#[must_use]
pub fn uniform(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A number uniform in 0..bound: the high word of the product (Lemire 2019, without rejection). No
/// value is more likely than another by more than bound·2⁻³², relatively.
#[inline]
#[must_use]
pub fn below(word: u32, bound: u32) -> u32 {
    ((u64::from(word) * u64::from(bound)) >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_the_address_changes_the_words() {
        let base = Stream::new(7, Purpose::PositionNoise, 3);
        let words = base.words(5);
        assert_eq!(words, Stream::new(7, Purpose::PositionNoise, 3).words(5));
        let others = [
            base.words(6),
            base.more_words(5, 1),
            Stream::new(7, Purpose::PositionNoise, 4).words(5),
            Stream::new(7, Purpose::Relocation, 3).words(5),
            Stream::new(8, Purpose::PositionNoise, 3).words(5),
            Stream::new(7 + (1 << 32), Purpose::PositionNoise, 3).words(5),
        ];
        assert!(others.iter().all(|other| *other != words));
    }

    #[test]
    fn uniforms_are_flat_and_below_one() {
        let stream = Stream::new(1, Purpose::Growth, 0);
        let mut counts = [0u32; 16];
        let draws = 40_000;
        for index in 0..draws / 4 {
            for u in stream.uniforms(index) {
                assert!((0.0..1.0).contains(&u));
                counts[(u * 16.0) as usize] += 1;
            }
        }
        // χ² with 15 degrees of freedom: above 50 with probability 1e-5, for one fixed seed.
        let expected = f64::from(draws) / 16.0;
        let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - expected).powi(2) / expected).sum();
        assert!(chi2 < 50.0, "{chi2}");
        assert_eq!(uniform(u32::MAX), 1.0 - 1.0 / 16_777_216.0);
    }

    #[test]
    fn normals_have_the_moments_of_the_normal_distribution() {
        let stream = Stream::new(2, Purpose::PositionNoise, 9);
        let draws: Vec<f64> = (0..50_000).flat_map(|i| stream.normals(i)).map(f64::from).collect();
        let n = draws.len() as f64;
        let moment = |k: i32| draws.iter().map(|z| z.powi(k)).sum::<f64>() / n;
        // Variances of the sample moments are (μ₂ₖ − μₖ²)/n: 1, 2, 15, 96 over n; five σ each.
        for (k, expected, variance) in
            [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)]
        {
            let bound = 5.0 * f64::sqrt(variance / n);
            assert!((moment(k) - expected).abs() < bound, "moment {k}: {}", moment(k));
        }
    }

    #[test]
    fn bounded_draws_reach_both_ends_and_stay_inside() {
        assert_eq!(below(0, 10), 0);
        assert_eq!(below(u32::MAX, 10), 9);
        assert_eq!(below(u32::MAX, u32::MAX), u32::MAX - 1);
        assert_eq!(below(123, 0), 0);
    }
}
