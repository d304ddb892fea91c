//! Filling the columns of a scene from many threads.

use trapeze_scene::{GEOMETRY_BYTES_PER_SPLAT, ShDegree, Splats};

use crate::ParseError;

/// Splats that one task writes: enough to pay for the task, few enough that what it reads and
/// writes stays in the second-level cache (at 500 bytes per splat, 1 MB).
const SPLATS_PER_TASK: usize = 2048;

/// Mutable columns of a run of splats.
pub(crate) struct SplatBlock<'a> {
    /// Index of the block's first splat.
    pub(crate) first: usize,
    pub(crate) positions: &'a mut [[f32; 3]],
    pub(crate) log_scales: &'a mut [[f32; 3]],
    pub(crate) rotations: &'a mut [[f32; 4]],
    pub(crate) opacity_logits: &'a mut [f32],
    pub(crate) sh_dc: &'a mut [[f32; 3]],
    /// As many floats per splat as [`Splats::sh_rest_stride`] says, coefficient-major.
    pub(crate) sh_rest: &'a mut [f32],
    /// As many floats per splat as the scene has feature dimensions.
    pub(crate) features: &'a mut [f32],
}

/// Checks that there is memory for splats before it is taken in pieces that cannot be refused: a
/// system that is short of it is told about as an error, not by the end of the program.
pub(crate) fn expect_memory_for(count: usize, sh_degree: ShDegree) -> Result<(), ParseError> {
    let rest = sh_degree.rest_coefficients() as u64 * 3 * 4;
    let bytes = (count as u64).saturating_mul(GEOMETRY_BYTES_PER_SPLAT + rest);
    let refused = || ParseError::OutOfMemory { field: format!("{count} splats"), bytes };
    let length = usize::try_from(bytes).map_err(|_| refused())?;
    // Given back at once, untouched.
    Vec::<u8>::new().try_reserve_exact(length).map_err(|_| refused())
}

/// Splats of zeros to be filled. The pages are not touched before that.
///
/// # Errors
/// [`ParseError::OutOfMemory`].
pub(crate) fn zeroed_splats(count: usize, sh_degree: ShDegree) -> Result<Splats, ParseError> {
    expect_memory_for(count, sh_degree)?;
    Ok(Splats {
        positions: vec![[0.0; 3]; count],
        log_scales: vec![[0.0; 3]; count],
        rotations: vec![[0.0; 4]; count],
        opacity_logits: vec![0.0; count],
        sh_dc: vec![[0.0; 3]; count],
        sh_rest: vec![0.0; count * sh_degree.rest_coefficients() * 3],
        sh_degree,
    })
}

impl<'a> SplatBlock<'a> {
    /// All of `splats`; `features` is n × dimensions, or empty.
    pub(crate) fn all(splats: &'a mut Splats, features: &'a mut [f32]) -> Self {
        Self {
            first: 0,
            positions: &mut splats.positions,
            log_scales: &mut splats.log_scales,
            rotations: &mut splats.rotations,
            opacity_logits: &mut splats.opacity_logits,
            sh_dc: &mut splats.sh_dc,
            sh_rest: &mut splats.sh_rest,
            features,
        }
    }

    /// Number of splats.
    pub(crate) fn len(&self) -> usize {
        self.positions.len()
    }

    /// Calls `fill` on blocks that together are this one, in parallel.
    pub(crate) fn for_each_part(self, fill: &(impl Fn(SplatBlock<'_>) + Sync)) {
        if self.len() <= SPLATS_PER_TASK {
            fill(self);
            return;
        }
        // A multiple of the task size, so that all tasks but the last are full.
        let middle = (self.len() / 2).next_multiple_of(SPLATS_PER_TASK);
        let (left, right) = self.split_at(middle);
        rayon::join(|| left.for_each_part(fill), || right.for_each_part(fill));
    }

    fn split_at(self, middle: usize) -> (Self, Self) {
        let count = self.len().max(1);
        let (sh_stride, feature_stride) = (self.sh_rest.len() / count, self.features.len() / count);
        let (positions, positions_right) = self.positions.split_at_mut(middle);
        let (log_scales, log_scales_right) = self.log_scales.split_at_mut(middle);
        let (rotations, rotations_right) = self.rotations.split_at_mut(middle);
        let (opacity_logits, opacity_logits_right) = self.opacity_logits.split_at_mut(middle);
        let (sh_dc, sh_dc_right) = self.sh_dc.split_at_mut(middle);
        let (sh_rest, sh_rest_right) = self.sh_rest.split_at_mut(middle * sh_stride);
        let (features, features_right) = self.features.split_at_mut(middle * feature_stride);
        let left = Self {
            first: self.first,
            positions,
            log_scales,
            rotations,
            opacity_logits,
            sh_dc,
            sh_rest,
            features,
        };
        let right = Self {
            first: self.first + middle,
            positions: positions_right,
            log_scales: log_scales_right,
            rotations: rotations_right,
            opacity_logits: opacity_logits_right,
            sh_dc: sh_dc_right,
            sh_rest: sh_rest_right,
            features: features_right,
        };
        (left, right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_splats_than_memory_are_refused_with_their_size() {
        // 2⁵⁶ bytes and more: beyond every address space.
        let error = zeroed_splats(1 << 50, ShDegree::Three).unwrap_err().to_string();
        assert!(error.starts_with("1125899906842624 splats: "), "{error}");
        assert!(zeroed_splats(usize::MAX, ShDegree::Three).is_err());
    }

    #[test]
    fn every_value_of_every_splat_is_visited_once() {
        for count in [0, 1, 2048, 2049, 5 * 2048 + 17] {
            let mut splats = zeroed_splats(count, ShDegree::One).unwrap();
            let mut features = vec![0.0; count * 2];
            SplatBlock::all(&mut splats, &mut features).for_each_part(&|block| {
                for i in 0..block.len() {
                    let value = (block.first + i) as f32;
                    block.positions[i][2] += value;
                    block.opacity_logits[i] += value;
                    block.sh_rest[i * 9 + 8] += value;
                    block.features[i * 2 + 1] += value;
                }
            });
            for i in 0..count {
                let value = i as f32;
                assert_eq!(splats.positions[i], [0.0, 0.0, value]);
                assert_eq!(splats.opacity_logits[i], value);
                assert_eq!(splats.sh_rest_of(i)[8], value);
                assert_eq!(features[i * 2..][..2], [0.0, value]);
            }
        }
    }
}
