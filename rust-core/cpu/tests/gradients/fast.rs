//! The fast backward pass against the f64 specification.

use fearless_simd::Level;
use trapeze_cpu::reference::{self, SplatParameters};
use trapeze_cpu::{DifferentiableRenderer, ImageGradient, PoseGradients, RendererOptions};
use trapeze_scene::{Camera, FrameSettings, Scene, SceneError, ShDegree, Splats};

use crate::scenes::{Random, camera, image_weights, scene};

/// Parameter groups as flat numbers, of the fast gradients and of the specification's.
fn groups(fast: &Splats, exact: &[SplatParameters]) -> Vec<(&'static str, Vec<f32>, Vec<f64>)> {
    let of = |numbers: fn(&SplatParameters) -> Vec<f64>| exact.iter().flat_map(numbers).collect();
    let stride = fast.sh_rest_stride();
    let rest: Vec<f64> =
        exact.iter().flat_map(|s| s.sh[1..].as_flattened()[..stride].to_vec()).collect();
    vec![
        (
            "positions",
            fast.positions.as_flattened().to_vec(),
            of(|s| s.position.to_array().to_vec()),
        ),
        (
            "log_scales",
            fast.log_scales.as_flattened().to_vec(),
            of(|s| s.log_scale.to_array().to_vec()),
        ),
        ("rotations", fast.rotations.as_flattened().to_vec(), of(|s| s.rotation.to_vec())),
        ("opacity_logits", fast.opacity_logits.clone(), of(|s| vec![s.opacity_logit])),
        ("sh_dc", fast.sh_dc.as_flattened().to_vec(), of(|s| s.sh[0].to_vec())),
        ("sh_rest", fast.sh_rest.clone(), rest),
    ]
}

/// ‖g − g*‖∞ / max‖g*‖.
fn deviation(fast: &[f32], exact: &[f64]) -> f64 {
    let largest = exact.iter().fold(0.0f64, |m, g| m.max(g.abs()));
    let differences = fast.iter().zip(exact).map(|(&f, e)| (f64::from(f) - e).abs());
    differences.fold(0.0, f64::max) / largest.max(f64::MIN_POSITIVE)
}

fn fast_gradients(
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
    gradient: &ImageGradient<'_>,
    options: RendererOptions,
) -> (Splats, PoseGradients) {
    let mut renderer = DifferentiableRenderer::new(options);
    renderer.forward(scene, camera, settings).unwrap();
    let (mut splats, mut poses) = Default::default();
    renderer.backward_with_poses(scene, gradient, &mut splats, &mut poses).unwrap();
    (splats, poses)
}

#[test]
fn every_group_follows_the_specification_at_every_simd_level() {
    for (seed, count, degree, with_depth) in [
        (11, 12, ShDegree::Zero, false),
        (12, 300, ShDegree::Three, false),
        (13, 60, ShDegree::Two, true),
        (14, 900, ShDegree::One, true),
    ] {
        let scene = scene(seed, count, degree);
        let camera = camera((133, 97));
        let settings = FrameSettings { depth: with_depth, ..FrameSettings::default() };
        let frame = reference::render(&scene, &camera, &settings);
        // Pixels that f32 could decide differently do not count: 10⁻³ is 50 times what rounding
        // does to α here.
        let (color, depth) = image_weights(seed, &frame, 1e-3);
        let depth = with_depth.then_some(&depth[..]);
        let gradient = ImageGradient { color: &color, expected_depth: depth };
        let exact = reference::gradients(&scene, &camera, &settings, &gradient);
        for level in [Level::new(), Level::baseline()] {
            let options = RendererOptions { level, ..RendererOptions::default() };
            let (fast, poses) = fast_gradients(&scene, &camera, &settings, &gradient, options);
            for (name, fast, exact) in groups(&fast, &exact.splats) {
                let error = deviation(&fast, &exact);
                println!("{count} splats, {level:?}, {name}: {error:.1e}");
                assert!(error <= 1e-4, "{name}: {error:e}");
            }
            let exact: Vec<f64> = exact.poses.iter().flat_map(|p| p.scale.to_array()).collect();
            assert!(deviation(poses.scales.as_flattened(), &exact) <= 1e-4);
        }
    }
}

#[test]
fn gradients_do_not_depend_on_threads() {
    let scene = scene(21, 20_000, ShDegree::One);
    let camera = camera((200, 150));
    let settings = FrameSettings::default();
    let mut random = Random::new(5);
    let color: Vec<[f32; 4]> =
        (0..200 * 150).map(|_| std::array::from_fn(|_| random.between(-1.0, 1.0))).collect();
    let gradient = ImageGradient { color: &color, expected_depth: None };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            fast_gradients(&scene, &camera, &settings, &gradient, RendererOptions::default())
        })
    };
    let expected = run(1);
    for threads in [2, 3, 7] {
        assert_eq!(run(threads), expected, "{threads} threads");
    }
}

#[test]
fn ten_thousand_contributors_of_one_pixel_all_get_their_gradient() {
    // Opacity 0.0045, just above 1/255: about two thousand of them bring T to 10⁻⁴.
    let mut scene = scene(3, 10_000, ShDegree::Zero);
    for i in 0..scene.len() {
        let depth = scene.splats.positions[i][2];
        scene.splats.positions[i] = [0.05, 0.0, depth];
        scene.splats.log_scales[i] = [-1.0, -1.3, -0.8];
        scene.splats.opacity_logits[i] = -5.4;
    }
    let camera = camera((16, 12));
    let settings = FrameSettings::default();
    let color = vec![[0.3, -0.2, 0.5, 0.1]; 16 * 12];
    let gradient = ImageGradient { color: &color, expected_depth: None };
    let exact = reference::gradients(&scene, &camera, &settings, &gradient).splats;
    let (fast, _) =
        fast_gradients(&scene, &camera, &settings, &gradient, RendererOptions::default());
    let reached = exact.iter().filter(|s| s.opacity_logit != 0.0).count();
    assert!(reached > 1500, "{reached}");
    for (name, fast, exact) in groups(&fast, &exact) {
        // What is left of Σ w v after n contributors has n roundings in it: n·ε = 2·10⁻⁴ of it.
        assert!(deviation(&fast, &exact) <= 5e-4, "{name} {:e}", deviation(&fast, &exact));
    }
}

#[test]
fn a_gradient_of_another_frame_is_refused_by_name() {
    let scene = scene(1, 5, ShDegree::Zero);
    let mut renderer = DifferentiableRenderer::new(RendererOptions::default());
    let mut out = Splats::default();
    let color = vec![[0.0; 4]; 12];
    let gradient = ImageGradient { color: &color, expected_depth: None };
    let error = renderer.backward(&scene, &gradient, &mut out).unwrap_err();
    assert_eq!(error.to_string(), "rendered frames: expected 1 values, found 0");
    renderer.forward(&scene, &camera((4, 3)), &FrameSettings::default()).unwrap();
    renderer.backward(&scene, &gradient, &mut out).unwrap();
    let depth = [0.0; 12];
    let with_depth = ImageGradient { expected_depth: Some(&depth), ..gradient };
    let error = renderer.backward(&scene, &with_depth, &mut out).unwrap_err();
    assert!(matches!(error, SceneError::Length { field: "pixels of the depth gradient", .. }));
    let fewer = ImageGradient { color: &color[..11], expected_depth: None };
    assert!(renderer.backward(&scene, &fewer, &mut out).is_err());
}
