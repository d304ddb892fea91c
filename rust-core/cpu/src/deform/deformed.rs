//! The geometry of one moment: what the deformation stage hands to the projection stage.

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
