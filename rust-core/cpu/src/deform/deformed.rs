//! The geometry of one moment: what the deformation stage hands to the projection stage.

use rayon::prelude::*;
use trapeze_scene::Splats;

use crate::reference::deform::{canonical_pose, quaternion_length};

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
    /// Length of what was normalised to give the rotation, for the way back; 0 where it had no
    /// direction and the identity stands in.
    pub rotation_lengths: Vec<f32>,
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
    /// Length of what was normalised to give the rotation; 0 where it had no direction.
    pub rotation_length: f32,
    /// Standard deviations along the local axes.
    pub scale: [f32; 3],
}

/// Splats that one task activates.
const CHUNK: usize = 1024;

impl Deformed {
    /// The splats as they are stored, activated: the state in scenes without a network.
    #[must_use]
    pub fn from_static(splats: &Splats) -> Self {
        let mut deformed = Self::default();
        deformed.set_static(splats);
        deformed
    }

    /// The same into arrays that are there, for splats that change from frame to frame.
    pub(crate) fn set_static(&mut self, splats: &Splats) {
        let n = splats.len();
        self.positions.clone_from(&splats.positions);
        self.rotations.resize(n, [0.0; 4]);
        self.rotation_lengths.resize(n, 0.0);
        self.scales.resize(n, [0.0; 3]);
        let rotations = self.rotations.par_chunks_mut(CHUNK);
        let lengths = self.rotation_lengths.par_chunks_mut(CHUNK);
        let scales = self.scales.par_chunks_mut(CHUNK);
        rotations.zip(lengths).zip(scales).enumerate().for_each(
            |(chunk, ((rotations, lengths), scales))| {
                let outputs = rotations.iter_mut().zip(lengths).zip(scales);
                for (i, ((rotation, length), scale)) in (chunk * CHUNK..).zip(outputs) {
                    let pose = Self::static_pose(splats, i);
                    (*rotation, *length, *scale) =
                        (pose.rotation, pose.rotation_length, pose.scale);
                }
            },
        );
    }

    /// The pose of one splat as it is stored, activated.
    pub(crate) fn static_pose(splats: &Splats, i: usize) -> SplatPose {
        let pose = canonical_pose(splats, i);
        let length = quaternion_length(splats.rotations[i].map(f64::from));
        SplatPose {
            position: splats.positions[i],
            rotation: pose.rotation.map(|c| c as f32),
            rotation_length: length as f32,
            scale: pose.scale.map(|c| c as f32),
        }
    }

    /// Sets the pose of splat `i`, which is there.
    pub(crate) fn set(&mut self, i: usize, pose: &SplatPose) {
        self.positions[i] = pose.position;
        self.rotations[i] = pose.rotation;
        self.rotation_lengths[i] = pose.rotation_length;
        self.scales[i] = pose.scale;
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
            rotation_length: self.rotation_lengths[i],
            scale: self.scales[i],
        }
    }
}
