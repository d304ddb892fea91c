//! Equal depths and identical splats: one image, bit for bit.

use trapeze_cpu::RendererOptions;
use trapeze_cpu::bin::TileSize;
use trapeze_scene::{Camera, Frame, FrameSettings, NO_SPLAT, Scene, ShDegree};
use trapeze_tests::{
    HeadBiases, Random, Splat, assert_agrees, available_levels, camera_at_origin, cloud,
    cloud_camera, everything, on_threads, render, scene_of, sliding_network,
};

/// Images as bits, so that NaN depths compare too.
fn bits(frame: &Frame) -> Vec<u32> {
    let color = frame.color.iter().flatten().map(|c| c.to_bits());
    let depths = frame.expected_depth.iter().chain(&frame.median_depth).map(|d| d.to_bits());
    color.chain(depths).chain(frame.top_contributor.iter().copied()).collect()
}

/// Renders in every way that must not matter, at every SIMD level, and compares the bits.
fn assert_one_image(scene: &Scene, camera: &Camera, settings: &FrameSettings) {
    for (name, level) in available_levels() {
        let image = |tile: (u32, u32), threads: usize| {
            let tile = TileSize::new(tile.0, tile.1).unwrap();
            let options = RendererOptions { level, tile };
            on_threads(threads, || bits(&render(scene, camera, settings, options)))
        };
        let expected = image((16, 16), 1);
        for (tile, threads) in [
            ((16, 16), 1),
            ((16, 16), 2),
            ((16, 16), 5),
            ((32, 8), 2),
            ((64, 64), 5),
            ((48, 5), 2),
            ((16, 1), 1),
        ] {
            assert!(image(tile, threads) == expected, "{name}, {tile:?}, {threads} threads");
        }
    }
}

/// Planes of equal depth, each splat there twice in two colours.
fn ties() -> Scene {
    let mut scene = cloud(3000, ShDegree::One, 4);
    for position in &mut scene.splats.positions {
        position[2] = 3.0 + (position[2] * 4.0).round() * 0.25;
    }
    let n = scene.len() as u32;
    let order: Vec<u32> = (0..2 * n).map(|i| i % n).collect();
    let mut doubled = scene.gather(&order);
    for dc in &mut doubled.splats.sh_dc[n as usize..] {
        dc.reverse();
    }
    doubled
}

#[test]
fn equal_depths_are_blended_by_index_for_any_threads_tiles_and_level() {
    let (scene, camera) = (ties(), camera_at_origin(113, 87));
    let _ = assert_agrees(&scene, &camera, &everything());
    assert_one_image(&scene, &camera, &everything());
}

#[test]
fn a_cloud_with_a_network_is_one_image_for_any_threads_tiles_and_level() {
    let scene = Scene {
        deformation: Some(sliding_network(&HeadBiases::default())),
        ..cloud(3000, ShDegree::Three, 5)
    };
    let settings = FrameSettings { time: 0.4, ..everything() };
    assert_one_image(&scene, &cloud_camera(113, 87), &settings);
}

#[test]
fn the_same_renderer_gives_the_same_image_again_after_other_frames() {
    let scene = ties();
    let mut renderer = trapeze_cpu::Renderer::new(scene.into());
    let camera = camera_at_origin(113, 87);
    let first = renderer.render(&camera, &everything()).unwrap();
    for size in [(20, 200), (300, 10), (1, 1)] {
        let _ = renderer.render(&camera_at_origin(size.0, size.1), &everything()).unwrap();
        assert_eq!(bits(&renderer.render(&camera, &everything()).unwrap()), bits(&first));
    }
}

#[test]
fn of_identical_splats_the_lower_index_is_in_front() {
    let front = Splat { logit: 1.0, dc: [1.5, -1.5, -1.5], ..Splat::default() };
    let back = Splat { dc: [-1.5, -1.5, 1.5], ..front };
    let camera = camera_at_origin(33, 33);
    for (first, second) in [(front, back), (back, front)] {
        let frame = assert_agrees(&scene_of(&[first, second]), &camera, &everything());
        let [r, _, b, _] = frame.color[16 * 33 + 16];
        assert_eq!(r > b, first == front);
        assert_eq!(frame.top_contributor[16 * 33 + 16], 0);
    }
}

#[test]
fn long_needles_from_far_outside_are_one_image_for_any_tiles() {
    // Centres up to 10⁵ pixels outside the image, where f32 knows 10⁻² px, and needles that reach
    // back into it: which tiles they touch must not be decided more narrowly than which pixels.
    let camera = camera_at_origin(150, 110);
    let mut random = Random::new(15);
    let splats: Vec<Splat> = (0..3000)
        .map(|_| {
            let angle = random.between(0.0, std::f32::consts::TAU);
            let distance = 10f32.powf(random.between(-1.0, 3.0));
            let (sin, cos) = angle.sin_cos();
            // Along the line to the image's centre, give or take.
            let turn = angle + random.signed() * 0.3 / distance.max(1.0);
            Splat {
                position: [cos * distance, sin * distance, random.between(0.9, 1.1)],
                log_scale: [(distance * 0.5).ln(), -9.0, -9.0],
                rotation: [(turn / 2.0).cos(), 0.0, 0.0, (turn / 2.0).sin()],
                logit: random.between(-4.0, 0.0),
                dc: random.vector(1.5),
            }
        })
        .collect();
    let scene = scene_of(&splats);
    let frame = render(&scene, &camera, &everything(), RendererOptions::default());
    let seen = frame.top_contributor.iter().filter(|&&top| top != NO_SPLAT).count();
    assert!(seen > 10_000, "the needles do not reach the image: {seen} pixels");
    assert_one_image(&scene, &camera, &everything());
}
