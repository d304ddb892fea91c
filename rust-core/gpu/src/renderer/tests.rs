//! Picking without waiting, and what happens when the device goes.

use std::collections::BTreeMap;
use std::sync::Arc;

use trapeze_scene::{Camera, Clusters, Frame, FrameSettings, NO_SPLAT, Scene, Splats};

use super::{Pick, Renderer, RendererOptions};
use crate::GpuError;
use crate::kernel_tests::device;

/// A wall of splats in two clusters, with gaps.
fn wall() -> Arc<Scene> {
    let n = 60u16;
    let splats = Splats {
        positions: (0..n)
            .map(|i| [f32::from(i % 10) * 0.3 - 1.4, f32::from(i / 10) * 0.3 - 0.8, 3.0])
            .collect(),
        log_scales: vec![[-2.3; 3]; n.into()],
        rotations: vec![[1.0, 0.0, 0.0, 0.0]; n.into()],
        opacity_logits: vec![2.0; n.into()],
        sh_dc: (0..n).map(|i| [f32::from(i % 7) * 0.2; 3]).collect(),
        ..Splats::default()
    };
    let ids: Vec<u32> = (0..u32::from(n)).map(|i| 40 + i % 2).collect();
    let clusters = Clusters::from_ids(&ids, &vec![[0.5; 3]; n.into()]).unwrap();
    Arc::new(Scene { clusters: Some(clusters), ..Scene::from_splats(splats) })
}

fn camera() -> Camera {
    Camera {
        width: 70,
        height: 50,
        fx: 60.0,
        fy: 60.0,
        cx: 35.0,
        cy: 25.0,
        world_to_camera: glam::DMat4::IDENTITY,
    }
}

fn everything() -> FrameSettings {
    FrameSettings { depth: true, top_contributor: true, ..FrameSettings::default() }
}

/// What a whole frame shows at a pixel.
fn shown(frame: &Frame, scene: &Scene, (x, y): (u32, u32)) -> Option<Pick> {
    if x >= frame.width || y >= frame.height {
        return None;
    }
    let pixel = (y * frame.width + x) as usize;
    let splat = frame.top_contributor[pixel];
    let median = frame.median_depth[pixel];
    (splat != NO_SPLAT).then(|| Pick {
        splat,
        cluster: scene.clusters.as_ref().map(|clusters| clusters.labels[splat as usize]),
        depth: if median.is_nan() { frame.expected_depth[pixel] } else { median },
    })
}

/// Asks for pixels and polls until all are answered.
fn pick_all(renderer: &mut Renderer, pixels: &[(u32, u32)]) -> Vec<Option<Pick>> {
    let tickets: Vec<_> = pixels
        .iter()
        .map(|&pixel| renderer.request_pick(&camera(), &everything(), pixel).unwrap())
        .collect();
    let mut answers = BTreeMap::new();
    while answers.len() < pixels.len() {
        answers.extend(renderer.answered_pick().unwrap());
    }
    assert_eq!(renderer.answered_pick().unwrap(), None);
    tickets.iter().map(|ticket| answers[ticket]).collect()
}

#[test]
fn picks_are_answered_without_a_wait_and_without_a_new_object() {
    let Some(gpu) = device() else { return };
    let scene = wall();
    let mut renderer = Renderer::new(&gpu, scene.clone()).unwrap();
    let frame = renderer.render(&camera(), &everything()).unwrap();
    let image = frame.color.clone();
    // More than can be under way at a time; gaps, and pixels outside the image.
    let pixels: Vec<(u32, u32)> = (0..23).map(|i| (i * 31 % 74, i * 17 % 52)).collect();
    let expected: Vec<Option<Pick>> = pixels.iter().map(|&p| shown(&frame, &scene, p)).collect();
    assert!(expected.iter().any(Option::is_none) && expected.iter().any(Option::is_some));

    assert_eq!(pick_all(&mut renderer, &pixels), expected);
    let before = gpu.created();
    assert_eq!(pick_all(&mut renderer, &pixels), expected);
    assert_eq!(gpu.created(), before, "a pick made something, or waited");
    assert_eq!(renderer.pick(&camera(), &everything(), pixels[1]).unwrap(), expected[1]);
    assert_eq!(renderer.render(&camera(), &everything()).unwrap().color, image);
}

#[test]
fn a_pick_whose_tile_does_not_fit_is_asked_again_in_larger_buffers() {
    let Some(gpu) = device() else { return };
    let options = RendererOptions { initial_entries: Some(1), ..RendererOptions::default() };
    let scene = wall();
    let expected = Renderer::new(&gpu, scene.clone())
        .unwrap()
        .pick(&camera(), &everything(), (35, 25))
        .unwrap();
    assert!(expected.is_some());
    let mut small = Renderer::with_options(&gpu, scene, options).unwrap();
    assert_eq!(pick_all(&mut small, &[(35, 25); 6]), vec![expected; 6]);
}

#[test]
fn a_lost_device_is_an_error_and_the_scene_draws_on_a_new_one() {
    let Some(gpu) = device() else { return };
    let mut renderer = Renderer::new(&gpu, wall()).unwrap();
    let image = renderer.render(&camera(), &everything()).unwrap().color;
    assert!(renderer.draw(&camera(), &everything()).is_ok() && !gpu.is_lost());

    // wgpu tells of a loss once the work that was under way has ended.
    gpu.wait().unwrap();
    gpu.device().destroy();
    let error = renderer.draw(&camera(), &everything()).unwrap_err();
    assert!(matches!(error, GpuError::DeviceLost(_)), "{error}");
    assert!(gpu.is_lost());
    for error in [
        renderer.render(&camera(), &everything()).unwrap_err(),
        renderer.pick(&camera(), &everything(), (1, 1)).unwrap_err(),
        renderer.request_pick(&camera(), &everything(), (1, 1)).unwrap_err(),
        renderer.answered_pick().unwrap_err(),
    ] {
        assert!(matches!(error, GpuError::DeviceLost(_)), "{error}");
    }

    let mut rebuilt = renderer.rebuilt_on(&gpu.reopened().unwrap()).unwrap();
    assert_eq!(rebuilt.render(&camera(), &everything()).unwrap().color, image);
}
