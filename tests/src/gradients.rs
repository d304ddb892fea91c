//! Gradients of a random linear loss, compared with the f64 specification.

use trapeze_cpu::reference::{self, SplatParameters};
use trapeze_cpu::{DifferentiableRenderer, ImageGradient, RendererOptions};
use trapeze_gpu::{DeviceProfile, ForwardSettings, Gpu, ParameterBuffers};
use trapeze_scene::{Camera, FrameSettings, Scene, Splats};

use crate::{Random, gpu};

/// Largest ‖g − g*‖∞ / max ‖g*‖ of a group on well-conditioned scenes. Seen: 3·10⁻⁶.
pub const GRADIENT_TOLERANCE: f64 = 1e-4;

/// Pixels closer than this to a decision that single precision could make differently have no
/// weight in the loss (relative, see `ReferenceFrame::margin`).
const DECISION_MARGIN: f64 = 1e-3;

/// Gradients of a loss Σ image·W with random W, by the stored parameters, on every backend: the CPU,
/// and the GPU where there is one and the scene stays as it is.
#[must_use]
pub fn gradients(scene: &Scene, camera: &Camera, settings: &FrameSettings) -> Vec<Splats> {
    let weights = gradient_weights(scene, camera, settings);
    let gradient = ImageGradient { color: &weights, expected_depth: None };
    on_every_backend(scene, camera, settings, &gradient)
}

/// Checks that the gradients of every backend are finite and follow the specification within
/// `tolerance` of each group's largest entry, and returns them.
///
/// # Panics
/// When they do not.
pub fn assert_gradients_agree(
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
    tolerance: f64,
) -> Vec<Splats> {
    let weights = gradient_weights(scene, camera, settings);
    let gradient = ImageGradient { color: &weights, expected_depth: None };
    let exact = reference::gradients(scene, camera, settings, &gradient).splats;
    let all = on_every_backend(scene, camera, settings, &gradient);
    for found in &all {
        assert_gradients_follow(found, &exact, tolerance);
    }
    all
}

fn on_every_backend(
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
    gradient: &ImageGradient<'_>,
) -> Vec<Splats> {
    let mut all = vec![cpu_gradients(scene, camera, settings, gradient)];
    if scene.deformation.is_none() {
        let found = gpu(DeviceProfile::Full)
            .map(|gpu| gpu_gradients(&gpu, scene, camera, settings, gradient));
        all.extend(found);
    }
    all
}

/// Gradients by the stored parameters on the CPU.
///
/// # Panics
/// When the camera cannot project.
#[must_use]
pub fn cpu_gradients(
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
    gradient: &ImageGradient<'_>,
) -> Splats {
    let mut renderer = DifferentiableRenderer::new(RendererOptions::default());
    renderer.forward(scene, camera, settings).expect("a camera that projects");
    let mut gradients = Splats::default();
    renderer.backward(scene, gradient, &mut gradients).expect("the frame just rendered");
    gradients
}

/// Gradients by the stored parameters on the GPU, of a scene without a network.
///
/// # Panics
/// When the camera cannot project or the scene does not fit.
#[must_use]
pub fn gpu_gradients(
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
    gradient: &ImageGradient<'_>,
) -> Splats {
    let splats = &scene.splats;
    let count = splats.len() as u32;
    // Few entries, so that the buffers of most scenes have to grow.
    let mut renderer = trapeze_gpu::DifferentiableRenderer::new(gpu, count, 1000).expect("fits");
    let parameters = ParameterBuffers::from_splats(gpu, splats, count).expect("fits");
    let camera = camera.relative_to(scene.origin);
    let settings = ForwardSettings {
        max_sh_degree: settings.max_sh_degree,
        depth: gradient.expected_depth.is_some(),
    };
    renderer.forward_and_wait(&parameters, &camera, settings).expect("a camera that projects");
    renderer
        .backward_and_wait(&parameters, gradient.color, gradient.expected_depth)
        .expect("the frame just drawn")
}

/// Checks that gradients are finite and within `tolerance` of the largest entry of each group.
///
/// # Panics
/// When they are not.
pub fn assert_gradients_follow(found: &Splats, exact: &[SplatParameters], tolerance: f64) {
    assert_finite_gradients(found);
    let stride = found.sh_rest_stride();
    // Turning a round splat does nothing: what is left of its rotation's gradient is rounding in
    // numbers as large as the gradient of its scales.
    let shape = exact.iter().fold(0.0f64, |m, s| m.max(s.log_scale.abs().max_element()));
    assert_group("positions", found.positions.as_flattened(), exact, tolerance, |s, out| {
        out.extend(s.position.to_array());
    });
    assert_group("log_scales", found.log_scales.as_flattened(), exact, tolerance, |s, out| {
        out.extend(s.log_scale.to_array());
    });
    if exact.iter().any(|s| s.rotation.iter().any(|g| g.abs() > 1e-6 * shape)) {
        assert_group("rotations", found.rotations.as_flattened(), exact, tolerance, |s, out| {
            out.extend(s.rotation);
        });
    }
    assert_group("opacity_logits", &found.opacity_logits, exact, tolerance, |s, out| {
        out.push(s.opacity_logit);
    });
    assert_group("sh_dc", found.sh_dc.as_flattened(), exact, tolerance, |s, out| {
        out.extend(s.sh[0]);
    });
    assert_group("sh_rest", &found.sh_rest, exact, tolerance, |s, out| {
        out.extend(&s.sh[1..].as_flattened()[..stride]);
    });
}

/// Checks that every entry is a finite number.
///
/// # Panics
/// When one is not.
pub fn assert_finite_gradients(gradients: &Splats) {
    let groups = [
        ("positions", gradients.positions.as_flattened()),
        ("log_scales", gradients.log_scales.as_flattened()),
        ("rotations", gradients.rotations.as_flattened()),
        ("opacity_logits", &gradients.opacity_logits),
        ("sh_dc", gradients.sh_dc.as_flattened()),
        ("sh_rest", &gradients.sh_rest),
    ];
    for (name, values) in groups {
        assert!(values.iter().all(|g| g.is_finite()), "{name}: {values:?}");
    }
}

/// Random weights of every pixel, zero where single precision might decide otherwise.
#[must_use]
pub fn gradient_weights(scene: &Scene, camera: &Camera, settings: &FrameSettings) -> Vec<[f32; 4]> {
    let margins = reference::render(scene, camera, settings).margin;
    let mut random = Random::new(77);
    margins
        .iter()
        .map(|&margin| {
            let weight: [f32; 4] = random.vector(1.0);
            if margin > DECISION_MARGIN { weight } else { [0.0; 4] }
        })
        .collect()
}

fn assert_group(
    name: &str,
    found: &[f32],
    exact: &[SplatParameters],
    tolerance: f64,
    numbers: impl Fn(&SplatParameters, &mut Vec<f64>),
) {
    let mut expected = Vec::new();
    exact.iter().for_each(|splat| numbers(splat, &mut expected));
    assert_eq!(found.len(), expected.len(), "{name}");
    assert!(expected.iter().all(|g| g.is_finite()), "{name} of the specification");
    let largest = expected.iter().fold(0.0f64, |m, g| m.max(g.abs()));
    for (i, (&found, &expected)) in found.iter().zip(&expected).enumerate() {
        let error = (f64::from(found) - expected).abs();
        assert!(error <= tolerance * largest, "{name}[{i}]: {found}, not {expected} ({largest})");
    }
}
