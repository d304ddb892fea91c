//! Frames and scenes of every size.

use trapeze_scene::{FrameSettings, ShDegree};
use trapeze_tests::{
    GRADIENT_TOLERANCE, Splat, assert_gradients_agree, cloud, cloud_camera, gradients, scene_of,
};

#[test]
fn frames_of_any_size_follow_the_specification() {
    let scene = cloud(120, ShDegree::One, 9);
    for (width, height) in [(1, 1), (17, 3), (3, 41), (64, 64), (257, 31)] {
        let camera = cloud_camera(width, height);
        assert_gradients_agree(&scene, &camera, &FrameSettings::default(), GRADIENT_TOLERANCE);
    }
}

#[test]
fn no_splats_and_one_splat_are_scenes_too() {
    let camera = cloud_camera(20, 10);
    let none = gradients(&scene_of(&[]), &camera, &FrameSettings::default());
    assert!(none.is_empty());
    let one = scene_of(&[Splat { position: [0.0; 3], ..Splat::default() }]);
    assert_gradients_agree(&one, &camera, &FrameSettings::default(), GRADIENT_TOLERANCE);
}
