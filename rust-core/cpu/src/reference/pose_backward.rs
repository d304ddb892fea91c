//! The mirror of [`pose_scene`](super::pose_scene): ∂L/∂(splat in the world) → ∂L/∂(stored
//! parameters), through activations, colour, and what a deformation adds.

use glam::DVec3;
use trapeze_scene::deformation::RotationRule;
use trapeze_scene::{
    ColorSource, FrameSettings, Scene, ShDegree, sh_basis, sh_basis_gradient, sigmoid,
};

use super::deform::{
    MIN_DEFORMED_SCALE, MIN_ROTATION_NORM, MIN_TRAINED_ROTATION_LENGTH, NetworkOutput, Pose,
    at_most_max_scale, canonical_pose, evaluate_network, quaternion_length,
};
use super::parameters::{channels_before_limits, direction};
use super::pose::{network_time, pose};
use super::{PosedGradient, SplatParameters};
use crate::deform::MAX_SCALE;
use crate::project::MAX_CHANNEL;

/// What comes out of [`pose_backward`].
#[derive(Clone, Debug, PartialEq)]
pub struct StoredGradient {
    /// By the stored parameters.
    pub splat: SplatParameters,
    /// By what the deformation network adds to the pose, in scenes without one by what it would.
    pub output: NetworkOutput,
}

/// Gradient of splat `i` by its stored parameters and by the outputs of the deformation network,
/// from the gradient of the posed splat.
///
/// Outputs and canonical values are added, so both get the gradient by their sum: that by the pose
/// before its normalisation and floor. The way through the network's inputs is not followed, as in
/// training (Deformable 3D Gaussians stops the gradient there).
#[must_use]
pub fn pose_backward(
    scene: &Scene,
    i: usize,
    eye: DVec3,
    settings: &FrameSettings,
    gradient: &PosedGradient,
) -> StoredGradient {
    let parameters = SplatParameters::of(&scene.splats, i);
    let degree = scene.splats.sh_degree.min(settings.max_sh_degree);
    let (sh, through_color) = match settings.color_source {
        ColorSource::SphericalHarmonics => {
            let to_splat = DVec3::from(pose(scene, i, settings).position) - eye;
            color_backward(&parameters.sh, to_splat, degree, gradient.color)
        }
        ColorSource::Clusters | ColorSource::Motion | ColorSource::Depth(_) => {
            ([[0.0; 3]; 16], DVec3::ZERO)
        }
    };
    let (rotation, scale) = match &scene.deformation {
        None => (gradient.rotation, gradient.scale),
        Some(network) => {
            let canonical = canonical_pose(&scene.splats, i);
            let world = DVec3::from(canonical.position) + scene.origin;
            let time = network_time(scene, i, settings);
            let output = evaluate_network(network, world.to_array(), time);
            output_backward(&canonical, &output, network.rotation_rule, gradient)
        }
    };
    let opacity = sigmoid(parameters.opacity_logit);
    let position = gradient.position + through_color;
    StoredGradient {
        splat: SplatParameters {
            position,
            log_scale: log_scale_backward(parameters.log_scale, scale),
            rotation: unit_backward(parameters.rotation, rotation),
            // σ' = σ(x)·σ(−x), without cancellation near 1.
            opacity_logit: gradient.opacity * opacity * sigmoid(-parameters.opacity_logit),
            sh,
        },
        output: NetworkOutput {
            displacement: position.to_array(),
            d_rotation: rotation,
            d_scale: scale.to_array(),
        },
    }
}

/// ∂L/∂(normalise(q) + d_q) and ∂L/∂(scale + d_s), from ∂L/∂(what enters the covariance).
fn output_backward(
    canonical: &Pose,
    output: &NetworkOutput,
    rule: RotationRule,
    gradient: &PosedGradient,
) -> ([f64; 4], DVec3) {
    let sum: [f64; 4] = std::array::from_fn(|c| canonical.rotation[c] + output.d_rotation[c]);
    let rotation = if quaternion_length(sum) < MIN_ROTATION_NORM {
        [0.0; 4]
    } else {
        match rule {
            RotationRule::AsTrained => gradient.rotation,
            RotationRule::Renormalised => unit_backward(sum, gradient.rotation),
        }
    };
    let scale = std::array::from_fn(|c| {
        let sum = canonical.scale[c] + output.d_scale[c];
        let free = (MIN_DEFORMED_SCALE..=f64::from(MAX_SCALE)).contains(&sum);
        if free { gradient.scale[c] } else { 0.0 }
    });
    (rotation, DVec3::from(scale))
}

/// ∂L/∂(SH coefficients) and ∂L/∂(vector from the eye to the splat).
fn color_backward(
    coefficients: &[[f64; 3]; 16],
    to_splat: DVec3,
    degree: ShDegree,
    gradient: DVec3,
) -> ([[f64; 3]; 16], DVec3) {
    // Channels at their limits do not move. One that is free has finite coefficients, the others'
    // may be anything.
    let channels = channels_before_limits(coefficients, to_splat, degree);
    let free: Vec<usize> =
        (0..3).filter(|&c| channels[c] > 0.0 && channels[c] < f64::from(MAX_CHANNEL)).collect();
    let unit = direction(to_splat);
    let (basis, slopes) = (sh_basis(unit.to_array()), sh_basis_gradient(unit.to_array()));
    let mut by_coefficients = [[0.0; 3]; 16];
    let mut by_direction = DVec3::ZERO;
    for k in 0..degree.coefficients() {
        for &c in &free {
            by_coefficients[k][c] = gradient[c] * basis[k];
            by_direction += gradient[c] * coefficients[k][c] * DVec3::from(slopes[k]);
        }
    }
    let length = to_splat.length();
    let through = if length > 0.0 && length.is_finite() {
        (by_direction - unit * unit.dot(by_direction)) / length
    } else {
        DVec3::ZERO
    };
    (by_coefficients, through)
}

/// ∂L/∂log s from ∂L/∂s; zero where s is held at its maximum.
fn log_scale_backward(log_scale: DVec3, gradient: DVec3) -> DVec3 {
    DVec3::from(std::array::from_fn(|c| {
        let scale = log_scale[c].exp();
        if at_most_max_scale(scale) < scale { 0.0 } else { gradient[c] * scale }
    }))
}

/// ∂L/∂q from ∂L/∂(q / ‖q‖): what is along q has no effect. Zero below
/// [`MIN_TRAINED_ROTATION_LENGTH`].
fn unit_backward(q: [f64; 4], gradient: [f64; 4]) -> [f64; 4] {
    let length = quaternion_length(q);
    if length < MIN_TRAINED_ROTATION_LENGTH {
        return [0.0; 4];
    }
    let along: f64 = q.iter().zip(gradient).map(|(q, g)| q / length * g).sum();
    std::array::from_fn(|c| (gradient[c] - along * (q[c] / length)) / length)
}
