//! Scenes with poison in any field, on the GPU against the CPU renderer and the reference.

mod poison;

use trapeze_cpu::{RendererOptions, reference};
use trapeze_gpu::DeviceProfile;
use trapeze_scene::FrameSettings;
use trapeze_tests::{
    Random, TOLERANCE, assert_finite, assert_same_color, compare, everything, gpu, render,
    render_gpu, rounding_bound,
};

use poison::{POISON, any_camera, poisoned_scene};

const SCENES: u64 = 200;

#[test]
fn poisoned_scenes_give_finite_images_that_agree_with_the_reference_and_the_cpu() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    let mut compared = 0;
    for seed in 1000..1000 + SCENES {
        let mut random = Random::new(seed);
        let scene = poisoned_scene(&mut random, seed);
        let camera = any_camera(&mut random);
        let time = if random.below(5) == 0 { random.choose(&POISON) } else { random.signed() };
        let settings = FrameSettings { time, ..everything() };

        let frame = render_gpu(&gpu, &scene, &camera, &settings);
        assert_finite(&frame);
        if seed % 8 == 0 {
            let again = render_gpu(&gpu, &scene, &camera, &settings);
            assert_same_color(&frame, &again, &("two runs differ", seed));
        }
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
        let cpu = render(&scene, &camera, &settings, RendererOptions::default());
        assert!(
            comparison.agrees(tolerance),
            "scene {seed}, tolerance {tolerance}: {comparison:?}: {:?}, CPU {:?}, reference {:?}",
            frame.color[at],
            cpu.color[at],
            exact.color[at],
        );
    }
    println!("{compared} of {SCENES} compared");
    assert!(compared >= SCENES as usize / 2, "only {compared} scenes could be compared");
}
