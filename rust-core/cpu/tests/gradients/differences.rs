//! f64 analytic gradients against f64 central differences.

use trapeze_cpu::ImageGradient;
use trapeze_cpu::reference::{self, Projection, SplatParameters, Visit};
use trapeze_scene::{Camera, FrameSettings, Scene, ShDegree};

use crate::scenes::{camera, image_weights, scene};

/// Σ image·weights for splats given in double precision.
fn weighted_image(
    splats: &[SplatParameters],
    camera: &Camera,
    degree: ShDegree,
    (color, depth): (&[[f32; 4]], Option<&[f32]>),
) -> f64 {
    let projection = Projection::new(camera);
    let mut projected: Vec<_> = (0u32..)
        .zip(splats)
        .filter_map(|(i, s)| projection.project(&s.pose(i, camera.centre(), degree)))
        .collect();
    projected.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    let frame = reference::rasterize(&projected, (camera.width, camera.height), Visit::AllPixels);
    let colors = frame.color.iter().zip(color);
    let mut sum: f64 =
        colors.map(|(c, w)| (0..4).map(|i| c[i] * f64::from(w[i])).sum::<f64>()).sum();
    if let Some(depth) = depth {
        let weighted = frame.expected_depth.iter().zip(depth).filter(|(_, w)| **w != 0.0);
        sum += weighted.map(|(d, &w)| d * f64::from(w)).sum::<f64>();
    }
    sum
}

/// The numbers of one parameter group of a splat.
type Group = (&'static str, fn(&mut SplatParameters) -> Vec<&mut f64>);

const GROUPS: [Group; 5] = [
    ("positions", |s| s.position.as_mut().iter_mut().collect()),
    ("log_scales", |s| s.log_scale.as_mut().iter_mut().collect()),
    ("rotations", |s| s.rotation.iter_mut().collect()),
    ("opacity_logits", |s| vec![&mut s.opacity_logit]),
    ("sh", |s| s.sh.iter_mut().flatten().collect()),
];

/// Largest deviation of the analytic gradient from differences, over its largest entry.
fn relative_error(
    scene: &Scene,
    camera: &Camera,
    degree: ShDegree,
    with_depth: bool,
    group: &Group,
) -> f64 {
    let settings =
        FrameSettings { max_sh_degree: degree, depth: with_depth, ..FrameSettings::default() };
    let frame = reference::render(scene, camera, &settings);
    let (color, depth) = image_weights(7, &frame, 0.02);
    let depth = with_depth.then_some(depth);
    let gradient = ImageGradient { color: &color, expected_depth: depth.as_deref() };
    let mut analytic = reference::gradients(scene, camera, &settings, &gradient).splats;
    let splats: Vec<_> = (0..scene.len()).map(|i| SplatParameters::of(&scene.splats, i)).collect();
    let weights = (&color[..], depth.as_deref());

    // Five points: truncation is h⁴/30 of the fifth derivative, about 10⁻¹² of the gradient here;
    // rounding ε·L/h, about 10⁻¹⁰.
    let h = 2e-5;
    let (mut deviation, mut largest) = (0.0f64, 0.0f64);
    for i in 0..splats.len() {
        let count = (group.1)(&mut analytic[i]).len();
        let count = if group.0 == "sh" { degree.coefficients() * 3 } else { count };
        for k in 0..count {
            let at = |by: f64| {
                let mut moved = splats.clone();
                *(group.1)(&mut moved[i])[k] += by;
                weighted_image(&moved, camera, degree, weights)
            };
            let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            let exact = *(group.1)(&mut analytic[i])[k];
            deviation = deviation.max((difference - exact).abs());
            largest = largest.max(exact.abs());
        }
    }
    assert!(largest > 1e-3, "{}: nothing to compare", group.0);
    deviation / largest
}

#[test]
fn every_group_of_the_specification_is_the_derivative_of_its_forward_pass() {
    for (seed, degree, with_depth) in
        [(1, ShDegree::Zero, false), (2, ShDegree::Three, false), (3, ShDegree::One, true)]
    {
        let scene = scene(seed, 10, degree);
        for group in &GROUPS {
            let error = relative_error(&scene, &camera((40, 30)), degree, with_depth, group);
            println!("{} SH {degree:?} depth {with_depth}: {error:.1e}", group.0);
            assert!(error <= 1e-6, "{}: {error:e}", group.0);
        }
    }
}
