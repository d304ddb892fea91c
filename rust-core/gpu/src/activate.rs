//! From stored parameters to the poses that kernels read: activations, in double precision, once.
//!
//! The rules for degenerate values are those of the f64 reference (`trapeze_cpu::reference`), and
//! a test compares every value with it.

use trapeze_scene::{Scene, sigmoid};

use crate::layout::Pose;

/// Largest linear scale, world units (the reference's `MAX_SCALE`).
const MAX_SCALE: f64 = 1e12;
/// Contributions below this are skipped (the reference's `ALPHA_MIN`).
const ALPHA_MIN: f32 = 1.0 / 255.0;
/// log₂ of the opacity of a splat that is never drawn.
const NEVER_DRAWN: f32 = -1e3;

/// The splats as they are stored, activated.
pub(crate) fn canonical_poses(scene: &Scene) -> Vec<Pose> {
    let splats = &scene.splats;
    (0..splats.len())
        .map(|i| Pose {
            position: splats.positions[i],
            log2_opacity: log2_opacity(splats.opacity_logits[i]),
            rotation: unit_quaternion(splats.rotations[i]),
            scale: splats.log_scales[i].map(linear_scale),
            label: scene.clusters.as_ref().map_or(0, |clusters| clusters.labels[i]),
        })
        .collect()
}

fn log2_opacity(logit: f32) -> f32 {
    let opacity = sigmoid(f64::from(logit));
    if (opacity as f32) < ALPHA_MIN { NEVER_DRAWN } else { opacity.log2() as f32 }
}

fn linear_scale(log_scale: f32) -> f32 {
    let scale = f64::from(log_scale).exp();
    // Not `min`, which would drop a NaN that has to hide the splat.
    (if scale > MAX_SCALE { MAX_SCALE } else { scale }) as f32
}

fn unit_quaternion(q: [f32; 4]) -> [f32; 4] {
    let q = q.map(f64::from);
    let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    if norm.is_finite() && norm > 0.0 { q.map(|c| (c / norm) as f32) } else { [1.0, 0.0, 0.0, 0.0] }
}

#[cfg(test)]
mod tests {
    use trapeze_cpu::deform::Deformed;
    use trapeze_cpu::reference::deform::canonical_pose;
    use trapeze_scene::Splats;

    use super::*;

    #[test]
    fn poses_are_those_of_the_reference() {
        let odd = [
            0.0,
            -0.0,
            1.0,
            -3.0,
            40.0,
            -40.0,
            1e20,
            1e-20,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN_POSITIVE,
        ];
        let n = odd.len() * odd.len();
        let pick = |i: usize| odd[i % odd.len()];
        let other = |i: usize| odd[i / odd.len() % odd.len()];
        let splats = Splats {
            positions: (0..n).map(|i| [pick(i), other(i), 1.0]).collect(),
            log_scales: (0..n).map(|i| [pick(i), other(i), -2.0]).collect(),
            rotations: (0..n).map(|i| [pick(i), 0.5, other(i), -0.25]).collect(),
            opacity_logits: (0..n).map(pick).collect(),
            sh_dc: vec![[0.0; 3]; n],
            ..Splats::default()
        };
        let reference = Deformed::from_static(&splats);
        let ours = canonical_poses(&Scene::from_splats(splats.clone()));
        let same = |a: f32, b: f32| a == b || (a.is_nan() && b.is_nan());
        for (i, pose) in ours.iter().enumerate() {
            let expected = reference.pose(i);
            assert!((0..3).all(|c| same(pose.position[c], expected.position[c])), "{i}");
            assert!((0..4).all(|c| same(pose.rotation[c], expected.rotation[c])), "{i}");
            assert!((0..3).all(|c| same(pose.scale[c], expected.scale[c])), "{i}");
            let exact = canonical_pose(&splats, i);
            assert_eq!(exact.scale[0].is_nan(), pose.scale[0].is_nan());
        }
    }

    #[test]
    fn opacities_below_one_255th_are_never_drawn() {
        let logit = |opacity: f64| (opacity / (1.0 - opacity)).ln() as f32;
        assert_eq!(log2_opacity(logit(0.999 / 255.0)), NEVER_DRAWN);
        assert!((log2_opacity(logit(1.001 / 255.0)) + 255f32.log2()).abs() < 2e-3);
        assert_eq!(log2_opacity(f32::NAN), NEVER_DRAWN);
        assert_eq!(log2_opacity(f32::INFINITY), 0.0);
    }
}
