//! What the CPU renderer answers to a frame's request: SIMD levels, depth and top contributor,
//! picking, selection, colour sources, masks.

use std::sync::Arc;

use trapeze_cpu::reference;
use trapeze_cpu::{Renderer, RendererOptions};
use trapeze_scene::{
    Clusters, ColorSource, DepthRange, Frame, FrameSettings, Motion, NO_SPLAT, Scene, Selection,
    ShDegree, motion_heat,
};
use trapeze_tests::{
    HeadBiases, Random, Splat, TOLERANCE, assert_agrees, assert_same_color, available_levels,
    camera_at_origin, cloud, cloud_camera, compare, everything, render, scene_of, sliding_network,
};

/// A cloud that moves, in six clusters with scattered ids.
fn clustered(n: usize, seed: u64) -> Scene {
    let ids: Vec<u32> = (0..n).map(|i| [9, 4_000_000_000, 0, 77, 12, 500][i % 6]).collect();
    let colors: Vec<[f32; 3]> = ids.iter().map(|&id| Clusters::palette(id % 101)).collect();
    let mut random = Random::new(seed);
    Scene {
        deformation: Some(sliding_network(&HeadBiases {
            position: [0.0, 0.05, 0.0],
            ..HeadBiases::default()
        })),
        clusters: Some(Clusters::from_ids(&ids, &colors).unwrap()),
        motion: Some(Motion {
            values: (0..n).map(|_| random.between(0.0, 1.0)).collect(),
            ..Motion::default()
        }),
        ..cloud(n, ShDegree::Three, seed)
    }
}

#[test]
fn every_simd_level_agrees_with_the_reference() {
    let scene = clustered(4000, 20);
    let camera = cloud_camera(150, 110);
    let settings = FrameSettings { time: 0.6, ..everything() };
    let exact = reference::render(&scene, &camera, &settings);
    let levels = available_levels();
    assert_eq!(levels.last().unwrap().0, "scalar");
    for (name, level) in levels {
        let options = RendererOptions { level, ..RendererOptions::default() };
        let frame = render(&scene, &camera, &settings, options);
        let comparison = compare(&frame, &exact, TOLERANCE);
        // A cloud of round splats is well-conditioned: fifty times better than what is promised.
        assert!(comparison.agrees(TOLERANCE) && comparison.worst < 4e-5, "{name}: {comparison:?}");
    }
}

/// Pixels of the two depth images that are not within 1e-4 (relative), or not NaN together.
fn differing(ours: &[f32], exact: &[f64]) -> usize {
    assert_eq!(ours.len(), exact.len());
    ours.iter()
        .zip(exact)
        .filter(|&(&a, &b)| {
            let close = (f64::from(a) - b).abs() <= 1e-4 * b;
            let both_nan = a.is_nan() && b.is_nan();
            !(close || both_nan)
        })
        .count()
}

#[test]
fn depths_and_top_contributors_agree_with_the_reference() {
    let scene = clustered(4000, 21);
    let camera = cloud_camera(150, 110);
    let settings = FrameSettings { time: 0.3, ..everything() };
    let exact = reference::render(&scene, &camera, &settings);
    let frame = render(&scene, &camera, &settings, RendererOptions::default());
    // A pixel flips where α meets 1/255, T meets ½, or two weights are equal, each to about 1e-5:
    // with some 20 contributors to a pixel, a few pixels of the 16 500.
    assert!(differing(&frame.expected_depth, &exact.expected_depth) <= 2);
    assert!(differing(&frame.median_depth, &exact.median_depth) <= 2);
    let pairs = frame.top_contributor.iter().zip(&exact.top_contributor);
    assert!(pairs.filter(|(a, b)| a != b).count() <= 4);
}

#[test]
fn images_that_are_not_asked_for_are_empty_and_do_not_change_the_others() {
    let scene = Arc::new(clustered(1000, 22));
    let camera = cloud_camera(70, 50);
    let mut renderer = Renderer::new(scene);
    let full = renderer.render(&camera, &everything()).unwrap();
    for (depth, top_contributor) in [(false, false), (true, false), (false, true)] {
        let settings = FrameSettings { depth, top_contributor, ..FrameSettings::default() };
        let frame = renderer.render(&camera, &settings).unwrap();
        assert_same_color(&frame, &full, &(depth, top_contributor));
        assert_eq!(frame.expected_depth.is_empty(), !depth);
        assert_eq!(frame.median_depth.is_empty(), !depth);
        assert_eq!(frame.top_contributor.is_empty(), !top_contributor);
    }
}

#[test]
fn a_picked_pixel_holds_what_the_whole_frame_shows_there() {
    let scene = Arc::new(clustered(3000, 23));
    let camera = cloud_camera(150, 110);
    let mut renderer = Renderer::new(scene.clone());
    let hide = Selection::Hide([1].into_iter().collect());
    for selection in [Selection::All, hide] {
        let settings = FrameSettings { time: 0.5, selection, ..everything() };
        let frame = renderer.render(&camera, &settings).unwrap();
        let mut random = Random::new(24);
        let mut disagreeing = 0;
        for _ in 0..150 {
            let (x, y) = (random.below(150), random.below(110));
            let pixel = y * 150 + x;
            let pick = renderer.pick(&camera, &settings, (x as u32, y as u32)).unwrap();
            let Some(pick) = pick else {
                assert_eq!(frame.top_contributor[pixel], NO_SPLAT);
                continue;
            };
            let median = frame.median_depth[pixel];
            let depth = if median.is_nan() { frame.expected_depth[pixel] } else { median };
            let same = pick.splat == frame.top_contributor[pixel]
                && (pick.depth / depth - 1.0).abs() < 1e-5;
            disagreeing += usize::from(!same);
            let label = scene.clusters.as_ref().unwrap().labels[pick.splat as usize];
            assert_eq!(pick.cluster, Some(label));
            assert!(settings.selection.shows(label));
        }
        // The picked pixel is moved to the corner of a tiny image, which rounds the centres once
        // more: two equal weights may swap.
        assert!(disagreeing <= 1, "{disagreeing} of 150");
    }
}

#[test]
fn a_pick_does_not_disturb_the_next_frame() {
    let mut renderer = Renderer::new(Arc::new(clustered(1000, 25)));
    let camera = cloud_camera(70, 50);
    let settings = FrameSettings { time: 0.2, ..FrameSettings::default() };
    let before = renderer.render(&camera, &settings).unwrap();
    let elsewhere = FrameSettings { time: 0.9, static_threshold: Some(0.3), ..settings.clone() };
    renderer.pick(&camera, &elsewhere, (30, 20)).unwrap();
    let after = renderer.render(&camera, &settings).unwrap();
    assert_same_color(&after, &before, "after a pick");
}

#[test]
fn isolating_clusters_shows_the_scene_that_holds_only_them() {
    let scene = clustered(2000, 26);
    let camera = cloud_camera(90, 70);
    let clusters = scene.clusters.clone().unwrap();
    let chosen = [1, 4];
    let kept: Vec<u32> =
        (0..2000).filter(|&i| chosen.contains(&clusters.labels[i as usize])).collect();
    let settings = |selection| FrameSettings { time: 0.4, selection, ..everything() };
    let only = render(
        &scene.gather(&kept),
        &camera,
        &settings(Selection::All),
        RendererOptions::default(),
    );
    let isolated = Selection::Isolate(chosen.into_iter().collect());
    let frame = assert_agrees(&scene, &camera, &settings(isolated));
    assert_same_color(&frame, &only, "isolated");
    // Hiding all the others is the same.
    let others = (0..clusters.table.len() as u32).filter(|label| !chosen.contains(label));
    let frame = assert_agrees(&scene, &camera, &settings(Selection::Hide(others.collect())));
    assert_same_color(&frame, &only, "others hidden");
    // Indices are those of the whole scene.
    let shown = frame.top_contributor.iter().filter(|&&top| top != NO_SPLAT);
    assert!(shown.clone().count() > 100);
    assert!(shown.into_iter().all(|top| kept.binary_search(top).is_ok()));
}

#[test]
fn isolating_nothing_is_empty_and_hiding_nothing_is_everything() {
    let scene = clustered(800, 27);
    let camera = cloud_camera(60, 45);
    let image = |selection| {
        let settings = FrameSettings { selection, ..FrameSettings::default() };
        render(&scene, &camera, &settings, RendererOptions::default())
    };
    let none = trapeze_scene::ClusterSet::default();
    let empty = image(Selection::Isolate(none.clone()));
    assert!(empty.color.iter().flatten().all(|&c| c == 0.0));
    let all = image(Selection::All);
    assert_same_color(&image(Selection::Hide(none)), &all, "nothing hidden");
    let unknown = Selection::Hide([999].into_iter().collect());
    assert_same_color(&image(unknown), &all, "a label that no cluster has");
}

#[test]
fn a_scene_without_clusters_ignores_the_selection() {
    let scene = cloud(500, ShDegree::Zero, 28);
    let camera = cloud_camera(60, 45);
    let selection = Selection::Isolate([3].into_iter().collect());
    let settings = FrameSettings { selection, ..everything() };
    let frame = assert_agrees(&scene, &camera, &settings);
    let all = assert_agrees(&scene, &camera, &everything());
    assert_same_color(&frame, &all, "without clusters");
}

/// The colour in the middle of an opaque splat in front of everything.
fn centre_color(scene: &Scene, color_source: ColorSource) -> [f32; 3] {
    let settings = FrameSettings { color_source, ..everything() };
    let frame = assert_agrees(scene, &camera_at_origin(33, 33), &settings);
    let [r, g, b, a] = frame.color[16 * 33 + 16];
    [r / a, g / a, b / a]
}

fn assert_close(found: [f32; 3], expected: [f32; 3]) {
    assert!(
        found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5),
        "{found:?} {expected:?}"
    );
}

#[test]
fn colours_that_are_not_harmonics_are_those_of_table_heat_map_and_range() {
    let depths = ColorSource::Depth(DepthRange { near: 3.0, far: 5.0 });
    for (source, seed) in [(ColorSource::Clusters, 29), (ColorSource::Motion, 30), (depths, 31)] {
        let settings = FrameSettings { color_source: source, time: 0.3, ..everything() };
        let _ = assert_agrees(&clustered(2000, seed), &cloud_camera(90, 70), &settings);
    }
    // One opaque splat, and ninety-nine behind the camera that set the heat map's reference.
    let front = Splat { logit: 20.0, ..Splat::default() };
    let mut splats = vec![Splat { position: [0.0, 0.0, -5.0], ..front }; 100];
    splats[0] = front;
    let mut scene = scene_of(&splats);
    assert_close(centre_color(&scene, ColorSource::Clusters), [0.5; 3]);
    assert_close(centre_color(&scene, ColorSource::Motion), motion_heat(0.0));
    scene.clusters = Some(Clusters::from_ids(&[3; 100], &[[0.2, 0.6, 0.9]; 100]).unwrap());
    assert_close(centre_color(&scene, ColorSource::Clusters), [0.2, 0.6, 0.9]);
    let mut values = vec![2.0; 100];
    values[0] = 0.5;
    scene.motion = Some(Motion { values, ..Motion::default() });
    assert_close(centre_color(&scene, ColorSource::Motion), motion_heat(0.25));
}

#[test]
fn motion_values_that_are_not_numbers_are_drawn_as_the_fastest() {
    let mut scene = scene_of(&[Splat { logit: 20.0, ..Splat::default() }]);
    for value in [f32::NAN, f32::INFINITY] {
        scene.motion = Some(Motion { values: vec![value], ..Motion::default() });
        assert_close(centre_color(&scene, ColorSource::Motion), motion_heat(1.0));
    }
}

/// The image of a masked frame.
fn masked(renderer: &mut Renderer, time: f32, static_threshold: Option<f32>) -> Frame {
    let settings = FrameSettings { time, static_threshold, ..FrameSettings::default() };
    renderer.render(&cloud_camera(90, 70), &settings).unwrap()
}

#[test]
fn static_splats_hold_their_state_at_zero_whatever_was_rendered_before() {
    let scene = Arc::new(clustered(2000, 31));
    let fresh = |time, threshold| masked(&mut Renderer::new(scene.clone()), time, threshold);
    let mut used = Renderer::new(scene.clone());
    let frames = [
        (0.9, None),
        (0.7, Some(0.5)),
        (0.7, Some(0.2)),
        (0.1, Some(0.2)),
        (1.0, None),
        (0.7, Some(0.5)),
        (0.7, Some(f32::NAN)),
        (0.0, Some(0.5)),
        (0.4, Some(-1.0)),
    ];
    for (time, threshold) in frames {
        let (after, alone) = (masked(&mut used, time, threshold), fresh(time, threshold));
        assert_same_color(&after, &alone, &(time, threshold));
        let settings = FrameSettings { time, static_threshold: threshold, ..everything() };
        let _ = assert_agrees(&scene, &cloud_camera(90, 70), &settings);
    }
    let zero = fresh(0.0, None);
    assert_same_color(&fresh(0.8, Some(1.0)), &zero, "all static: the state at t = 0");
    assert_same_color(&fresh(0.8, Some(-1.0)), &fresh(0.8, None), "none static");
    assert!(fresh(0.8, Some(0.5)).color != zero.color);
    // t = 0 is the deformed state, not the stored one.
    let stored = Scene { deformation: None, ..(*scene).clone() };
    let stored = masked(&mut Renderer::new(Arc::new(stored)), 0.0, None);
    assert!(zero.color != stored.color);
}
