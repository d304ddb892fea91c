//! The bit fields of a packed splat.

/// `bits` bits of `value` from `shift`, as a fraction of their largest value.
fn fraction(value: u32, shift: u32, bits: u32) -> f64 {
    let largest = (1 << bits) - 1;
    f64::from(value >> shift & largest) / f64::from(largest)
}

/// The nearest of 2^`bits` levels from 0 to 1. NaN gives 0.
fn level(fraction: f64, bits: u32) -> u32 {
    let largest = f64::from((1u32 << bits) - 1);
    // NaN passes the clamp, and the cast takes it to 0.
    (fraction.clamp(0.0, 1.0) * largest).round() as u32
}

/// Three fractions from 11, 10 and 11 bits, first in the highest.
pub(super) fn unpack_11_10_11(value: u32) -> [f64; 3] {
    [fraction(value, 21, 11), fraction(value, 11, 10), fraction(value, 0, 11)]
}

/// The inverse of [`unpack_11_10_11`].
pub(super) fn pack_11_10_11([a, b, c]: [f64; 3]) -> u32 {
    level(a, 11) << 21 | level(b, 10) << 11 | level(c, 11)
}

/// Unit quaternion (w, x, y, z) from the index of its largest component, which is positive, and the
/// three others, each 10 bits between ±1/√2.
pub(super) fn unpack_rotation(value: u32) -> [f32; 4] {
    let largest = (value >> 30) as usize;
    let others = [20, 10, 0].map(|s| (fraction(value, s, 10) - 0.5) * std::f64::consts::SQRT_2);
    let rest = 1.0 - others.iter().map(|c| c * c).sum::<f64>();
    let mut others = others.into_iter();
    std::array::from_fn(|i| {
        let component = if i == largest { None } else { others.next() };
        // Quantised components can add up to a little more than 1.
        component.unwrap_or_else(|| rest.max(0.0).sqrt()) as f32
    })
}

/// The inverse of [`unpack_rotation`] for a quaternion of any length; one without a direction
/// (zero, NaN) becomes the identity.
pub(super) fn pack_rotation(rotation: [f32; 4]) -> u32 {
    let q = rotation.map(f64::from);
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    let q = if length > 0.0 && length.is_finite() {
        q.map(|c| c / length)
    } else {
        [1.0, 0.0, 0.0, 0.0]
    };
    let largest = (1..4).fold(0, |best, i| if q[i].abs() > q[best].abs() { i } else { best });
    let sign = q[largest].signum();
    let others = (0..4).filter(|&i| i != largest).map(|i| sign * q[i]);
    others.fold(largest as u32, |packed, c| {
        packed << 10 | level(c * std::f64::consts::FRAC_1_SQRT_2 + 0.5, 10)
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn every_level_survives_a_round_trip() {
        for i in 0..2048u32 {
            let packed = i << 21 | (i & 1023) << 11 | (2047 - i);
            assert_eq!(pack_11_10_11(unpack_11_10_11(packed)), packed);
        }
        assert_eq!(pack_11_10_11([f64::NAN, -1.0, 7.0]), 2047);
    }

    #[test]
    fn a_quaternion_without_direction_becomes_the_identity() {
        let half_level = std::f64::consts::SQRT_2 / 1023.0 / 2.0;
        for q in [[0.0; 4], [f32::NAN, 0.0, 1.0, 0.0], [f32::INFINITY; 4]] {
            let unpacked = unpack_rotation(pack_rotation(q));
            assert!(f64::from(unpacked[0]) > 0.999, "{unpacked:?}");
            assert!(unpacked[1..].iter().all(|&c| f64::from(c).abs() <= half_level + 1e-7));
        }
    }

    proptest! {
        #[test]
        fn rotations_come_back_within_half_a_level(
            q in prop::array::uniform4(-1.0f32..1.0),
            length in prop::sample::select(vec![1e-15f32, 1.0, 1e15]),
        ) {
            let norm = q.iter().map(|c| c * c).sum::<f32>().sqrt();
            prop_assume!(norm > 1e-2);
            let unpacked = unpack_rotation(pack_rotation(q.map(|c| c * length)));
            let dot: f64 = q.iter().zip(unpacked).map(|(a, b)| f64::from(*a) * f64::from(b)).sum();
            // Three components err by half a level each, √2/1023/2, the fourth follows on the
            // sphere: with e² = 3·(√2/2046)² off the axis of a component that is at least 1/2 the
            // chord is at most 2e, and 1 − cos = chord²/2.
            let e2 = 3.0 * (std::f64::consts::SQRT_2 / 2046.0).powi(2);
            let cosine = dot.abs() / f64::from(norm);
            prop_assert!(1.0 - cosine <= 2.0 * e2 + 1e-6, "{} > {}", 1.0 - cosine, 2.0 * e2);
        }
    }
}
