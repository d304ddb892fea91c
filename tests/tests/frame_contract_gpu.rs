//! What the GPU renderer answers to a frame's request, and what it does to answer: the same frames
//! as the CPU, the same frame twice, growth, weak devices, and steady frames that create nothing.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use trapeze_cpu::{RendererOptions as CpuOptions, reference};
use trapeze_gpu::{
    Created, DeviceProfile, Gpu, GpuError, GpuOptions, HarmonicsStorage, NetworkPrecision,
    Renderer, RendererOptions,
};
use trapeze_scene::{
    Camera, ClusterSet, Clusters, ColorSource, DepthRange, Frame, FrameSettings, Motion, NO_SPLAT,
    Scene, Selection, ShDegree, psnr,
};
use trapeze_tests::{
    HeadBiases, Random, TOLERANCE, assert_agrees, assert_finite, assert_same_color,
    camera_at_origin, cloud, cloud_camera, compare, everything, gpu, render, render_gpu, scene_of,
    sliding_network,
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

fn set(labels: &[u32]) -> ClusterSet {
    labels.iter().copied().collect()
}

/// Images as bits, so that NaN depths compare too.
fn bits(frame: &Frame) -> Vec<u32> {
    let color = frame.color.iter().flatten().map(|c| c.to_bits());
    let depths = frame.expected_depth.iter().chain(&frame.median_depth).map(|d| d.to_bits());
    color.chain(depths).chain(frame.top_contributor.iter().copied()).collect()
}

/// Some of the cloud is nearer, some of it farther.
const CLOUD_DEPTHS: DepthRange = DepthRange { near: 3.0, far: 5.0 };

/// Requests that differ in everything that may change from frame to frame.
fn requests() -> Vec<FrameSettings> {
    let base = FrameSettings { time: 0.6, ..everything() };
    vec![
        base.clone(),
        FrameSettings { time: -2.5, ..base.clone() },
        FrameSettings { static_threshold: Some(0.5), ..base.clone() },
        FrameSettings { static_threshold: Some(0.5), time: 0.2, ..base.clone() },
        FrameSettings { static_threshold: Some(2.0), ..base.clone() },
        FrameSettings { static_threshold: Some(f32::NAN), ..base.clone() },
        FrameSettings { max_sh_degree: ShDegree::One, ..base.clone() },
        FrameSettings { selection: Selection::Hide(set(&[1, 3])), ..base.clone() },
        FrameSettings { selection: Selection::Isolate(set(&[0, 999])), ..base.clone() },
        FrameSettings { selection: Selection::Isolate(set(&[])), ..base.clone() },
        FrameSettings { color_source: ColorSource::Clusters, ..base.clone() },
        FrameSettings { color_source: ColorSource::Motion, ..base.clone() },
        FrameSettings { color_source: ColorSource::Depth(CLOUD_DEPTHS), ..base.clone() },
        FrameSettings { depth: false, top_contributor: false, ..base },
    ]
}

/// Checks every request against the reference, on one renderer.
fn assert_requests(gpu: &Gpu, scene: &Scene, camera: &Camera) {
    let mut renderer = Renderer::new(gpu, Arc::new(scene.clone())).unwrap();
    for settings in requests() {
        let frame = renderer.render(camera, &settings).unwrap();
        assert_finite(&frame);
        let exact = reference::render(scene, camera, &settings);
        let comparison = compare(&frame, &exact, TOLERANCE);
        assert!(comparison.agrees(TOLERANCE), "{settings:?}: {comparison:?}");
        let quality = psnr(&frame.color, &exact.to_frame().color);
        assert!(quality >= 60.0, "{settings:?}: {quality} dB");
    }
}

#[test]
fn every_request_agrees_with_the_reference_on_every_kind_of_device() {
    let (scene, camera) = (clustered(3000, 40), cloud_camera(150, 110));
    for profile in [DeviceProfile::Full, DeviceProfile::Apple, DeviceProfile::Weak] {
        let Some(gpu) = gpu(profile) else { return };
        assert_requests(&gpu, &scene, &camera);
    }
}

/// Pixels of two depth images that are not within 1e-4 (relative), or not NaN together.
fn differing(ours: &[f32], exact: &[f64]) -> usize {
    assert_eq!(ours.len(), exact.len());
    let same = |a: f32, b: f64| (f64::from(a) - b).abs() <= 1e-4 * b || (a.is_nan() && b.is_nan());
    ours.iter().zip(exact).filter(|&(&a, &b)| !same(a, b)).count()
}

#[test]
fn depths_and_top_contributors_agree_with_the_reference() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    let (scene, camera) = (clustered(4000, 41), cloud_camera(150, 110));
    let settings = FrameSettings { time: 0.3, ..everything() };
    let exact = reference::render(&scene, &camera, &settings);
    let frame = render_gpu(&gpu, &scene, &camera, &settings);
    // As on the CPU: a pixel flips where α meets 1/255, T meets ½, or two weights are equal.
    assert!(differing(&frame.expected_depth, &exact.expected_depth) <= 2);
    assert!(differing(&frame.median_depth, &exact.median_depth) <= 2);
    let pairs = frame.top_contributor.iter().zip(&exact.top_contributor);
    assert!(pairs.filter(|(a, b)| a != b).count() <= 4);
}

#[test]
fn the_same_frame_is_the_same_bits_again() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    // Planes of equal depth, every splat twice.
    let mut scene = cloud(2000, ShDegree::One, 42);
    for position in &mut scene.splats.positions {
        position[2] = 3.0 + (position[2] * 4.0).round() * 0.25;
    }
    let twice: Vec<u32> = (0..4000).map(|i| i % 2000).collect();
    let scene = Arc::new(scene.gather(&twice));
    let camera = camera_at_origin(113, 87);
    let first = bits(&render_gpu(&gpu, &scene, &camera, &everything()));
    let mut renderer = Renderer::new(&gpu, scene).unwrap();
    for size in [(20, 200), (300, 10), (1, 1), (113, 87)] {
        let other = renderer.render(&camera_at_origin(size.0, size.1), &everything()).unwrap();
        assert_finite(&other);
        assert!(bits(&renderer.render(&camera, &everything()).unwrap()) == first, "{size:?}");
    }
}

#[test]
fn a_picked_pixel_holds_what_the_whole_frame_shows_there() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    let scene = Arc::new(clustered(3000, 43));
    let camera = cloud_camera(150, 110);
    let mut renderer = Renderer::new(&gpu, scene.clone()).unwrap();
    for selection in [Selection::All, Selection::Hide(set(&[1]))] {
        let settings = FrameSettings { time: 0.5, selection, ..everything() };
        let frame = renderer.render(&camera, &settings).unwrap();
        let mut random = Random::new(44);
        for _ in 0..40 {
            let (x, y) = (random.below(150), random.below(110));
            let pixel = y * 150 + x;
            let pick = renderer.pick(&camera, &settings, (x as u32, y as u32)).unwrap();
            let Some(pick) = pick else {
                assert_eq!(frame.top_contributor[pixel], NO_SPLAT);
                continue;
            };
            let median = frame.median_depth[pixel];
            let depth = if median.is_nan() { frame.expected_depth[pixel] } else { median };
            // The tile of the pixel is blended as in the whole frame, so nothing may differ.
            assert_eq!((pick.splat, pick.depth), (frame.top_contributor[pixel], depth));
            let label = scene.clusters.as_ref().unwrap().labels[pick.splat as usize];
            assert_eq!(pick.cluster, Some(label));
        }
        assert_eq!(renderer.pick(&camera, &settings, (150, 0)).unwrap(), None);
        let after = renderer.render(&camera, &settings).unwrap();
        assert_same_color(&after, &frame, "a pick does not disturb the next frame");
    }
}

/// The same camera, with everything behind it.
fn looking_away(camera: &Camera) -> Camera {
    let mut away = camera.clone();
    away.world_to_camera.w_axis.z -= 1e3;
    away
}

#[test]
fn buffers_that_are_too_small_grow_until_nothing_is_clipped() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    let scene = Arc::new(cloud(3000, ShDegree::Zero, 45));
    let camera = cloud_camera(150, 110);
    let expected = render_gpu(&gpu, &scene, &camera, &everything());
    let options = RendererOptions { initial_entries: Some(10), ..RendererOptions::default() };

    let mut waiting = Renderer::with_options(&gpu, scene.clone(), options).unwrap();
    assert_same_color(&waiting.render(&camera, &everything()).unwrap(), &expected, "waiting");

    // The first frame of a size is waited for, whatever it needs.
    let mut playing = Renderer::with_options(&gpu, scene, options).unwrap();
    let waits = gpu.created().waits;
    assert!(!playing.draw(&looking_away(&camera), &everything()).unwrap());
    assert!(gpu.created().waits > waits);
    // Playback: the frame is not drawn, the number that was needed arrives, the next one is.
    let waits = gpu.created().waits;
    assert!(!playing.draw(&camera, &everything()).unwrap());
    assert_eq!(gpu.created().waits, waits);
    gpu.wait().unwrap();
    assert!(playing.draw(&camera, &everything()).unwrap(), "the buffers have grown");
    gpu.wait().unwrap();
    assert!(!playing.draw(&camera, &everything()).unwrap(), "and are large enough");
    assert!(playing.tile_entries() > 10);
}

/// A device with a low limit on bindings.
fn limited(binding_bytes: u64) -> Option<Gpu> {
    let options = GpuOptions { max_binding_bytes: Some(binding_bytes), ..GpuOptions::default() };
    gpu(DeviceProfile::Full).map(|_| Gpu::open(&options).unwrap())
}

#[test]
fn scenes_and_images_past_a_binding_limit_are_taken_apart() {
    // Harmonics of SH degree 3 are 192 bytes a splat: 4000 of them are in several windows. An image
    // of 300 × 200 pixels has 960 000 bytes: regions of a few rows of tiles.
    let Some(gpu) = limited(160 << 10) else { return };
    let scene = clustered(3000, 46);
    let camera = cloud_camera(300, 200);
    let settings = FrameSettings { time: 0.4, ..everything() };
    let frame = render_gpu(&gpu, &scene, &camera, &settings);
    let whole =
        render_gpu(&trapeze_tests::gpu(DeviceProfile::Full).unwrap(), &scene, &camera, &settings);
    assert!(bits(&frame) == bits(&whole), "taken apart, the image is another one");
}

#[test]
fn more_entries_than_a_binding_holds_are_drawn_region_by_region() {
    // 900 splats over all of 24 × 16 tiles are 345 600 entries of 4 bytes.
    let Some(gpu) = limited(256 << 10) else { return };
    let splats: Vec<trapeze_tests::Splat> = (0..900u16)
        .map(|i| trapeze_tests::Splat {
            position: [0.0, 0.0, 1.0 + f32::from(i) * 0.01],
            log_scale: [3.0; 3],
            logit: -4.5,
            dc: [f32::from(i % 3), f32::from(i % 5) * 0.3, 0.4],
            ..trapeze_tests::Splat::default()
        })
        .collect();
    let scene = scene_of(&splats);
    let camera = camera_at_origin(384, 256);
    let frame = render_gpu(&gpu, &scene, &camera, &everything());
    let cpu = render(&scene, &camera, &everything(), CpuOptions::default());
    assert!(psnr(&frame.color, &cpu.color) > 90.0);
}

#[test]
fn what_cannot_fit_is_refused_with_need_and_have() {
    let Some(gpu) = limited(64 << 10) else { return };
    let error = Renderer::new(&gpu, Arc::new(cloud(5000, ShDegree::Zero, 47))).unwrap_err();
    let GpuError::OutOfMemory { need, have, .. } = error else { panic!("{error}") };
    assert!(need > have, "{error}");
}

#[test]
fn cameras_that_cannot_project_are_refused_by_field() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    let mut renderer = Renderer::new(&gpu, Arc::new(cloud(10, ShDegree::Zero, 48))).unwrap();
    let camera = Camera { width: 0, ..cloud_camera(64, 48) };
    for error in [
        renderer.render(&camera, &everything()).unwrap_err(),
        renderer.draw(&camera, &everything()).unwrap_err(),
        renderer.pick(&camera, &everything(), (0, 0)).unwrap_err(),
    ] {
        assert!(error.to_string().contains("width"), "{error}");
    }
}

#[test]
fn half_precision_harmonics_cost_little() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    let scene = Arc::new(cloud(3000, ShDegree::Three, 49));
    let camera = cloud_camera(150, 110);
    let exact = reference::render(&scene, &camera, &everything()).to_frame();
    let options =
        RendererOptions { harmonics: HarmonicsStorage::Half, ..RendererOptions::default() };
    let frame = Renderer::with_options(&gpu, scene, options)
        .unwrap()
        .render(&camera, &everything())
        .unwrap();
    // Coefficients up to 1.5 are off by 2⁻¹² of themselves at most; sixteen of them add up like
    // noise to about 4e-4.
    let quality = psnr(&frame.color, &exact.color);
    assert!((60.0..100.0).contains(&quality), "{quality} dB");
}

#[test]
fn a_steady_frame_creates_nothing_and_waits_for_nothing() {
    let Some(gpu) = limited(128 << 20) else { return };
    let mut renderer = Renderer::new(&gpu, Arc::new(clustered(2000, 50))).unwrap();
    let camera = cloud_camera(150, 110);
    for settings in requests() {
        renderer.render(&camera, &settings).unwrap();
    }
    let before = gpu.created();
    let mut random = Random::new(51);
    for i in 0..100u16 {
        let settings = FrameSettings {
            time: f32::from(i) * 0.01,
            static_threshold: (i % 3 == 0).then(|| random.between(0.0, 1.0)),
            selection: Selection::Hide(set(&[u32::from(i) % 7])),
            ..if i % 2 == 0 { everything() } else { FrameSettings::default() }
        };
        let mut moved = camera.clone();
        moved.world_to_camera.w_axis.x += f64::from(random.signed()) * 0.3;
        renderer.draw(&moved, &settings).unwrap();
    }
    assert_eq!(gpu.created(), before, "a steady frame made something, or waited");
    gpu.wait().unwrap();
}

/// A camera of any size up to 64 × 48 that looks at the cloud, or past it, from anywhere around it.
fn random_camera(random: &mut Random) -> Camera {
    let mut camera = cloud_camera(1 + random.below(64) as u32, 1 + random.below(48) as u32);
    let mut angle = || f64::from(random.signed()) * std::f64::consts::PI;
    let turn = DMat4::from_rotation_y(angle()) * DMat4::from_rotation_x(angle());
    let closer =
        DMat4::from_translation(DVec3::new(0.0, 0.0, -f64::from(random.between(0.0, 4.0))));
    camera.world_to_camera = closer * camera.world_to_camera * turn;
    camera
}

/// Frames of the test below, each of its own camera, time, threshold, selection and precision. A
/// software device takes about half a second for each; TRAPEZE_RANDOM_FRAMES asks a fast
/// one for more.
const RANDOM_FRAMES: usize = 60;

#[test]
fn random_frames_neither_fail_nor_pile_up() {
    let Some(gpu) = limited(128 << 20) else { return };
    let scene = clustered(150, 52);
    let options =
        RendererOptions { precision: NetworkPrecision::Half, ..RendererOptions::default() };
    let mut renderer = Renderer::with_options(&gpu, Arc::new(scene.clone()), options).unwrap();
    let mut random = Random::new(53);
    let asked = std::env::var("TRAPEZE_RANDOM_FRAMES").ok().and_then(|n| n.parse().ok());
    let frames: usize = asked.unwrap_or(RANDOM_FRAMES);
    // The largest frame, with everything that is made when it is first asked for.
    renderer.draw(&cloud_camera(64, 48), &everything()).unwrap();
    let mut settled = Created { waits: 0, ..gpu.created() };
    for i in 0..frames {
        let camera = random_camera(&mut random);
        let settings = FrameSettings {
            time: random.signed() * 3.0,
            static_threshold: (random.below(2) == 0).then(|| random.between(-0.1, 1.1)),
            selection: match random.below(3) {
                0 => Selection::All,
                1 => Selection::Hide(set(&[random.below(7) as u32])),
                _ => Selection::Isolate(set(&[random.below(7) as u32])),
            },
            max_sh_degree: ShDegree::ALL[random.below(4)],
            depth: random.below(2) == 0,
            ..FrameSettings::default()
        };
        let single = random.below(2) == 0;
        renderer.set_precision(match single {
            true => NetworkPrecision::Single,
            false => NetworkPrecision::Half,
        });
        // An error that wgpu could not attribute to a call comes back from the next one.
        renderer.draw(&camera, &settings).unwrap();
        assert_eq!(Created { waits: 0, ..gpu.created() }, settled, "frame {i} made something");
        if i % 64 == 0 {
            gpu.wait().unwrap();
        }
        if i % 20 == 19 {
            renderer.set_precision(NetworkPrecision::Single);
            let frame = renderer.render(&camera, &settings).unwrap();
            let exact = reference::render(&scene, &camera, &settings);
            let comparison = compare(&frame, &exact, TOLERANCE);
            assert!(comparison.agrees(TOLERANCE), "frame {i}: {comparison:?}");
            // Reading an image back makes buffers for that.
            settled = Created { waits: 0, ..gpu.created() };
        }
    }
    gpu.wait().unwrap();
    gpu.check().unwrap();
}

#[test]
fn scenes_of_one_colour_source_or_none_are_drawn_like_the_cpu_does() {
    // No clusters, no motion, no network: grey clusters, black motion, any selection ignored.
    let scene = cloud(500, ShDegree::Zero, 54);
    let camera = cloud_camera(60, 45);
    for color_source in [ColorSource::Clusters, ColorSource::Motion] {
        let selection = Selection::Isolate(set(&[3]));
        let settings = FrameSettings { color_source, selection, ..everything() };
        let _ = assert_agrees(&scene, &camera, &settings);
    }
}
