//! Crowded tiles, many tiles, and images and scenes of extreme size.

use trapeze_cpu::Renderer;
use trapeze_gpu::DeviceProfile;
use trapeze_scene::{Camera, Frame, FrameSettings, Scene, SceneError, ShDegree};
use trapeze_tests::{
    Random, Splat, TOLERANCE, assert_agrees, assert_finite, camera_at_origin, cloud, cloud_camera,
    compare, everything, gpu, render_crop, render_gpu, scene_of,
};

#[test]
fn one_tile_takes_more_than_100_000_splats() {
    // Faint dots of the low-pass' size: about a pixel each, 500 a pixel, so that the transmittance
    // lasts to the last of them (T ≈ 0.3) and dropping any part of the list would show.
    let mut random = Random::new(6);
    let splats: Vec<Splat> = (0..130_000)
        .map(|_| {
            let z = random.between(1.0, 3.0);
            Splat {
                position: [random.signed() * 0.5 * z, random.signed() * 0.5 * z, z],
                log_scale: [-9.0; 3],
                logit: -5.3,
                dc: random.vector(1.5),
                ..Splat::default()
            }
        })
        .collect();
    let scene = scene_of(&splats);
    let frame = assert_agrees(&scene, &camera_at_origin(16, 16), &everything());
    let mean = frame.color.iter().map(|c| c[3]).sum::<f32>() / 256.0;
    assert!((0.2..0.95).contains(&mean), "the test would not see the list's end: alpha {mean}");
}

#[test]
fn tiny_and_odd_frames_agree_with_the_reference() {
    let scene = cloud(3000, ShDegree::Two, 7);
    for (width, height) in [(1, 1), (17, 3), (3, 17), (1, 64), (64, 1), (15, 16), (33, 31)] {
        let _ = assert_agrees(&scene, &cloud_camera(width, height), &everything());
    }
}

#[test]
fn no_splats_give_an_empty_image_and_one_splat_gives_one() {
    let camera = camera_at_origin(40, 30);
    for degree in ShDegree::ALL {
        let frame = assert_agrees(&cloud(0, degree, 0), &camera, &everything());
        assert!(frame.color.iter().flatten().all(|&c| c == 0.0));
        let _ = assert_agrees(&cloud(1, degree, 0), &cloud_camera(40, 30), &everything());
    }
}

/// `n` splats that each cover all of the image, faint enough that many of them count.
fn veils(n: u16) -> Vec<Splat> {
    (0..n)
        .map(|i| Splat {
            position: [
                0.3 - f32::from(i % 7) * 0.1,
                f32::from(i % 5) * 0.1,
                1.0 + f32::from(i) * 0.1,
            ],
            log_scale: [4.0; 3],
            logit: -1.0,
            dc: [f32::from(i % 3), f32::from(i % 4) * 0.5, f32::from(i % 2)],
            ..Splat::default()
        })
        .collect()
}

/// Checks windows of a frame that is too large for the reference.
fn assert_windows_agree(scene: &Scene, camera: &Camera, settings: &FrameSettings) {
    let mut renderer = Renderer::new(scene.clone().into());
    assert_windows_of(&renderer.render(camera, settings).unwrap(), scene, camera, settings);
    drop(renderer);
    if let Some(gpu) = gpu(DeviceProfile::Full) {
        assert_windows_of(&render_gpu(&gpu, scene, camera, settings), scene, camera, settings);
    }
}

fn assert_windows_of(frame: &Frame, scene: &Scene, camera: &Camera, settings: &FrameSettings) {
    assert_finite(frame);
    let size = (24, 20);
    let (right, bottom) = (camera.width - size.0, camera.height - size.1);
    for (x, y) in [(0, 0), (right, 0), (0, bottom), (right, bottom), (right / 2, bottom / 3)] {
        let exact = render_crop(scene, camera, settings, (x, y), size);
        let rows = (y..y + size.1).map(|row| (row * camera.width + x) as usize);
        let window = Frame {
            width: size.0,
            height: size.1,
            color: rows
                .flat_map(|start| frame.color[start..start + size.0 as usize].iter().copied())
                .collect(),
            ..Frame::default()
        };
        let comparison = compare(&window, &exact, TOLERANCE);
        assert!(comparison.agrees(TOLERANCE), "window at ({x}, {y}): {comparison:?}");
    }
}

#[test]
fn an_8k_frame_with_more_than_2_to_the_24_tile_entries() {
    let (width, height) = (7680, 4320);
    let tiles = u64::from(width / 16) * u64::from(height / 16);
    let scene = scene_of(&veils(130));
    assert!(tiles * 130 > 1 << 24, "{tiles} tiles");
    // Colour and alpha alone: half a gigabyte as it is.
    assert_windows_agree(&scene, &camera_at_origin(width, height), &FrameSettings::default());
}

#[test]
fn a_large_frame_of_a_cloud_agrees_in_its_windows() {
    let scene = cloud(2000, ShDegree::One, 8);
    let mut camera = cloud_camera(2560, 1440);
    // Close enough that the corners show splats too.
    camera.fx *= 2.5;
    camera.fy *= 2.5;
    assert_windows_agree(&scene, &camera, &everything());
}

#[test]
fn cameras_without_or_with_too_many_pixels_are_refused_by_field() {
    let mut renderer = Renderer::new(cloud(10, ShDegree::Zero, 9).into());
    for (width, height, expected) in [(0, 10, "width"), (10, 0, "height"), (1 << 20, 1, "width")] {
        let camera = Camera { width, height, ..cloud_camera(64, 48) };
        let error = renderer.render(&camera, &everything()).unwrap_err();
        assert!(matches!(error, SceneError::Camera { field, .. } if field == expected), "{error}");
        assert!(renderer.pick(&camera, &everything(), (0, 0)).is_err());
    }
}
