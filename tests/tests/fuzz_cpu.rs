//! Scenes with poison in any field: the image is finite, independent of the tile size, and agrees
//! with the reference as far as f32 can know the scene.

use trapeze_cpu::RendererOptions;
use trapeze_cpu::bin::TileSize;
use trapeze_cpu::reference;
use trapeze_scene::{Camera, FrameSettings, Scene, ShDegree};
use trapeze_tests::{
    HeadBiases, Random, TOLERANCE, assert_same_color, cloud, cloud_camera, compare,
    constant_network, everything, render, rounding_bound, sliding_network,
};

const SCENES: u64 = 300;

const POISON: [f32; 18] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-40,
    -1e-40,
    0.0,
    -0.0,
    1e30,
    -1e30,
    1e20,
    -1e12,
    1e7,
    -1e4,
    88.0,
    -104.0,
];

/// Overwrites one random component.
fn spoil(random: &mut Random, components: &mut [f32]) {
    if !components.is_empty() {
        components[random.below(components.len())] = random.choose(&POISON);
    }
}

/// A small cloud in which one splat in four has one to three poisoned components.
fn poisoned_scene(random: &mut Random, seed: u64) -> Scene {
    let degree = random.choose(&ShDegree::ALL);
    let mut scene = cloud(1 + random.below(60), degree, seed);
    let splats = &mut scene.splats;
    let stride = splats.sh_rest_stride();
    for i in 0..splats.len() {
        if random.below(4) != 0 {
            continue;
        }
        for _ in 0..=random.below(3) {
            match random.below(6) {
                0 => spoil(random, &mut splats.positions[i]),
                1 => spoil(random, &mut splats.log_scales[i]),
                2 => spoil(random, &mut splats.rotations[i]),
                3 => spoil(random, &mut splats.opacity_logits[i..=i]),
                4 => spoil(random, &mut splats.sh_dc[i]),
                _ => spoil(random, &mut splats.sh_rest[i * stride..(i + 1) * stride]),
            }
        }
    }
    scene.deformation = match random.below(4) {
        0 => Some(sliding_network(&HeadBiases::default())),
        1 => {
            let mut biases = HeadBiases::default();
            match random.below(3) {
                0 => spoil(random, &mut biases.position),
                1 => spoil(random, &mut biases.rotation),
                _ => spoil(random, &mut biases.scale),
            }
            Some(constant_network(&biases))
        }
        _ => None,
    };
    scene
}

/// A camera around the cloud, sometimes inside it, in a small odd frame.
fn any_camera(random: &mut Random) -> Camera {
    let mut camera = cloud_camera(20 + random.below(40) as u32, 15 + random.below(40) as u32);
    let nearer = random.between(-3.6, 1.0);
    camera.world_to_camera.w_axis.z += f64::from(nearer);
    camera
}

#[test]
fn poisoned_scenes_give_finite_images_that_agree_with_the_reference() {
    let mut compared = 0;
    for seed in 0..SCENES {
        let mut random = Random::new(seed);
        let scene = poisoned_scene(&mut random, seed);
        let camera = any_camera(&mut random);
        let time = if random.below(5) == 0 { random.choose(&POISON) } else { random.signed() };
        let settings = FrameSettings { time, ..everything() };

        let frame = render(&scene, &camera, &settings, RendererOptions::default());
        let other_tiles =
            RendererOptions { tile: TileSize::new(64, 3).unwrap(), ..RendererOptions::default() };
        let other = render(&scene, &camera, &settings, other_tiles);
        assert_same_color(&frame, &other, &("the tile size shows", seed));

        // What rounding the inputs alone may do. Where that is everything, there is nothing left
        // to compare.
        let tolerance = TOLERANCE + rounding_bound(&scene, &camera, &settings);
        if tolerance > 0.05 {
            continue;
        }
        compared += 1;
        let exact = reference::render(&scene, &camera, &settings);
        let comparison = compare(&frame, &exact, tolerance);
        let at = comparison.worst_pixel;
        assert!(
            comparison.agrees(tolerance),
            "scene {seed}, tolerance {tolerance}: {comparison:?}: {:?}, reference {:?}",
            frame.color[at],
            exact.color[at],
        );
    }
    println!("{compared} of {SCENES} compared");
    assert!(compared >= 150, "only {compared} scenes were well enough conditioned to compare");
}
