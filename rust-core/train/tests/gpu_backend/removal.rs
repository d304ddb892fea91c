//! What a splat is worth, on every backend.

use trapeze_scene::{FrameSettings, ShDegree, Splats};
use trapeze_train::densify::random_signs;
use trapeze_train::{CpuBackend, ReferenceBackend};

use super::*;

const BACKGROUND: [f32; 3] = [0.3, 0.6, 0.9];

/// The image over the background, as one number under each sign.
fn signed_sum(backend: &mut dyn TrainingBackend, view: &TrainingView, signs: &[[f32; 4]]) -> f64 {
    let settings = FrameSettings { max_sh_degree: ShDegree::One, ..FrameSettings::default() };
    let frame = backend.render(&view.camera, &settings).unwrap();
    let over = |pixel: &[f32; 4], c: usize| {
        f64::from(pixel[c]) + (1.0 - f64::from(pixel[3])) * f64::from(BACKGROUND[c])
    };
    let pixels = frame.color.iter().zip(signs);
    pixels.map(|(pixel, v)| (0..3).map(|c| f64::from(v[c]) * over(pixel, c)).sum::<f64>()).sum()
}

/// The cost of removing a splat is what the image loses without it: no approximation but rounding, where
/// nothing is clamped and no pixel is full.
fn compare_with_removal(backend: &mut dyn TrainingBackend, name: &str) {
    let scene = splats(12);
    let view = TrainingView { id: 0, camera: camera(1, (40, 30)), time: 0.0 };
    let signs = random_signs((1, 2, 3), 40 * 30, BACKGROUND, None);
    let load = |backend: &mut dyn TrainingBackend, splats: &Splats| {
        backend.load(TrainingState::new(splats.clone()), splats.len() as u32).unwrap();
    };
    load(backend, &scene);
    let by_logits = backend.opacity_gradient(&view, ShDegree::One, &signs).unwrap();
    let whole = signed_sum(backend, &view, &signs);
    let mut lost = Vec::new();
    for i in 0..scene.len() as u32 {
        let others: Vec<u32> = (0..scene.len() as u32).filter(|&other| other != i).collect();
        load(backend, &scene.gather(&others));
        lost.push(whole - signed_sum(backend, &view, &signs));
    }
    let largest = lost.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    assert!(largest > 1.0, "{name}: nothing to see");
    for (i, (&by_logit, lost)) in by_logits.iter().zip(lost).enumerate() {
        let transparency = 1.0 / (1.0 + f64::from(scene.opacity_logits[i]).exp());
        let expected = f64::from(by_logit) / transparency;
        // Sums of 3 600 numbers of f32 images, whose rounding is 6e-8 each.
        assert!((expected - lost).abs() <= 1e-4 * largest, "{name}, splat {i}: {expected} {lost}");
    }
}

#[test]
fn the_cost_of_a_removal_is_what_the_image_loses() {
    compare_with_removal(&mut ReferenceBackend::default(), "reference");
    compare_with_removal(&mut CpuBackend::default(), "CPU");
    if let Some(gpu) = device() {
        compare_with_removal(&mut backend(&gpu), "GPU");
    }
}

#[test]
fn a_gradient_of_another_size_is_refused() {
    let view = TrainingView { id: 7, camera: camera(1, (40, 30)), time: 0.0 };
    let state = TrainingState::new(splats(12));
    let refuses = |backend: &mut dyn TrainingBackend| {
        backend.load(state.clone(), 12).unwrap();
        backend.opacity_gradient(&view, ShDegree::Zero, &[[0.0; 4]; 3]).is_err()
    };
    assert!(refuses(&mut ReferenceBackend::default()) && refuses(&mut CpuBackend::default()));
    assert!(device().is_none_or(|gpu| refuses(&mut backend(&gpu))));
}
