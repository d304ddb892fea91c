//! The two packings of a unit quaternion. Both keep the sign that makes the missing component
//! positive: q and −q are the same rotation.

use std::f32::consts::FRAC_1_SQRT_2;

/// Largest magnitude of a component in nine bits.
const MAGNITUDE: u32 = (1 << 9) - 1;

/// Version 2: x, y, z as bytes over [−1, 1], w from the unit length. Gives (x, y, z, w).
pub(super) fn unpack_first_three(bytes: [u8; 3]) -> [f32; 4] {
    let [x, y, z] = bytes.map(|b| f32::from(b) / 127.5 - 1.0);
    [x, y, z, (1.0 - (x * x + y * y + z * z)).max(0.0).sqrt()]
}

/// Versions 3 and 4: two bits for the index of the largest component in (x, y, z, w), then sign
/// and nine bits of magnitude over [0, √½] for each of the others, the first in the highest bits.
pub(super) fn unpack_smallest_three(bytes: [u8; 4]) -> [f32; 4] {
    let mut packed = u32::from_le_bytes(bytes);
    let largest = (packed >> 30) as usize;
    let mut q = [0.0; 4];
    let mut squares = 0.0;
    for i in (0..4).rev().filter(|&i| i != largest) {
        let magnitude = (packed & MAGNITUDE) as f32 / MAGNITUDE as f32 * FRAC_1_SQRT_2;
        q[i] = if packed & (MAGNITUDE + 1) == 0 { magnitude } else { -magnitude };
        squares += magnitude * magnitude;
        packed >>= 10;
    }
    q[largest] = (1.0_f32 - squares).max(0.0).sqrt();
    q
}

/// The inverse of [`unpack_smallest_three`] for a unit quaternion (x, y, z, w).
pub(super) fn pack_smallest_three(q: [f32; 4]) -> [u8; 4] {
    let largest = (1..4).fold(0, |best, i| if q[i].abs() > q[best].abs() { i } else { best });
    let mut packed = largest as u32;
    for i in (0..4).filter(|&i| i != largest) {
        // The second largest component of a unit quaternion is at most √½; rounding in the
        // normalisation can exceed it by an ulp, which must not carry into the sign bit.
        let scaled = q[i].abs() / FRAC_1_SQRT_2 * MAGNITUDE as f32;
        let magnitude = (scaled.round() as u32).min(MAGNITUDE);
        let negative = u32::from((q[i] < 0.0) != (q[largest] < 0.0));
        packed = packed << 10 | negative << 9 | magnitude;
    }
    packed.to_le_bytes()
}

#[cfg(test)]
mod tests {
    use glam::Vec4;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn smallest_three_keep_the_rotation_within_half_a_step(
            q in prop::array::uniform4(-1.0..1.0_f32)
                .prop_filter_map("too short", |q| Vec4::from(q).try_normalize()),
        ) {
            let found = Vec4::from(unpack_smallest_three(pack_smallest_three(q.to_array())));
            let found = if found.dot(q) < 0.0 { -found } else { found };
            // Half a step in each of three components, e = √½/511/2. The largest, L ≥ ½, follows
            // from the others: its error is at most Σ|q|e / L ≤ √3·√(1 − L²)·e / L ≤ 3e at L = ½.
            let e = FRAC_1_SQRT_2 / MAGNITUDE as f32 / 2.0;
            let largest = q.abs().max_element();
            for i in 0..4 {
                let bound = if q[i].abs() == largest { 3.0 * e } else { e };
                prop_assert!((found[i] - q[i]).abs() < bound * 1.01, "{q} became {found}");
            }
            prop_assert!((found.length() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn equal_components_do_not_spill_over_the_sign_bit() {
        for q in [[0.5; 4], [-FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0], [0.0, 0.0, 0.0, -1.0]] {
            let found = unpack_smallest_three(pack_smallest_three(q));
            let dot: f32 = (0..4).map(|i| found[i] * q[i]).sum();
            assert!((dot.abs() - 1.0).abs() < 1e-5, "{q:?} became {found:?}");
        }
    }

    #[test]
    fn the_first_three_give_a_positive_w() {
        assert_eq!(unpack_first_three([255, 0, 255])[3], 0.0);
        let [x, y, z, w] = unpack_first_three([127, 128, 127]);
        assert!(x.abs() < 0.01 && y.abs() < 0.01 && z.abs() < 0.01 && w > 0.99);
    }
}
