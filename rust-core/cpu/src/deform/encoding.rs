//! γ in single precision, exact to about one rounding at every octave.
//!
//! sin(512·x) of an f32 product has no correct digit left for |x| = 8: the product alone is off by
//! 2.4e-4. So the angle is reduced in f64, in turns, where scaling by 2ᵏ is exact, and only the
//! rest, at most an eighth of a turn, is rounded to f32.

use std::f64::consts::{FRAC_1_PI, TAU};

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use fearless_simd_macros::simd;
use trapeze_scene::deformation::Encoding;

use super::group::{BLOCK, GROUP, Group};

/// γ of any number of positions: `write` gets the place of each and its `encoding.width()` values.
pub(crate) fn encode_positions(
    level: Level,
    encoding: Encoding,
    positions: &[[f64; 3]],
    mut write: impl FnMut(usize, &[f32]),
) {
    let mut rows: Group = [[0.0; BLOCK]; GROUP];
    for (group, positions) in positions.chunks(GROUP).enumerate() {
        dispatch!(level, simd => encode_group(simd, encoding, positions, &mut rows));
        for (s, row) in rows[..positions.len()].iter().enumerate() {
            write(group * GROUP + s, &row[..encoding.width()]);
        }
    }
}

/// γ of up to [`GROUP`] positions, into the first `encoding.width()` columns of their rows.
#[simd]
pub(super) fn encode_group<S: Simd>(
    _: S,
    encoding: Encoding,
    positions: &[[f64; 3]],
    out: &mut Group,
) {
    const VALUES: usize = 3 * GROUP;
    let mut turns = [0.0; VALUES];
    for (s, position) in positions.iter().enumerate().take(GROUP) {
        for c in 0..3 {
            turns[3 * s + c] = position[c] * (FRAC_1_PI / 2.0);
            out[s][c] = position[c] as f32;
        }
    }
    let (mut sines, mut cosines) = ([0.0; VALUES], [0.0; VALUES]);
    for octave in 0..encoding.octaves {
        // One plain loop over plain arrays: the compiler makes vectors of it.
        for i in 0..VALUES {
            (sines[i], cosines[i]) = sin_cos_of_turns(turns[i]);
            turns[i] *= 2.0;
        }
        let column = 3 + 6 * octave;
        for (s, row) in out.iter_mut().enumerate() {
            row[column..column + 3].copy_from_slice(&sines[3 * s..3 * s + 3]);
            row[column + 3..column + 6].copy_from_slice(&cosines[3 * s..3 * s + 3]);
        }
    }
}

/// (sin, cos) of 2π · `turns`, maximum error 1.2e-7.
///
/// Polynomials of Cephes' `sinf` and `cosf` (Moshier) on [−π/4, π/4]. No branches, so that loops
/// over it vectorise; infinite and NaN angles give NaN.
#[inline(always)]
fn sin_cos_of_turns(turns: f64) -> (f32, f32) {
    let quarters = (4.0 * turns).round_ties_even();
    let r = ((turns - 0.25 * quarters) * TAU) as f32;
    let quadrant = quarters - 4.0 * (0.25 * quarters).floor();

    let r2 = r * r;
    let sine = r + r * r2 * (-1.666_665_5e-1 + r2 * (8.332_161e-3 + r2 * -1.951_529_6e-4));
    let cosine =
        1.0 - 0.5 * r2 + r2 * r2 * (4.166_664_6e-2 + r2 * (-1.388_731_6e-3 + r2 * 2.443_315_7e-5));

    let odd = quadrant == 1.0 || quadrant == 3.0;
    let (sine, cosine) = if odd { (cosine, sine) } else { (sine, cosine) };
    let sine = if quadrant >= 2.0 { -sine } else { sine };
    let cosine = if quadrant == 1.0 || quadrant == 2.0 { -cosine } else { cosine };
    (sine, cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The specification of the stage: 2e-7. Two roundings to f32 of values up to 1 (the reduced
    /// angle and the result, 3e-8 each) and the polynomials' own 6e-8 make 1.2e-7.
    const MAX_ERROR: f64 = 2e-7;

    fn worst_error(range: f64) -> f64 {
        let encoding = Encoding { dimensions: 3, octaves: 10 };
        let mut worst: f64 = 0.0;
        let mut exact = vec![0.0; encoding.width()];
        for step in 0..4000 {
            let positions: [[f64; 3]; GROUP] = std::array::from_fn(|s| {
                std::array::from_fn(|c| {
                    // Every value that an f32 scene can hold is reached through an f32.
                    let share = f64::from(step * 24 + s as u32 * 3 + c as u32) / 96_000.0;
                    f64::from(((2.0 * share - 1.0) * range) as f32)
                })
            });
            let mut rows = [[0.0; BLOCK]; GROUP];
            dispatch!(Level::new(), simd => encode_group(simd, encoding, &positions, &mut rows));
            for (row, position) in rows.iter().zip(&positions) {
                encoding.encode(position, &mut exact);
                for (&fast, exact) in row[3..].iter().zip(&exact[3..]) {
                    worst = worst.max((f64::from(fast) - exact).abs());
                }
            }
        }
        worst
    }

    #[test]
    fn every_octave_is_accurate_up_to_8_units() {
        let worst = worst_error(8.0);
        assert!(worst < MAX_ERROR, "{worst}");
    }

    #[test]
    fn every_octave_is_accurate_far_from_the_origin() {
        let worst = worst_error(1e5);
        assert!(worst < MAX_ERROR, "{worst}");
    }
}
