//! Rendering and judging one view.

use std::fmt::Debug;
use std::sync::Arc;

use glam::DVec2;
use trapeze_cpu::reference::{self, Projection, ReferenceFrame, Visit, pose_scene};
use trapeze_cpu::{Renderer, RendererOptions};
use trapeze_gpu::DeviceProfile;
use trapeze_scene::{Camera, Frame, FrameSettings, NO_SPLAT, Scene};

use crate::{TOLERANCE, compare, gpu, render_gpu};

/// Settings with every image asked for.
#[must_use]
pub fn everything() -> FrameSettings {
    FrameSettings { depth: true, top_contributor: true, ..FrameSettings::default() }
}

/// Renders on the CPU with all images and checks that they are finite.
///
/// # Panics
/// When the camera is refused or the image holds NaN or infinity.
#[must_use]
pub fn render(
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
    options: RendererOptions,
) -> Frame {
    let settings = FrameSettings { depth: true, top_contributor: true, ..settings.clone() };
    let mut renderer = Renderer::with_options(Arc::new(scene.clone()), options);
    let frame = renderer.render(camera, &settings).expect("a camera that can project");
    assert_finite(&frame);
    frame
}

/// Checks that colour and alpha are finite everywhere and that depths are NaN exactly where
/// nothing was hit (median: also where T stays above ½).
///
/// # Panics
/// When they are not.
pub fn assert_finite(frame: &Frame) {
    for (i, color) in frame.color.iter().enumerate() {
        assert!(color.iter().all(|c| c.is_finite() && *c >= 0.0), "pixel {i}: {color:?}");
        assert!(color[3] <= 1.0, "pixel {i}: alpha {}", color[3]);
        let Some(&top) = frame.top_contributor.get(i) else { continue };
        let hit = top != NO_SPLAT;
        assert_eq!(hit, color[3] > 0.0, "pixel {i}: splat {top} with alpha {}", color[3]);
        let Some(&expected) = frame.expected_depth.get(i) else { continue };
        assert_eq!(hit, expected.is_finite(), "pixel {i}: expected depth {expected}");
        // Alpha is a sum of weights and T a product, so they disagree about ½ by some roundings.
        let median = frame.median_depth[i];
        let undecided = (color[3] - 0.5).abs() < 1e-4;
        let crossed = color[3] > 0.5;
        assert!(undecided || crossed == median.is_finite(), "pixel {i}: median depth {median}");
    }
}

/// Renders on the CPU, on the GPU where there is one, and in the reference, and checks that they
/// agree to [`TOLERANCE`] outside flipped pixels; returns the CPU's frame.
///
/// # Panics
/// When they do not.
pub fn assert_agrees(scene: &Scene, camera: &Camera, settings: &FrameSettings) -> Frame {
    assert_agrees_within(TOLERANCE, scene, camera, settings)
}

/// [`assert_agrees`] with a tolerance of its own, for ill-conditioned scenes.
///
/// # Panics
/// When CPU or GPU and reference do not agree.
pub fn assert_agrees_within(
    tolerance: f64,
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
) -> Frame {
    let frame = render(scene, camera, settings, RendererOptions::default());
    let exact = reference::render(scene, camera, settings);
    assert_comparable("CPU", &frame, &exact, tolerance);
    if let Some(gpu) = gpu(DeviceProfile::Full) {
        let frame = render_gpu(&gpu, scene, camera, settings);
        assert_finite(&frame);
        assert_comparable("GPU", &frame, &exact, tolerance);
    }
    frame
}

fn assert_comparable(backend: &str, frame: &Frame, exact: &ReferenceFrame, tolerance: f64) {
    let comparison = compare(frame, exact, tolerance);
    let at = comparison.worst_pixel;
    assert!(
        comparison.agrees(tolerance),
        "{backend}: {comparison:?}, tolerance {tolerance}: {:?}, reference {:?}",
        frame.color[at],
        exact.color[at],
    );
}

/// The reference for a window of a frame that is too large to render in f64: `size` pixels from
/// (x, y) on, projected with the whole camera.
#[must_use]
pub fn render_crop(
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
    (x, y): (u32, u32),
    size: (u32, u32),
) -> ReferenceFrame {
    let camera = camera.relative_to(scene.origin);
    let projection = Projection::new(&camera);
    let corner = DVec2::new(f64::from(x), f64::from(y));
    let mut splats: Vec<_> = pose_scene(scene, &camera, settings)
        .iter()
        .filter_map(|splat| projection.project(splat))
        .map(|mut splat| {
            splat.centre -= corner;
            splat
        })
        .collect();
    splats.sort_by(|a, b| a.depth.total_cmp(&b.depth).then(a.index.cmp(&b.index)));
    reference::rasterize(&splats, size, Visit::Rectangle)
}

/// Checks that two images are the same, bit for bit. Unlike `assert_eq!`, it does not print them.
///
/// # Panics
/// When they differ; the message has the first pixel and `context`.
pub fn assert_same_color<C: Debug + ?Sized>(a: &Frame, b: &Frame, context: &C) {
    assert_eq!(a.color.len(), b.color.len(), "{context:?}");
    if let Some(i) = (0..a.color.len()).find(|&i| a.color[i] != b.color[i]) {
        panic!("{context:?}: pixel {i}: {:?} and {:?}", a.color[i], b.color[i]);
    }
}

/// Largest difference of two images, over all pixels and channels.
///
/// # Panics
/// When the sizes differ.
#[must_use]
pub fn largest_difference(a: &Frame, b: &Frame) -> f32 {
    assert_eq!(a.color.len(), b.color.len());
    let pairs = a.color.iter().flatten().zip(b.color.iter().flatten());
    pairs.fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

/// Checks that two finite images differ by at most `tolerance`.
///
/// # Panics
/// When they differ by more.
pub fn assert_close_color(a: &Frame, b: &Frame, tolerance: f32) {
    let difference = largest_difference(a, b);
    assert!(difference <= tolerance, "images differ by {difference}, not by {tolerance}");
}
