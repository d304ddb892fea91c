//! Drawing splats with probability proportional to opacity.

use crate::random::{Stream, below};

/// A distribution over splats in integers, so that it is the same on every backend: floating-point
/// prefix sums depend on the order of addition, integer ones do not.
///
/// Weights are opacities in units of 2⁻ˢ with s as large as keeps the sum below 2³² (at most 23,
/// the precision of an f32). With a million splats s is 12, and an opacity of 0.005 weighs 20.
pub(crate) struct OpacityDistribution {
    /// Inclusive prefix sums of the weights.
    sums: Vec<u32>,
}

impl OpacityDistribution {
    /// The distribution over `opacities`; zero is never drawn. `None` when all are zero.
    pub(crate) fn new(opacities: impl ExactSizeIterator<Item = f32>) -> Option<Self> {
        let shift = (opacities.len() as u32).leading_zeros().min(23);
        let unit = (1u32 << shift) as f32;
        let sums: Vec<u32> = opacities
            .scan(0u32, |sum, opacity| {
                // Truncated: at most n·2ˢ < 2³² in total. A NaN weighs nothing.
                *sum += (opacity.clamp(0.0, 1.0) * unit) as u32;
                Some(*sum)
            })
            .collect();
        sums.last().is_some_and(|&total| total > 0).then_some(Self { sums })
    }

    /// The splat of draw `index`.
    pub(crate) fn draw(&self, stream: &Stream, index: u32) -> u32 {
        let total = self.sums[self.sums.len() - 1];
        let target = below(stream.words(index)[0], total);
        // The first splat whose inclusive sum is above the target.
        self.sums.partition_point(|&sum| sum <= target) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Purpose;

    #[test]
    fn splats_are_drawn_in_proportion_to_their_opacity() {
        let opacities = [0.0, 0.5, 0.25, 0.0, 0.125, f32::NAN, 0.125];
        let distribution = OpacityDistribution::new(opacities.into_iter()).unwrap();
        let stream = Stream::new(3, Purpose::Relocation, 10);
        let draws = 20_000;
        let mut counts = [0u32; 7];
        for index in 0..draws {
            counts[distribution.draw(&stream, index) as usize] += 1;
        }
        for (count, opacity) in counts.into_iter().zip(opacities) {
            let p = f64::from(if opacity.is_nan() { 0.0 } else { opacity });
            let n = f64::from(draws);
            // Five standard deviations of the binomial.
            assert!((f64::from(count) - n * p).abs() <= 5.0 * (n * p * (1.0 - p)).sqrt());
        }
    }

    #[test]
    fn sums_do_not_overflow_when_every_splat_is_opaque() {
        for n in [1usize, 2, 3, 1023, 1024, 1025, 100_000] {
            let distribution = OpacityDistribution::new(std::iter::repeat_n(1.0, n)).unwrap();
            assert!(distribution.sums.windows(2).all(|pair| pair[0] < pair[1]));
            let stream = Stream::new(1, Purpose::Growth, 0);
            assert!((0..100).all(|i| (distribution.draw(&stream, i) as usize) < n));
        }
    }

    #[test]
    fn nothing_is_drawn_where_nothing_is_visible() {
        assert!(OpacityDistribution::new(std::iter::empty()).is_none());
        assert!(OpacityDistribution::new([0.0, f32::NAN, -1.0].into_iter()).is_none());
    }
}
