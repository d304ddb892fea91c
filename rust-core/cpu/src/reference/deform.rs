//! Deformation in f64: the network, and what its outputs do to a splat.
//!
//! # Degenerate values
//!
//! Files and half-trained networks hold anything. Every backend follows these rules:
//!
//! | value | rule |
//! |---|---|
//! | time NaN or infinite | taken as 0; any other number is used as it is, also outside 0–1 |
//! | canonical quaternion of length 0, or with a component that is not finite | identity |
//! | normalise(q) + d_q shorter than [`MIN_ROTATION_NORM`], or not finite | identity |
//! | linear scale + d_s below [`MIN_DEFORMED_SCALE`] | [`MIN_DEFORMED_SCALE`], with zero gradient |
//! | linear scale above [`MAX_SCALE`] | [`MAX_SCALE`] |
//! | linear scale NaN, position NaN or infinite | stays, and the splat is not drawn |
//! | ReLU of NaN | 0 |
//!
//! The floor belongs to the deformation: scenes without a network keep scales down to 0.

use glam::{DMat3, DVec3};
use trapeze_scene::deformation::{Encoding, Linear, PositionHead, RotationRule, TimeNetwork};
use trapeze_scene::{DeformationNetwork, Splats};

use crate::deform::MAX_SCALE;

/// Shortest sum of canonical rotation and delta that still has a direction: a canonical rotation
/// that its delta cancels leaves only rounding noise, about 1e-7 in the f32 backends, and all of
/// them have to see the same cancellation.
pub const MIN_ROTATION_NORM: f64 = 1e-6;

/// A quaternion shorter than this gets no gradient: the derivative of its normalisation grows as
/// 1 / length and would leave the range of f32.
pub const MIN_TRAINED_ROTATION_LENGTH: f64 = 1e-12;

/// Smallest linear scale after its delta, world units.
pub const MIN_DEFORMED_SCALE: f64 = 1e-6;

/// Geometry of one splat, activated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Centre, world units, relative to the scene's origin.
    pub position: [f64; 3],
    /// Quaternion (w, x, y, z) as it enters the covariance: of unit length, except under
    /// [`RotationRule::AsTrained`].
    pub rotation: [f64; 4],
    /// Standard deviations along the local axes, world units.
    pub scale: [f64; 3],
}

/// What the network says about one splat at one time; or a loss's gradient by that.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NetworkOutput {
    /// Added to the position, world units. For [`PositionHead::Screw`] it is the displacement
    /// that the screw motion gives this position.
    pub displacement: [f64; 3],
    /// Added to the normalised quaternion (w, x, y, z).
    pub d_rotation: [f64; 4],
    /// Added to the linear scale, world units.
    pub d_scale: [f64; 3],
}

/// The splat as it is stored, activated: the state in scenes without a network.
///
/// # Panics
/// When there is no splat `i`.
#[must_use]
pub fn canonical_pose(splats: &Splats, i: usize) -> Pose {
    activate(
        splats.positions[i].map(f64::from),
        splats.log_scales[i].map(f64::from),
        splats.rotations[i].map(f64::from),
    )
}

/// Activates stored parameters: a quaternion of unit length, exp of the log-scale.
pub(super) fn activate(position: [f64; 3], log_scale: [f64; 3], rotation: [f64; 4]) -> Pose {
    Pose {
        position,
        rotation: unit_quaternion(rotation),
        scale: log_scale.map(|log| at_most_max_scale(log.exp())),
    }
}

/// The splat at time `t`. The network sees world coordinates: the stored position + `origin`.
///
/// # Panics
/// When there is no splat `i`.
#[must_use]
pub fn deform_splat(
    network: &DeformationNetwork,
    splats: &Splats,
    i: usize,
    origin: DVec3,
    t: f64,
) -> Pose {
    let canonical = canonical_pose(splats, i);
    let world = DVec3::from(canonical.position) + origin;
    let output = evaluate_network(network, world.to_array(), t);
    apply_output(&canonical, &output, network.rotation_rule)
}

/// Adds the network's outputs to a canonical pose.
#[must_use]
pub fn apply_output(canonical: &Pose, output: &NetworkOutput, rule: RotationRule) -> Pose {
    let sum = std::array::from_fn(|c| canonical.rotation[c] + output.d_rotation[c]);
    Pose {
        position: std::array::from_fn(|c| canonical.position[c] + output.displacement[c]),
        rotation: combined_rotation(sum, rule).0,
        scale: std::array::from_fn(|c| deformed_scale(canonical.scale[c] + output.d_scale[c])),
    }
}

/// q / ‖q‖, or the identity where q has no direction.
#[must_use]
pub(crate) fn unit_quaternion(q: [f64; 4]) -> [f64; 4] {
    let length = quaternion_length(q);
    if length > 0.0 { q.map(|c| c / length) } else { [1.0, 0.0, 0.0, 0.0] }
}

/// ‖q‖; 0 where q is not finite, and so has no direction.
#[must_use]
pub(crate) fn quaternion_length(q: [f64; 4]) -> f64 {
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    if length.is_finite() { length } else { 0.0 }
}

/// What enters the covariance, from normalise(q) + d_q, and the length of that sum; 0 where it has
/// no direction.
#[must_use]
pub(crate) fn combined_rotation(sum: [f64; 4], rule: RotationRule) -> ([f64; 4], f64) {
    let length = quaternion_length(sum);
    if length < MIN_ROTATION_NORM {
        return ([1.0, 0.0, 0.0, 0.0], 0.0);
    }
    let rotation = match rule {
        RotationRule::Renormalised => sum.map(|c| c / length),
        RotationRule::AsTrained => sum,
    };
    (rotation, length)
}

/// Floor and ceiling of a scale that a delta was added to; NaN stays.
#[must_use]
pub(crate) fn deformed_scale(scale: f64) -> f64 {
    at_most_max_scale(if scale < MIN_DEFORMED_SCALE { MIN_DEFORMED_SCALE } else { scale })
}

pub(super) fn at_most_max_scale(scale: f64) -> f64 {
    let max = f64::from(MAX_SCALE);
    if scale > max { max } else { scale }
}

/// The time that the network sees.
#[must_use]
fn network_time(t: f64) -> f64 {
    if t.is_finite() { t } else { 0.0 }
}

/// Evaluates the network at a position in world coordinates.
///
/// Input [γ(xyz), γ(t)], or [γ(xyz), time network(γ(t))]; ReLU after every hidden layer; after
/// layer `skip_after` the input is put in front of the hidden vector.
#[must_use]
pub fn evaluate_network(network: &DeformationNetwork, world: [f64; 3], t: f64) -> NetworkOutput {
    let input = network_input(network, world, t);
    let mut h = input.clone();
    for (i, layer) in network.hidden.iter().enumerate() {
        h = linear(layer, &h);
        rectify(&mut h);
        if i == network.skip_after {
            h = [&input[..], &h].concat();
        }
    }
    let displacement = match &network.position_head {
        PositionHead::Translation(warp) => three(&linear(warp, &h)),
        PositionHead::Screw { w, v } => {
            screw_displacement(three(&linear(w, &h)), three(&linear(v, &h)), world)
        }
    };
    let d_rotation = linear(&network.rotation_head, &h);
    NetworkOutput {
        displacement,
        d_rotation: std::array::from_fn(|c| d_rotation[c]),
        d_scale: three(&linear(&network.scale_head, &h)),
    }
}

/// What enters layer 0: [γ(xyz), time features].
pub(super) fn network_input(network: &DeformationNetwork, world: [f64; 3], t: f64) -> Vec<f64> {
    let mut input = vec![0.0; network.position_width()];
    network.position_encoding.encode(&world, &mut input);
    input.extend(time_features(network.time_encoding, network.time_network.as_ref(), t));
    input
}

/// γ of the time that the network sees.
#[must_use]
pub(crate) fn encoded_time(encoding: Encoding, t: f64) -> Vec<f64> {
    let mut encoded = vec![0.0; encoding.width()];
    encoding.encode(&[network_time(t)], &mut encoded);
    encoded
}

/// What enters layer 0 besides the position: γ(t), or the time network's answer to it.
#[must_use]
pub(crate) fn time_features(encoding: Encoding, network: Option<&TimeNetwork>, t: f64) -> Vec<f64> {
    let encoded = encoded_time(encoding, t);
    match network {
        None => encoded,
        Some(net) => {
            let mut hidden = linear(&net.hidden, &encoded);
            rectify(&mut hidden);
            linear(&net.output, &hidden)
        }
    }
}

/// W x + b. Each row is summed in the order of its columns.
///
/// Such a sum is a chain of dependent additions; four rows side by side take the time of one.
pub(super) fn linear(layer: &Linear, x: &[f64]) -> Vec<f64> {
    const ROWS: usize = 4;
    let row = |r: usize| &layer.weight[r * layer.inputs..(r + 1) * layer.inputs];
    let last = layer.outputs - 1;
    let mut y = Vec::with_capacity(layer.outputs);
    for (group, biases) in layer.bias.chunks(ROWS).enumerate() {
        let rows: [&[f32]; ROWS] =
            std::array::from_fn(|r| &row((group * ROWS + r).min(last))[..x.len()]);
        let mut sums = [0.0; ROWS];
        for (i, x) in x.iter().enumerate() {
            for (sum, row) in sums.iter_mut().zip(rows) {
                *sum += f64::from(row[i]) * x;
            }
        }
        y.extend(biases.iter().zip(sums).map(|(&b, sum)| f64::from(b) + sum));
    }
    y
}

/// max(0, x); `f64::max` gives 0 for NaN.
pub(super) fn rectify(h: &mut [f64]) {
    for x in h {
        *x = x.max(0.0);
    }
}

pub(super) fn three(values: &[f64]) -> [f64; 3] {
    std::array::from_fn(|c| values[c])
}

/// Part of every component of a screw's axis and pitch.
pub(super) const UPSTREAM_SCREW_OFFSET: DVec3 = DVec3::splat(1e-5);

/// exp([S] θ) x − x for the screw axis S = (w/θ + 1e-5, v/θ + 1e-5), θ = ‖w‖ (Lynch & Park,
/// "Modern Robotics", eq. 3.88; the 1e-5 is upstream's, and part of what a checkpoint learned).
///
/// Upstream divides by θ and gives NaN for θ = 0. Here θ → 0 has its limit, the translation by v.
/// 1 − cos θ is computed as 2 sin²(θ/2): v/θ would amplify its cancellation.
#[must_use]
pub(crate) fn screw_displacement(w: [f64; 3], v: [f64; 3], x: [f64; 3]) -> [f64; 3] {
    let (w, v) = (DVec3::from(w), DVec3::from(v));
    let theta = w.length();
    if theta < f64::MIN_POSITIVE {
        return v.to_array();
    }
    let axis = w / theta + UPSTREAM_SCREW_OFFSET;
    let pitch = v / theta + UPSTREAM_SCREW_OFFSET;
    let cross = DMat3::from_cols(
        DVec3::new(0.0, axis.z, -axis.y),
        DVec3::new(-axis.z, 0.0, axis.x),
        DVec3::new(axis.y, -axis.x, 0.0),
    );
    let square = cross * cross;
    let (sin, one_minus_cos) = (theta.sin(), 2.0 * (theta / 2.0).sin().powi(2));
    let turned = sin * (cross * DVec3::from(x)) + one_minus_cos * (square * DVec3::from(x));
    let moved = theta * pitch + one_minus_cos * (cross * pitch) + (theta - sin) * (square * pitch);
    (turned + moved).to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// exp of the 4 × 4 matrix [S] θ by its power series, applied to (x, 1).
    fn screw_by_series(w: [f64; 3], v: [f64; 3], x: [f64; 3]) -> [f64; 3] {
        let theta = DVec3::from(w).length();
        let axis = w.map(|c| c / theta + 1e-5);
        let pitch = v.map(|c| c / theta + 1e-5);
        let twist = [
            [0.0, -axis[2], axis[1], pitch[0]],
            [axis[2], 0.0, -axis[0], pitch[1]],
            [-axis[1], axis[0], 0.0, pitch[2]],
            [0.0; 4],
        ];
        let mut term = [x[0], x[1], x[2], 1.0];
        let mut sum = term;
        for n in 1..60 {
            term = std::array::from_fn(|i| {
                (0..4).map(|j| twist[i][j] * term[j]).sum::<f64>() * theta / f64::from(n)
            });
            for (s, t) in sum.iter_mut().zip(term) {
                *s += t;
            }
        }
        std::array::from_fn(|c| sum[c] - x[c])
    }

    #[test]
    fn screw_motion_is_the_matrix_exponential_of_the_twist() {
        let (v, x) = ([0.3, -0.2, 0.9], [1.5, -2.0, 0.7]);
        for w in [[0.4, -0.1, 0.2], [1e-3, 2e-3, 0.0], [2.0, 1.0, -2.0]] {
            let closed = screw_displacement(w, v, x);
            let series = screw_by_series(w, v, x);
            for c in 0..3 {
                // The closed form takes the axis for a unit vector (W³ = −W), and upstream's
                // 1e-5 makes it longer by at most 3e-5: upstream's own error, kept.
                assert!((closed[c] - series[c]).abs() < 3e-4, "{w:?}: {closed:?} {series:?}");
            }
        }
    }

    #[test]
    fn a_screw_without_rotation_is_the_translation_that_small_rotations_approach() {
        let (v, x) = ([0.3, -0.2, 0.9], [1.5, -2.0, 0.7]);
        assert_eq!(screw_displacement([0.0; 3], v, x), v);
        for theta in [1e-6, 1e-9, 1e-100] {
            let near = screw_displacement([theta, 0.0, 0.0], v, x);
            for c in 0..3 {
                assert!((near[c] - v[c]).abs() < 10.0 * theta + 1e-14, "{near:?}");
            }
        }
    }

    #[test]
    fn quaternions_without_direction_become_the_identity() {
        let identity = [1.0, 0.0, 0.0, 0.0];
        for q in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0, 0.0]] {
            assert_eq!(unit_quaternion(q), identity);
        }
        for length in [1e-20, 1.0, 1e20] {
            let q = unit_quaternion([0.0, 3.0 * length, 0.0, 4.0 * length]);
            assert!((q[1] - 0.6).abs() < 1e-15 && (q[3] - 0.8).abs() < 1e-15, "{q:?}");
        }
    }

    #[test]
    fn a_delta_that_cancels_the_rotation_gives_the_identity_under_both_rules() {
        for rule in [RotationRule::Renormalised, RotationRule::AsTrained] {
            for sum in [[0.0; 4], [1e-8; 4], [f64::NAN; 4]] {
                assert_eq!(combined_rotation(sum, rule).0, [1.0, 0.0, 0.0, 0.0]);
            }
        }
        let sum = [0.0, 0.5, 0.0, 0.0];
        assert_eq!(combined_rotation(sum, RotationRule::Renormalised).0, [0.0, 1.0, 0.0, 0.0]);
        assert_eq!(combined_rotation(sum, RotationRule::AsTrained).0, sum);
    }

    #[test]
    fn scales_keep_between_floor_and_ceiling() {
        assert_eq!(deformed_scale(-5.0), MIN_DEFORMED_SCALE);
        assert_eq!(deformed_scale(f64::INFINITY), f64::from(MAX_SCALE));
        assert_eq!(deformed_scale(0.25), 0.25);
        assert!(deformed_scale(f64::NAN).is_nan());
    }
}
