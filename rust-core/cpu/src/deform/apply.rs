//! What the network's outputs do to a splat.

use trapeze_scene::deformation::RotationRule;

use super::SplatPose;
use super::network::HeadOutputs;
use crate::reference::deform::{combined_rotation, deformed_scale, screw_displacement};

/// How the outputs of the heads are meant.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeadMeaning {
    /// The first six outputs are a screw axis instead of three of a displacement.
    pub(super) screw: bool,
    /// What happens to the sum of rotations.
    pub(super) rotation_rule: RotationRule,
    /// Of the scene; a screw turns about the world's origin.
    pub(super) origin: [f64; 3],
}

/// Adds the network's outputs to a canonical pose: the rules of [`crate::reference::deform`].
pub(super) fn apply_outputs(
    canonical: &SplatPose,
    outputs: &HeadOutputs,
    meaning: &HeadMeaning,
) -> SplatPose {
    let three = |from: usize| std::array::from_fn(|c| f64::from(outputs[from + c]));
    let position: [f64; 3] = canonical.position.map(f64::from);
    let (displacement, rest) = if meaning.screw {
        let world = std::array::from_fn(|c| position[c] + meaning.origin[c]);
        (screw_displacement(three(0), three(3), world), 6)
    } else {
        (three(0), 3)
    };
    let sum =
        std::array::from_fn(|c| f64::from(canonical.rotation[c]) + f64::from(outputs[rest + c]));
    let (rotation, rotation_length) = combined_rotation(sum, meaning.rotation_rule);
    let d_scale: [f64; 3] = three(rest + 4);
    SplatPose {
        position: std::array::from_fn(|c| (position[c] + displacement[c]) as f32),
        rotation: rotation.map(|c| c as f32),
        rotation_length: rotation_length as f32,
        scale: std::array::from_fn(|c| {
            deformed_scale(f64::from(canonical.scale[c]) + d_scale[c]) as f32
        }),
    }
}
