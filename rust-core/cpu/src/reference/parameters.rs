//! One splat's stored parameters in double precision, and their activations.

use glam::DVec3;
use trapeze_scene::{ShDegree, Splats, sh_basis, sigmoid};

use super::PosedSplat;
use super::deform::{Pose, activate};
use crate::project::MAX_CHANNEL;

/// The parameters of one splat, or a gradient by them, in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SplatParameters {
    /// Centre, world units.
    pub position: DVec3,
    /// Natural logarithms of the standard deviations.
    pub log_scale: DVec3,
    /// Quaternion (w, x, y, z), any length.
    pub rotation: [f64; 4],
    /// Opacity before the logistic function.
    pub opacity_logit: f64,
    /// SH coefficients, r g b each; those above the scene's degree are zero.
    pub sh: [[f64; 3]; 16],
}

impl SplatParameters {
    /// The parameters of splat `i`.
    ///
    /// # Panics
    /// When there is no splat `i`.
    #[must_use]
    pub fn of(splats: &Splats, i: usize) -> Self {
        let mut sh = [[0.0; 3]; 16];
        sh[0] = splats.sh_dc[i].map(f64::from);
        for (to, from) in sh[1..].iter_mut().zip(splats.sh_rest_of(i).chunks_exact(3)) {
            *to = std::array::from_fn(|channel| f64::from(from[channel]));
        }
        Self {
            position: DVec3::from(splats.positions[i].map(f64::from)),
            log_scale: DVec3::from(splats.log_scales[i].map(f64::from)),
            rotation: splats.rotations[i].map(f64::from),
            opacity_logit: f64::from(splats.opacity_logits[i]),
            sh,
        }
    }

    /// The splat as it is stored, activated and seen from `eye`, with SH up to `degree`.
    #[must_use]
    pub fn pose(&self, index: u32, eye: DVec3, degree: ShDegree) -> PosedSplat {
        let Pose { rotation, scale, .. } =
            activate(self.position.to_array(), self.log_scale.to_array(), self.rotation);
        PosedSplat {
            index,
            position: self.position,
            rotation,
            scale: DVec3::from(scale),
            opacity: sigmoid(self.opacity_logit),
            color: self.color(self.position - eye, degree),
        }
    }

    /// max(0, 0.5 + Σ cₖ Yₖ(direction)), each channel limited to [`MAX_CHANNEL`]; NaN gives 0.
    #[must_use]
    pub fn color(&self, to_splat: DVec3, degree: ShDegree) -> DVec3 {
        let channels = channels_before_limits(&self.sh, to_splat, degree);
        // `f64::max` returns the other operand for NaN.
        DVec3::from(channels.map(|c| c.max(0.0).min(f64::from(MAX_CHANNEL))))
    }
}

/// 0.5 + Σ cₖ Yₖ of the direction of `to_splat`, over the bands up to `degree`.
pub(super) fn channels_before_limits(
    coefficients: &[[f64; 3]; 16],
    to_splat: DVec3,
    degree: ShDegree,
) -> [f64; 3] {
    let basis = sh_basis(direction(to_splat).to_array());
    let mut channels = [0.5; 3];
    for (c, b) in coefficients.iter().zip(basis).take(degree.coefficients()) {
        for channel in 0..3 {
            channels[channel] += b * c[channel];
        }
    }
    channels
}

/// v / ‖v‖, or z where v has no direction.
pub(super) fn direction(v: DVec3) -> DVec3 {
    v.try_normalize().unwrap_or(DVec3::Z)
}
