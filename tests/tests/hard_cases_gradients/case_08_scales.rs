//! Scenes from a tenth of a millimetre to ten kilometres.

use glam::DVec3;
use trapeze_scene::{Camera, FrameSettings, ShDegree};
use trapeze_tests::{GRADIENT_TOLERANCE, assert_gradients_agree, cloud};

#[test]
fn gradients_follow_the_specification_at_every_scale() {
    // Smaller scenes would end before the near plane.
    for scale in [0.1f32, 1.0, 1e2, 1e4] {
        let mut scene = cloud(150, ShDegree::Two, 4);
        for position in &mut scene.splats.positions {
            *position = position.map(|c| c * scale);
        }
        for log_scale in scene.splats.log_scales.as_flattened_mut() {
            *log_scale += scale.ln();
        }
        let eye = DVec3::new(1.9, -1.3, -3.1) * f64::from(scale);
        let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::NEG_Y, 0.75, (80, 60));
        assert_gradients_agree(&scene, &camera, &FrameSettings::default(), GRADIENT_TOLERANCE);
    }
}
