//! Renders against images that gsplat's CUDA rasterizer made of the same scenes.
//!
//! Three views of the sample scene are committed and always tested; seven more, and two static
//! captures (one of SH degree 3, seen from inside a haze of huge splats), need TRAPEZE_DATA.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use trapeze_cpu::{Renderer, reference};
use trapeze_formats::{View, load_scene, read_npy, read_views};
use trapeze_gpu::DeviceProfile;
use trapeze_scene::{FrameSettings, Scene, psnr};
use trapeze_tests::{TOLERANCE, assert_finite, compare, gpu};

/// Least PSNR of the reference against the goldens, dB. The goldens are f32 renders stored as half
/// floats, whose steps between ½ and 1 are 2⁻¹¹: that rounding alone is −20 log₁₀(2⁻¹¹/√12) = 77 dB
/// where everything is that bright, and 6 dB better for each halving. Seen: 78 to 89 dB.
const REFERENCE_PSNR: f64 = 75.0;
/// Least PSNR of the CPU renderer. It stays within 0.2 dB of the reference unless a large splat is
/// decided differently.
const CPU_PSNR: f64 = 70.0;

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// A folder of test data that is not part of the repository.
fn data(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("TRAPEZE_DATA").map(|data| Path::new(&data).join(path));
    let folder = folder.filter(|folder| folder.exists());
    if folder.is_none() {
        eprintln!("SKIPPED: goldens of {path} need TRAPEZE_DATA");
    }
    folder
}

/// r g b over black and alpha of a golden.
fn read_golden(folder: &Path, view: &View) -> Vec<[f32; 4]> {
    let name = view.image.as_ref().expect("a golden names its image");
    let array = read_npy(&folder.join(name)).unwrap();
    assert_eq!(array.shape, [view.camera.height as usize, view.camera.width as usize, 4]);
    let values: Vec<f32> = array.values.to_f64().iter().map(|&v| v as f32).collect();
    values.as_chunks().0.to_vec()
}

/// Least PSNR of the GPU renderer, against the goldens and against the reference. Its exponentials
/// and square roots are those of the device.
const GPU_PSNR: f64 = 70.0;

/// Renders the views of a folder of goldens with the CPU renderer, the GPU renderer and the
/// reference.
fn assert_goldens(scene: Scene, folder: &Path, wanted: impl Fn(&View) -> bool) {
    let scene = Arc::new(scene);
    let mut renderer = Renderer::new(scene.clone());
    let mut gpu_renderer = gpu(DeviceProfile::Full)
        .map(|gpu| trapeze_gpu::Renderer::new(&gpu, scene.clone()).unwrap());
    let views: Vec<View> = read_views(&folder.join("views.json")).unwrap();
    for view in views.iter().filter(|view| wanted(view)) {
        let golden = read_golden(folder, view);
        let settings = FrameSettings { time: view.time, ..FrameSettings::default() };
        let frame = renderer.render(&view.camera, &settings).unwrap();
        assert_finite(&frame);
        let exact = reference::render(&scene, &view.camera, &settings);

        let name = format!("{}/{}", folder.display(), view.image.as_deref().unwrap_or_default());
        let reference_psnr = psnr(&exact.to_frame().color, &golden);
        let cpu_psnr = psnr(&frame.color, &golden);
        let comparison = compare(&frame, &exact, TOLERANCE);
        println!("{name}: reference {reference_psnr:.2} dB, CPU {cpu_psnr:.2} dB, {comparison:?}");
        assert!(reference_psnr >= REFERENCE_PSNR, "{name}: reference {reference_psnr} dB");
        assert!(cpu_psnr >= CPU_PSNR, "{name}: CPU {cpu_psnr} dB");
        assert!(comparison.agrees(TOLERANCE), "{name}: {comparison:?}");

        let Some(gpu_renderer) = &mut gpu_renderer else { continue };
        let frame = gpu_renderer.render(&view.camera, &settings).unwrap();
        assert_finite(&frame);
        let golden_psnr = psnr(&frame.color, &golden);
        let reference_psnr = psnr(&frame.color, &exact.to_frame().color);
        let comparison = compare(&frame, &exact, TOLERANCE);
        println!(
            "{name}: GPU {golden_psnr:.2} dB, {reference_psnr:.2} dB against f64, {comparison:?}"
        );
        assert!(golden_psnr >= GPU_PSNR, "{name}: GPU {golden_psnr} dB");
        assert!(reference_psnr >= GPU_PSNR, "{name}: GPU {reference_psnr} dB against f64");
        assert!(comparison.agrees(TOLERANCE), "{name}: GPU {comparison:?}");
    }
}

fn sample_scene() -> Scene {
    load_scene(&repository("assets/sample-scene")).unwrap()
}

#[test]
fn committed_views_of_the_sample_scene_match_the_cuda_renders() {
    assert_goldens(sample_scene(), &repository("tests/goldens/sample-scene"), |_| true);
}

#[test]
fn the_other_views_of_the_sample_scene_match_the_cuda_renders() {
    let Some(folder) = data("goldens/sample-scene") else { return };
    let committed = repository("tests/goldens/sample-scene");
    assert_goldens(sample_scene(), &folder, |view| {
        !committed.join(view.image.as_deref().unwrap_or_default()).exists()
    });
}

#[test]
fn a_capture_without_harmonics_matches_the_cuda_renders() {
    let (Some(folder), Some(scene)) = (data("goldens/guitar"), data("splats/guitar.ply")) else {
        return;
    };
    assert_goldens(load_scene(&scene).unwrap(), &folder, |_| true);
}

#[test]
fn a_capture_seen_from_inside_its_haze_matches_the_cuda_renders() {
    let (Some(folder), Some(scene)) = (data("goldens/stone"), data("splats/stone.ply")) else {
        return;
    };
    assert_goldens(load_scene(&scene).unwrap(), &folder, |_| true);
}
