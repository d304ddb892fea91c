//! Scenes that move: gradients through the pose at any time.

use trapeze_scene::{FrameSettings, Scene, ShDegree};
use trapeze_tests::{
    GRADIENT_TOLERANCE, HeadBiases, assert_gradients_agree, cloud, cloud_camera, sliding_network,
};

fn moving(biases: &HeadBiases) -> Scene {
    Scene { deformation: Some(sliding_network(biases)), ..cloud(80, ShDegree::One, 6) }
}

#[test]
fn gradients_go_through_the_pose_at_any_time() {
    let biases =
        HeadBiases { rotation: [0.2, -0.3, 0.1, 0.4], scale: [0.01; 3], ..HeadBiases::default() };
    for time in [0.0, 0.5, 7.0, -3.0, f32::NAN, f32::INFINITY] {
        let settings = FrameSettings { time, ..FrameSettings::default() };
        let camera = cloud_camera(64, 48);
        assert_gradients_agree(&moving(&biases), &camera, &settings, GRADIENT_TOLERANCE);
    }
}

#[test]
fn scales_on_their_floor_get_no_gradient() {
    let biases = HeadBiases { scale: [-100.0, 0.0, 0.0], ..HeadBiases::default() };
    let settings = FrameSettings::default();
    let found = assert_gradients_agree(
        &moving(&biases),
        &cloud_camera(64, 48),
        &settings,
        GRADIENT_TOLERANCE,
    );
    for found in found {
        assert!(found.log_scales.iter().all(|g| g[0] == 0.0));
        assert!(found.log_scales.iter().any(|g| g[1] != 0.0));
    }
}
