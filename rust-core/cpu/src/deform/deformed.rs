//! The geometry of one moment: what the deformation stage hands to the projection stage.

use rayon::prelude::*;
use trapeze_scene::Splats;

use crate::reference::deform::canonical_pose;

/// Splats in world space at one time, activated: one entry per splat in every array.
///
/// Rotation and scale are kept apart instead of being multiplied into a covariance: the projection
/// stage forms J W R S (2 × 3) and gets the determinant of the projected covariance as a sum of
/// squares, which a covariance rounded to single precision can no longer give for needles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deformed {
    /// Centres, relative to the scene's origin.
    pub positions: Vec<[f32; 3]>,
    /// Quaternions (w, x, y, z) that enter the covariance as they are: of unit length, except
    /// under [`RotationRule::AsTrained`](trapeze_scene::deformation::RotationRule::AsTrained).
    pub rotations: Vec<[f32; 4]>,
    /// Standard deviations along the local axes, world units, in 0 ..= [`MAX_SCALE`]; NaN for a
    /// splat whose scale is not a number (the projection stage leaves it out).
    pub scales: Vec<[f32; 3]>,
}

/// Largest linear scale, world units: the projected covariance stays below the f32 maximum for any
/// camera with focal length ≤ 1e5 px and near plane 0.01, and a splat this wide already covers
/// everything with constant α.
pub const MAX_SCALE: f32 = 1e12;

/// One entry of [`Deformed`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SplatPose {
    /// Centre, relative to the scene's origin.
    pub position: [f32; 3],
    /// Quaternion (w, x, y, z).
    pub rotation: [f32; 4],
    /// Standard deviations along the local axes.
    pub scale: [f32; 3],
}

impl Deformed {
    /// The splats as they are stored, activated: the state in scenes without a network.
    #[must_use]
    pub fn from_static(splats: &Splats) -> Self {
        let poses = || (0..splats.len()).into_par_iter().map(|i| canonical_pose(splats, i));
        Self {
            positions: splats.positions.clone(),
            rotations: poses().map(|pose| pose.rotation.map(|c| c as f32)).collect(),
            scales: poses().map(|pose| pose.scale.map(|c| c as f32)).collect(),
        }
    }

    /// The pose of splat `i`.
    ///
    /// # Panics
    /// When there is no splat `i`.
    #[must_use]
    pub fn pose(&self, i: usize) -> SplatPose {
        SplatPose {
            position: self.positions[i],
            rotation: self.rotations[i],
            scale: self.scales[i],
        }
    }
}
