//! Philox4x32-10: four random words from a counter and a key, with no state in between.
//!
//! Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011, §3.2 and
//! table 2. Only 32-bit multiplications, xors and additions: WGSL computes the same words.

/// Multipliers of the two halves of a round.
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
/// What the key grows by in every round: the golden ratio and √3 − 1, times 2³².
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
/// Rounds that the paper recommends: the fewest that pass BigCrush are 7.
const ROUNDS: u32 = 10;

/// The block of random words at `counter` under `key`.
#[inline]
#[must_use]
pub fn philox4x32(
    [mut c0, mut c1, mut c2, mut c3]: [u32; 4],
    [mut k0, mut k1]: [u32; 2],
) -> [u32; 4] {
    for _ in 0..ROUNDS {
        let (high0, low0) = multiply(MULTIPLIERS[0], c0);
        let (high1, low1) = multiply(MULTIPLIERS[1], c2);
        (c0, c1, c2, c3) = (high1 ^ c1 ^ k0, low1, high0 ^ c3 ^ k1, low0);
        k0 = k0.wrapping_add(WEYL[0]);
        k1 = k1.wrapping_add(WEYL[1]);
    }
    [c0, c1, c2, c3]
}

/// The 64-bit product as (high, low) words.
#[inline]
fn multiply(a: u32, b: u32) -> (u32, u32) {
    let product = u64::from(a) * u64::from(b);
    ((product >> 32) as u32, product as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_known_answers_of_random123_are_reproduced() {
        // kat_vectors of the Random123 distribution, "philox4x32 10".
        let cases = [
            ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
            ([u32::MAX; 4], [u32::MAX; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, expected) in cases {
            assert_eq!(philox4x32(counter, key), expected);
        }
    }

    #[test]
    fn one_flipped_bit_of_the_counter_or_key_flips_half_of_the_output() {
        // 128 output bits, each flipped with probability 1/2: mean 64, σ = √32 ≈ 5.7. The mean over
        // 192 inputs has σ ≈ 0.41, so ±2.5 is 6 σ.
        let base = [1, 2, 3, 4, 5, 6];
        let words = |v: [u32; 6]| philox4x32([v[0], v[1], v[2], v[3]], [v[4], v[5]]);
        let flipped: u32 = (0..192)
            .map(|bit| {
                let mut changed = base;
                changed[bit / 32] ^= 1 << (bit % 32);
                let (a, b) = (words(base), words(changed));
                a.iter().zip(b).map(|(x, y)| (x ^ y).count_ones()).sum::<u32>()
            })
            .sum();
        let mean = f64::from(flipped) / 192.0;
        assert!((mean - 64.0).abs() < 2.5, "{mean}");
    }
}
