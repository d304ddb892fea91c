//! From the sums over the pixels of each splat to the gradients by its parameters.

use std::f32::consts::LOG2_E;

use fearless_simd::Simd;
use fearless_simd_macros::simd;
use trapeze_scene::Splats;

use super::LastFrame;
use crate::deform::Deformed;
use crate::deform_backward::{PoseRule, unit_backward};
use crate::gradient::GradientChunk;
use crate::project::ProjectedSplat;
use crate::project_backward::{SplatInput, project_backward};
use crate::rasterize_backward::SplatSums;

/// No rank: a splat that was not drawn.
pub(super) const NOT_DRAWN: u32 = u32::MAX;

/// What the way from sums to parameters reads.
pub(super) struct SplatsBackward<'a> {
    pub(super) splats: &'a Splats,
    pub(super) poses: &'a Deformed,
    pub(super) opacities: &'a [f32],
    /// In drawing order, as `sums`.
    pub(super) sorted: &'a [ProjectedSplat],
    /// Place of each splat in that order, or [`NOT_DRAWN`].
    pub(super) rank_of: &'a [u32],
    pub(super) sums: &'a [SplatSums],
    pub(super) last: &'a LastFrame,
}

/// Carries the sums of consecutive splats back to their parameters. Scalar code, compiled for each
/// SIMD level.
#[simd]
pub(super) fn backward_chunk<S: Simd>(
    _: S,
    input: &SplatsBackward<'_>,
    chunk: &mut GradientChunk<'_>,
) {
    chunk.clear();
    for at in 0..chunk.len() {
        let rank = input.rank_of[chunk.first + at];
        if rank != NOT_DRAWN {
            backward_splat(input, rank as usize, chunk, at);
        }
    }
}

#[inline(always)]
fn backward_splat(
    input: &SplatsBackward<'_>,
    rank: usize,
    chunk: &mut GradientChunk<'_>,
    at: usize,
) {
    let (splats, last) = (input.splats, input.last);
    let i = chunk.first + at;
    let pose = input.poses.pose(i);
    let parameters = SplatInput { pose, sh_dc: splats.sh_dc[i], sh_rest: splats.sh_rest_of(i) };
    let by_pose = project_backward(
        &last.view,
        &parameters,
        &input.sorted[rank],
        &input.sums[rank],
        chunk.sh_rest_of(at),
    );
    if let Some(poses) = &mut chunk.poses {
        poses.positions[at] = by_pose.position;
        poses.rotations[at] = by_pose.rotation;
        poses.scales[at] = by_pose.scale;
    }
    let by_sum = last.pose_rule.sum_backward(&pose, by_pose.rotation, by_pose.scale);
    if let Some(outputs) = &mut chunk.outputs {
        let [x, y, z] = by_pose.position;
        let ([qw, qx, qy, qz], [sx, sy, sz]) = (by_sum.rotation, by_sum.scale);
        outputs[at] = [x, y, z, qw, qx, qy, qz, sx, sy, sz];
    }
    let canonical = match last.pose_rule {
        PoseRule::Static => pose,
        PoseRule::Deformed(_) => Deformed::static_pose(splats, i),
    };
    chunk.positions[at] = by_pose.position;
    chunk.rotations[at] =
        unit_backward(canonical.rotation, canonical.rotation_length, by_sum.rotation);
    chunk.log_scales[at] = std::array::from_fn(|c| by_sum.scale[c] * canonical.scale[c]);
    // d log₂ σ(x) = (1 − σ(x)) / ln 2 dx.
    let transparency = 1.0 - input.opacities[i];
    chunk.opacity_logits[at] = by_pose.log2_opacity * transparency * LOG2_E;
    chunk.sh_dc[at] = by_pose.sh_dc;
}
