//! SH coefficients packed for the projection, in three precisions.

use trapeze_scene::{ShDegree, Splats};

/// How SH coefficients are stored on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum HarmonicsStorage {
    /// 32-bit floats, as in the file: 192 bytes a splat at degree 3.
    #[default]
    Single,
    /// 16-bit floats, 96 bytes: colours are off by up to 2⁻¹¹ of the coefficients.
    Half,
    /// Band 0 in 16-bit floats, each higher band in 8 bits per coefficient of the splat's largest
    /// one in that band, 60 bytes. Infinite coefficients count as not a number.
    Byte,
}

impl HarmonicsStorage {
    /// All storages, most precise first.
    pub const ALL: [Self; 3] = [Self::Single, Self::Half, Self::Byte];

    /// 32-bit words that a splat's coefficients take.
    #[must_use]
    pub fn words(self, degree: ShDegree) -> usize {
        let coefficients = 3 * degree.coefficients();
        match self {
            Self::Single => coefficients,
            Self::Half => coefficients.div_ceil(2),
            Self::Byte => header_words(degree) + (coefficients - 3).div_ceil(4),
        }
    }
}

/// Words of band 0 and of the scales of the bands above, in half floats.
fn header_words(degree: ShDegree) -> usize {
    (3 + degree as usize).div_ceil(2)
}

/// Splats whose coefficients are interleaved.
const GROUP: usize = 32;
/// The byte that stands for a coefficient that is not a number.
const NOT_A_NUMBER: i8 = i8::MIN;
/// The byte of a band's largest coefficient.
const LARGEST: f32 = 127.0;

/// Coefficients of bands 0…degree in groups of 32 splats, word-major within a group, so that
/// neighbouring threads read neighbouring words.
pub(crate) fn pack(splats: &Splats, degree: ShDegree, storage: HarmonicsStorage) -> Vec<u32> {
    let words = storage.words(degree);
    let groups = splats.len().div_ceil(GROUP);
    let mut packed = vec![0; groups * GROUP * words];
    let mut coefficients = vec![0.0; 3 * degree.coefficients()];
    let mut own = vec![0; words];
    for i in 0..splats.len() {
        coefficients[..3].copy_from_slice(&splats.sh_dc[i]);
        let rest = &splats.sh_rest_of(i)[..coefficients.len() - 3];
        coefficients[3..].copy_from_slice(rest);
        match storage {
            HarmonicsStorage::Single => {
                own.iter_mut().zip(&coefficients).for_each(|(word, c)| *word = c.to_bits());
            }
            HarmonicsStorage::Half => pack_halves(&coefficients, &mut own),
            HarmonicsStorage::Byte => pack_bytes(&coefficients, degree, &mut own),
        }
        let group = i / GROUP * words;
        for (word, bits) in own.iter().enumerate() {
            packed[(group + word) * GROUP + i % GROUP] = *bits;
        }
    }
    packed
}

/// Two halves a word, the first in the low bits.
fn pack_halves(values: &[f32], words: &mut [u32]) {
    let half = |value: f32| u32::from(half::f16::from_f32(value).to_bits());
    for (word, pair) in words.iter_mut().zip(values.chunks(2)) {
        *word = half(pair[0]) | half(pair.get(1).copied().unwrap_or(0.0)) << 16;
    }
}

fn pack_bytes(coefficients: &[f32], degree: ShDegree, words: &mut [u32]) {
    let (band_0, rest) = coefficients.split_at(3);
    let mut bytes = [NOT_A_NUMBER; 48];
    let mut header = [0.0; 6];
    header[..3].copy_from_slice(band_0);
    let mut first = 0;
    for band in 1..=degree as usize {
        let end = first + 3 * (2 * band + 1);
        let coefficients = &rest[first..end];
        let largest =
            coefficients.iter().filter(|c| c.is_finite()).fold(0.0, |m: f32, c| m.max(c.abs()));
        let step = step_of(largest);
        header[2 + band] = step;
        for (byte, c) in bytes[first..end].iter_mut().zip(coefficients) {
            // What a half step cannot reach is the largest that it can.
            *byte = match (c.is_finite(), step > 0.0) {
                (false, _) => NOT_A_NUMBER,
                (true, false) => 0,
                (true, true) => (c / step).round().clamp(-LARGEST, LARGEST) as i8,
            };
        }
        first = end;
    }
    let (head, tail) = words.split_at_mut(header_words(degree));
    pack_halves(&header[..3 + degree as usize], head);
    for (word, four) in tail.iter_mut().zip(bytes[..first].chunks(4)) {
        let lane = |i: usize| four.get(i).map_or(0, |&byte| u32::from(byte as u8)) << (8 * i);
        *word = lane(0) | lane(1) | lane(2) | lane(3);
    }
}

/// The step between neighbouring bytes, as a half float: large enough for the largest coefficient
/// to be one of 127 steps, and not infinite.
fn step_of(largest: f32) -> f32 {
    let exact = largest / LARGEST;
    let rounded = half::f16::from_f32(exact);
    let up = if rounded.to_f32() < exact {
        half::f16::from_bits(rounded.to_bits() + 1)
    } else {
        rounded
    };
    if up.is_finite() { up.to_f32() } else { half::f16::MAX.to_f32() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 70;

    fn splats(degree: ShDegree) -> Splats {
        let rest = 3 * degree.rest_coefficients();
        Splats {
            positions: vec![[0.0; 3]; N],
            sh_dc: (0..N).map(|i| [i as f32, i as f32 + 0.25, i as f32 + 0.5]).collect(),
            sh_rest: (0..N * rest).map(|i| (i % 97) as f32 * 0.5 - 20.0).collect(),
            sh_degree: degree,
            ..Splats::default()
        }
    }

    /// Word `index` of splat `i`.
    fn word(packed: &[u32], words: usize, i: usize, index: usize) -> u32 {
        packed[((i / 32) * words + index) * 32 + i % 32]
    }

    fn half_of(word: u32, index: usize) -> f32 {
        half::f16::from_bits((word >> (16 * (index % 2))) as u16).to_f32()
    }

    #[test]
    fn coefficients_keep_their_place_in_floats_of_either_size() {
        let splats = splats(ShDegree::One);
        let single = pack(&splats, ShDegree::One, HarmonicsStorage::Single);
        let half = pack(&splats, ShDegree::One, HarmonicsStorage::Half);
        for i in 0..N {
            for index in 0..12 {
                let exact = if index < 3 {
                    splats.sh_dc[i][index]
                } else {
                    splats.sh_rest_of(i)[index - 3]
                };
                assert_eq!(f32::from_bits(word(&single, 12, i, index)), exact);
                assert_eq!(half_of(word(&half, 6, i, index / 2), index), exact);
            }
        }
    }

    #[test]
    fn bytes_are_within_half_a_step_of_their_band() {
        for degree in ShDegree::ALL {
            let splats = splats(degree);
            let words = HarmonicsStorage::Byte.words(degree);
            let packed = pack(&splats, degree, HarmonicsStorage::Byte);
            let header = header_words(degree);
            for i in 0..N {
                let band_0: Vec<f32> =
                    (0..3).map(|c| half_of(word(&packed, words, i, c / 2), c)).collect();
                assert_eq!(band_0, splats.sh_dc[i]);
                for (k, &exact) in splats.sh_rest_of(i).iter().enumerate() {
                    let band = ((k / 3 + 1) as f64).sqrt() as usize;
                    let step = half_of(word(&packed, words, i, (2 + band) / 2), 2 + band);
                    let byte = (word(&packed, words, i, header + k / 4) >> (8 * (k % 4))) as i8;
                    let error = (f32::from(byte) * step - exact).abs();
                    assert!(error <= 0.5001 * step, "{degree:?} {i} {k}: {exact}, {byte} × {step}");
                }
            }
        }
    }

    #[test]
    fn what_is_not_finite_is_marked_and_spoils_no_neighbour() {
        let mut splats = splats(ShDegree::One);
        splats.sh_rest[..9].copy_from_slice(&[
            f32::NAN,
            f32::INFINITY,
            1.0,
            -1.0,
            0.0,
            0.5,
            1e30,
            -1e30,
            0.0,
        ]);
        splats.sh_rest[9..18].fill(0.0);
        let packed = pack(&splats, ShDegree::One, HarmonicsStorage::Byte);
        let bytes = |i: usize| -> Vec<i8> {
            (0..9).map(|k| (word(&packed, 5, i, 2 + k / 4) >> (8 * (k % 4))) as i8).collect()
        };
        // A step is a finite half: numbers beyond 127 of the largest are the largest.
        assert_eq!(bytes(0), [-128, -128, 0, 0, 0, 0, 127, -127, 0]);
        assert_eq!(bytes(1), [0; 9]);
    }

    #[test]
    fn a_splat_of_degree_3_takes_192_96_and_60_bytes() {
        let bytes = HarmonicsStorage::ALL.map(|storage| 4 * storage.words(ShDegree::Three));
        assert_eq!(bytes, [192, 96, 60]);
    }
}
