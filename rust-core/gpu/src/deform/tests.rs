//! The network in half precision on the sample scene.

use std::path::Path;
use std::sync::Arc;

use glam::{DMat4, DVec3};
use trapeze_scene::{Camera, FrameSettings, Scene, psnr};

use super::{NetworkPrecision, PackedWeights};
use crate::kernel_tests::device;
use crate::{DeviceProfile, Gpu, GpuOptions, Renderer, RendererOptions};

fn sample_scene() -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/sample-scene");
    trapeze_formats::load_scene(&folder).unwrap()
}

/// A small image of the whole scene.
fn camera(scene: &Scene) -> Camera {
    let bounds = scene.framing_bounds().unwrap();
    let centre = (bounds.min + bounds.max) / 2.0;
    let eye = centre - DVec3::new(0.0, 0.0, (bounds.max - bounds.min).length());
    Camera {
        width: 160,
        height: 120,
        fx: 150.0,
        fy: 150.0,
        cx: 80.0,
        cy: 60.0,
        world_to_camera: DMat4::from_translation(-eye),
    }
}

fn half() -> RendererOptions {
    RendererOptions { precision: NetworkPrecision::Half, ..RendererOptions::default() }
}

#[test]
fn half_precision_shows_the_sample_scene_at_45_db_or_better() {
    let Some(gpu) = device() else { return };
    if !gpu.features().contains(wgpu::Features::SHADER_F16) {
        eprintln!("SKIPPED: the half-precision network needs a device with 16-bit floats");
        return;
    }
    let scene = Arc::new(sample_scene());
    let camera = camera(&scene);
    let settings = FrameSettings { time: 0.6, ..FrameSettings::default() };
    let mut single = Renderer::new(&gpu, scene.clone()).unwrap();
    let exact = single.render(&camera, &settings).unwrap();
    let mut fast = Renderer::with_options(&gpu, scene.clone(), half()).unwrap();
    assert!(fast.network_kernel().unwrap().starts_with("f16"), "{:?}", fast.network_kernel());
    let frame = fast.render(&camera, &settings).unwrap();
    let covered = exact.color.iter().filter(|p| p[3] > 0.5).count();
    assert!(covered > 1000, "only {covered} pixels show anything");
    let quality = psnr(&frame.color, &exact.color);
    assert!(quality.is_finite() && quality >= 45.0, "{quality} dB");
}

#[test]
fn precision_may_change_from_frame_to_frame_without_a_new_object() {
    let Some(gpu) = device() else { return };
    let few: Vec<u32> = (0..500).collect();
    let scene = Arc::new(sample_scene().gather(&few));
    let camera = camera(&scene);
    let settings = FrameSettings { time: 0.6, ..FrameSettings::default() };
    let mut renderer = Renderer::with_options(&gpu, scene.clone(), half()).unwrap();
    let single = Renderer::new(&gpu, scene).unwrap().render(&camera, &settings).unwrap().color;
    let fast = renderer.render(&camera, &settings).unwrap().color;
    let before = gpu.created();
    for precision in [NetworkPrecision::Single, NetworkPrecision::Half] {
        renderer.set_precision(precision);
        renderer.draw(&camera, &settings).unwrap();
    }
    assert_eq!(gpu.created(), before);
    renderer.set_precision(NetworkPrecision::Single);
    assert_eq!(renderer.network_kernel(), Some("f32"));
    assert_eq!(renderer.render(&camera, &settings).unwrap().color, single);
    renderer.set_precision(NetworkPrecision::Half);
    assert_eq!(renderer.render(&camera, &settings).unwrap().color, fast);
}

#[test]
fn networks_wider_than_workgroup_memory_are_refused_by_name() {
    let mut network = sample_scene().deformation.unwrap();
    network.hidden.iter_mut().for_each(|layer| layer.outputs = 300);
    let error = PackedWeights::new(&network).unwrap_err().to_string();
    assert!(error.contains("width of the hidden layers") && error.contains("256"), "{error}");
    assert!(error.contains("300"), "{error}");
}

#[test]
fn devices_without_16_bit_floats_stay_in_single_precision() {
    if device().is_none() {
        return;
    }
    let weak = GpuOptions { profile: DeviceProfile::Weak, ..GpuOptions::default() };
    let few: Vec<u32> = (0..64).collect();
    let scene = Arc::new(sample_scene().gather(&few));
    let renderer = Renderer::with_options(&Gpu::open(&weak).unwrap(), scene, half()).unwrap();
    assert_eq!(renderer.network_kernel(), Some("f32"));
}
