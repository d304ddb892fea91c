//! Equal depths and identical splats: one image, bit for bit.

use trapeze_cpu::RendererOptions;
use trapeze_cpu::bin::TileSize;
use trapeze_scene::{Camera, Frame, FrameSettings, Scene, ShDegree};
use trapeze_tests::{
    HeadBiases, Splat, assert_agrees, available_levels, camera_at_origin, cloud, cloud_camera,
    everything, on_threads, render, scene_of, sliding_network,
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
