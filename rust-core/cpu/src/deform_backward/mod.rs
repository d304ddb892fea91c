//! The mirror of stage 1: ∂L/∂pose → ∂L/∂(stored parameters).
//!
//! With a deformation network, the gradient by the sum of canonical value and network output is
//! that of both. From there [`network_backward`] goes on to the weights; the way through the
//! network's inputs is not followed (Deformable 3D Gaussians stops the gradient there).

mod network;

use trapeze_scene::deformation::RotationRule;

use crate::deform::{MAX_SCALE, SplatPose};
use crate::reference::deform::{MIN_DEFORMED_SCALE, MIN_TRAINED_ROTATION_LENGTH};

pub(crate) use network::{MovedSplats, OutputGradient, network_backward};

/// How poses came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PoseRule {
    /// The stored parameters, activated.
    Static,
    /// A network's outputs were added.
    Deformed(RotationRule),
}

/// ∂L/∂ the sums of canonical values and network outputs, before normalisation and floor.
pub(crate) struct SumGradient {
    pub rotation: [f32; 4],
    pub scale: [f32; 3],
}

impl PoseRule {
    /// The mirror of `apply_outputs`; for a static pose only the ceiling of the scale is left.
    #[inline(always)]
    pub(crate) fn sum_backward(
        self,
        pose: &SplatPose,
        rotation: [f32; 4],
        scale: [f32; 3],
    ) -> SumGradient {
        let floor = match self {
            Self::Static => 0.0,
            Self::Deformed(_) => MIN_DEFORMED_SCALE as f32,
        };
        let is_free = |s: f32| s > floor && s < MAX_SCALE;
        SumGradient {
            rotation: match self {
                Self::Static | Self::Deformed(RotationRule::AsTrained) => rotation,
                Self::Deformed(RotationRule::Renormalised) => {
                    unit_backward(pose.rotation, pose.rotation_length, rotation)
                }
            },
            scale: std::array::from_fn(|c| if is_free(pose.scale[c]) { scale[c] } else { 0.0 }),
        }
    }
}

/// ∂L/∂q from ∂L/∂(q / ‖q‖), given q / ‖q‖ and ‖q‖: what is along q has no effect. Zero
/// below [`MIN_TRAINED_ROTATION_LENGTH`].
#[inline(always)]
pub(crate) fn unit_backward(unit: [f32; 4], length: f32, gradient: [f32; 4]) -> [f32; 4] {
    if length < MIN_TRAINED_ROTATION_LENGTH as f32 {
        return [0.0; 4];
    }
    let along: f32 = (0..4).map(|c| unit[c] * gradient[c]).sum();
    std::array::from_fn(|c| (gradient[c] - along * unit[c]) / length)
}
