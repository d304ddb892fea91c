//! Drawing splats with probability proportional to opacity.

use trapeze_scene::sigmoid;

use crate::random::{Stream, below};

/// Bits of an opacity: it is counted in units of 2⁻²³, the precision of an f32.
const UNIT_BITS: u32 = 23;
/// Logits between which opacities are tabulated; beyond ±16 an opacity is a unit from 0 or 1.
const LOGIT_RANGE: f32 = 16.0;
/// Table entries per logit.
const STEPS: f32 = 64.0;
/// Bits of the place between two entries.
const FRACTION_BITS: u32 = 8;

/// Opacities as integers, by a table and integer arithmetic: shaders have neither double precision
/// nor a logistic function that two devices would round alike, and a prefix sum that is off by one
/// moves every draw behind it.
///
/// Interpolation is off by at most h²/8·max|σ″| = (1/64)²/8·0.097 = 3·10⁻⁶, relatively by as much for
/// small opacities.
pub(crate) struct OpacityUnits {
    table: Vec<u32>,
}

impl OpacityUnits {
    /// Entries of the table: one for each step, and one behind the last that is read with weight 0.
    pub(crate) const ENTRIES: usize = 2 * (LOGIT_RANGE * STEPS) as usize + 2;

    pub(crate) fn new() -> Self {
        let entry = |i: usize| {
            let logit = i as f64 / f64::from(STEPS) - f64::from(LOGIT_RANGE);
            (sigmoid(logit) * f64::from(1u32 << UNIT_BITS)).round() as u32
        };
        Self { table: (0..Self::ENTRIES).map(entry).collect() }
    }

    /// The table, for the kernel that reads it.
    pub(crate) fn table(&self) -> &[u32] {
        &self.table
    }

    /// The opacity of a finite logit, 0 to 2²³.
    pub(crate) fn of(&self, logit: f32) -> u32 {
        let scale = STEPS * (1u32 << FRACTION_BITS) as f32;
        let fixed = (logit.clamp(-LOGIT_RANGE, LOGIT_RANGE) * scale) as i32;
        let place = (fixed + (LOGIT_RANGE * scale) as i32) as u32;
        let entry = (place >> FRACTION_BITS) as usize;
        let (low, high) = (self.table[entry], self.table[entry + 1]);
        low + (((high - low) * (place & ((1 << FRACTION_BITS) - 1))) >> FRACTION_BITS)
    }
}

/// A distribution over splats in integers, so that it is the same on every backend: floating-point
/// prefix sums depend on the order of addition, integer ones do not.
///
/// Weights are opacities in units of 2⁻ˢ with s as large as keeps the sum below 2³² (at most 23).
/// With a million splats s is 12, and an opacity of 0.005 weighs 20.
pub(crate) struct OpacityDistribution {
    /// Inclusive prefix sums of the weights.
    sums: Vec<u32>,
}

/// Bits that are left of the units of each of `splats` opacities.
pub(crate) fn weight_bits(splats: u32) -> u32 {
    splats.leading_zeros().min(UNIT_BITS)
}

/// What units of 2⁻²³ are shifted right by to become the weights of `splats` splats.
pub(crate) fn weight_shift(splats: u32) -> u32 {
    UNIT_BITS - weight_bits(splats)
}

impl OpacityDistribution {
    /// The distribution over opacities in units of 2⁻²³; zero is never drawn. `None` when all weights
    /// are zero.
    pub(crate) fn new(units: impl ExactSizeIterator<Item = u32>) -> Option<Self> {
        let shift = weight_shift(units.len() as u32);
        let sums: Vec<u32> = units
            .scan(0u32, |sum, units| {
                // At most n·2ˢ < 2³² in total.
                *sum += units >> shift;
                Some(*sum)
            })
            .collect();
        sums.last().is_some_and(|&total| total > 0).then_some(Self { sums })
    }

    /// The same weight for each of `splats` splats. `None` when there are none.
    pub(crate) fn even(splats: u32) -> Option<Self> {
        Self::new(std::iter::repeat_n(1 << UNIT_BITS, splats as usize))
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
    fn opacities_in_units_are_those_of_the_logistic_function() {
        let units = OpacityUnits::new();
        for i in -200_000..=200_000 {
            let logit = i as f32 * 1e-4;
            let exact = sigmoid(f64::from(logit));
            let found = f64::from(units.of(logit)) / f64::from(1u32 << UNIT_BITS);
            // Interpolation, the rounding of the table, and the logit rounded down to 2⁻¹⁴.
            let bound = 3e-6 + 2.0 / f64::from(1u32 << UNIT_BITS) + 0.25 / 16_384.0;
            assert!((found - exact).abs() <= bound, "{logit}: {found} {exact}");
        }
        assert_eq!((units.of(f32::MIN), units.of(f32::MAX)), (1, (1 << UNIT_BITS) - 1));
    }

    #[test]
    fn splats_are_drawn_in_proportion_to_their_opacity() {
        let opacities = [0.0, 0.5, 0.25, 0.0, 0.125, 0.0, 0.125];
        let units = opacities.map(|o: f64| (o * f64::from(1u32 << UNIT_BITS)) as u32);
        let distribution = OpacityDistribution::new(units.into_iter()).unwrap();
        let stream = Stream::new(3, Purpose::Relocation, 10);
        let draws = 20_000;
        let mut counts = [0u32; 7];
        for index in 0..draws {
            counts[distribution.draw(&stream, index) as usize] += 1;
        }
        for (count, p) in counts.into_iter().zip(opacities) {
            let n = f64::from(draws);
            // Five standard deviations of the binomial.
            assert!((f64::from(count) - n * p).abs() <= 5.0 * (n * p * (1.0 - p)).sqrt());
        }
    }

    #[test]
    fn sums_do_not_overflow_when_every_splat_is_opaque() {
        for n in [1, 2, 3, 1023, 1024, 1025, 100_000] {
            let distribution = OpacityDistribution::even(n).unwrap();
            assert!(distribution.sums.windows(2).all(|pair| pair[0] < pair[1]));
            let stream = Stream::new(1, Purpose::Growth, 0);
            assert!((0..100).all(|i| distribution.draw(&stream, i) < n));
        }
    }

    #[test]
    fn nothing_is_drawn_where_nothing_is_visible() {
        assert!(OpacityDistribution::new(std::iter::empty()).is_none());
        assert!(OpacityDistribution::new([0, 0, 0].into_iter()).is_none());
        assert!(OpacityDistribution::even(0).is_none());
    }
}
