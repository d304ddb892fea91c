//! Frames and scenes of every size.

use trapeze_scene::{FrameSettings, ShDegree, Splats};
use trapeze_tests::{
    GRADIENT_TOLERANCE, Random, Splat, assert_gradients_agree, camera_at_origin, cloud,
    cloud_camera, gradients, scene_of,
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
    assert!(none.iter().all(Splats::is_empty));
    let one = scene_of(&[Splat { position: [0.0; 3], ..Splat::default() }]);
    assert_gradients_agree(&one, &camera, &FrameSettings::default(), GRADIENT_TOLERANCE);
}

#[test]
fn a_tile_with_tens_of_thousands_of_splats_follows_the_specification() {
    // Some thousand on each pixel, and more in the tile than a loop of a software device turns.
    let mut random = Random::new(31);
    let splats: Vec<Splat> = (0..70_000)
        .map(|_| Splat {
            position: [random.signed() * 0.8, random.signed() * 0.8, random.between(1.9, 2.1)],
            log_scale: [-6.0; 3],
            logit: random.between(-5.3, -4.5),
            dc: random.vector(1.5),
            ..Splat::default()
        })
        .collect();
    let camera = camera_at_origin(16, 16);
    // Every pixel is a product of a thousand factors 1 − α, each rounded.
    assert_gradients_agree(&scene_of(&splats), &camera, &FrameSettings::default(), 1e-3);
}
