//! Sums across the lanes of several vectors at once.

use fearless_simd::f32x16;
use fearless_simd::prelude::*;

/// The sums of the lanes of ten vectors, in lanes 0–9 of one; the others are zero.
///
/// Adding the two halves of an interleaved pair leaves half the lanes to each of its vectors, so
/// four rounds bring sixteen vectors down to one: three operations for each pair instead of eight
/// for each vector. Vector i and vector i + 8 meet first, so sums end up in the order of the input.
#[inline(always)]
pub(super) fn sum_lanes<S: Simd>(simd: S, v: [f32x16<S>; 10]) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let with_8 = pair(v[0], v[8]);
    let with_9 = pair(v[1], v[9]);
    let alone = |x| pair(x, zero);
    let eights = [
        with_8,
        with_9,
        alone(v[2]),
        alone(v[3]),
        alone(v[4]),
        alone(v[5]),
        alone(v[6]),
        alone(v[7]),
    ];
    let fours = [
        pair(eights[0], eights[4]),
        pair(eights[1], eights[5]),
        pair(eights[2], eights[6]),
        pair(eights[3], eights[7]),
    ];
    pair(pair(fours[0], fours[2]), pair(fours[1], fours[3]))
}

/// Lanes a₀ + a₈, b₀ + b₈, a₁ + a₉, b₁ + b₉, …
#[inline(always)]
fn pair<S: Simd>(a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
    let (low, high) = a.interleave(b);
    low + high
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    #[test]
    fn every_sum_is_in_the_lane_of_its_vector() {
        // Integers below 2²⁴: sums are exact in any order.
        let values: [[f32; 16]; 10] =
            std::array::from_fn(|v| std::array::from_fn(|lane| (1 << v) as f32 * lane as f32));
        let sums: [f32; 16] = dispatch!(Level::new(), simd => {
            sum_lanes(simd, values.map(|v| f32x16::load_array(simd, v))).to_array()
        });
        for (v, &sum) in sums.iter().enumerate() {
            let expected = if v < 10 { (120 << v) as f32 } else { 0.0 };
            assert_eq!(sum, expected, "{v}");
        }
    }
}
