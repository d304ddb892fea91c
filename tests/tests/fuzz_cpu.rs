//! Scenes with poison in any field: the image is finite, independent of the tile size, and agrees
//! with the reference as far as f32 can know the scene.

mod poison;

use trapeze_cpu::RendererOptions;
use trapeze_cpu::bin::TileSize;
use trapeze_cpu::reference;
use trapeze_scene::FrameSettings;
use trapeze_tests::{
    Random, TOLERANCE, assert_same_color, compare, everything, render, rounding_bound,
};

use poison::{POISON, any_camera, poisoned_scene};

const SCENES: u64 = 300;

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
