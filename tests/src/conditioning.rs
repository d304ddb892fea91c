//! How much of a scene's image f32 can know.

use trapeze_cpu::reference::{LOW_PASS, Projection, pose_scene};
use trapeze_scene::{Camera, FrameSettings, Scene};

/// Bound on |Δ| of a pixel (values up to 1) that rounding of the inputs to f32 already causes.
///
/// f32 knows a splat's centre on the image to ε·|centre| pixels, and the axes of its ellipse to
/// ε times the length ℓ of the longest row of J W R S without foreshortening. A shift δ of an
/// edge whose profile is exp(−x²/2σ²) changes α by at most 0.61 δ/σ, with σ the ellipse's smaller
/// deviation; at the rim, 3.3 deviations out along the long axis, the axes' error is 3.3 ε ℓ. `OPERATIONS` counts the
/// roundings on the way. Splats add up.
#[must_use]
pub fn rounding_bound(scene: &Scene, camera: &Camera, settings: &FrameSettings) -> f64 {
    const OPERATIONS: f64 = 8.0;
    const EPSILON: f64 = f32::EPSILON as f64 / 2.0;
    let camera = camera.relative_to(scene.origin);
    let projection = Projection::new(&camera);
    let image = f64::from(camera.width.max(camera.height));
    pose_scene(scene, &camera, settings)
        .iter()
        .filter_map(|posed| projection.project(posed).map(|projected| (posed, projected)))
        .filter(|(_, splat)| {
            let half = splat.half_extent();
            let reaches =
                |c: f64, half: f64, size: u32| c + half > 0.0 && c - half < f64::from(size);
            reaches(splat.centre.x, half.x, camera.width)
                && reaches(splat.centre.y, half.y, camera.height)
        })
        .map(|(posed, splat)| {
            let [xx, xy, yy] = splat.covariance;
            // The smaller eigenvalue, as determinant over larger one: nothing cancels. The
            // determinant is read off the conic, whose first entry is Σ'yy / |Σ'|.
            let larger = 0.5 * (xx + yy) + (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
            let smaller = (yy / splat.conic[0] / larger).clamp(LOW_PASS, larger);
            let gain = camera.fx.max(camera.fy) / splat.depth;
            let length = gain * posed.scale.max_element() * 2.0;
            let shift = splat.centre.abs().max_element() + image + 3.3 * length;
            (0.61 * OPERATIONS * EPSILON * shift / smaller.sqrt()).min(1.0)
        })
        .sum()
}
