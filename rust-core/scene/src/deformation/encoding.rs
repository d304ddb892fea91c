//! Positional encoding γ (Mildenhall et al. 2020, eq. 4, with the input itself in front).

/// Most octaves that are accepted: sin(2³¹ x) has no correct digit in single precision.
pub const MAX_OCTAVES: usize = 24;

/// γ(v) = [v, sin(2⁰v), cos(2⁰v), …, sin(2ᵒ⁻¹v), cos(2ᵒ⁻¹v)], each term over all `dimensions`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoding {
    /// Length of v.
    pub dimensions: usize,
    /// Number of octaves o.
    pub octaves: usize,
}

impl Encoding {
    /// Length of γ(v).
    #[must_use]
    pub const fn width(self) -> usize {
        self.dimensions * (1 + 2 * self.octaves)
    }

    /// The encoding of `dimensions` values that is `width` long.
    #[must_use]
    pub fn from_width(dimensions: usize, width: usize) -> Option<Self> {
        (0..=MAX_OCTAVES)
            .map(|octaves| Self { dimensions, octaves })
            .find(|encoding| encoding.width() == width)
    }

    /// γ(v) in double precision: the specification.
    ///
    /// # Panics
    /// When `v` does not have `dimensions` values or `out` is not `width()` long.
    pub fn encode(self, v: &[f64], out: &mut [f64]) {
        assert_eq!(v.len(), self.dimensions);
        let (raw, waves) = out.split_at_mut(self.dimensions);
        raw.copy_from_slice(v);
        for (octave, pair) in waves.chunks_exact_mut(2 * self.dimensions).enumerate() {
            let frequency = (1u64 << octave) as f64;
            let (sines, cosines) = pair.split_at_mut(self.dimensions);
            for ((sine, cosine), &x) in sines.iter_mut().zip(cosines).zip(v) {
                (*sine, *cosine) = (frequency * x).sin_cos();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_the_published_networks() {
        assert_eq!(Encoding { dimensions: 3, octaves: 10 }.width(), 63);
        assert_eq!(Encoding { dimensions: 1, octaves: 10 }.width(), 21);
        assert_eq!(Encoding { dimensions: 1, octaves: 6 }.width(), 13);
        assert_eq!(Encoding::from_width(3, 63).unwrap().octaves, 10);
        assert_eq!(Encoding::from_width(3, 64), None);
    }

    #[test]
    fn each_octave_lists_all_sines_before_all_cosines() {
        let mut out = [0.0; 15];
        Encoding { dimensions: 3, octaves: 2 }.encode(&[0.1, 0.2, 0.3], &mut out);
        assert_eq!(out[..3], [0.1, 0.2, 0.3]);
        assert_eq!(out[3], 0.1_f64.sin());
        assert_eq!(out[6], 0.1_f64.cos());
        assert_eq!(out[9 + 2], 0.6_f64.sin());
        assert_eq!(out[12 + 2], 0.6_f64.cos());
    }
}
