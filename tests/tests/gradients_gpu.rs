//! The backward pass on the GPU against the CPU's: random scenes, and the contract of a training
//! run that never waits.

use trapeze_cpu::ImageGradient;
use trapeze_gpu::compute::{LateReader, wgpu};
use trapeze_gpu::{
    DeviceProfile, DifferentiableRenderer, ForwardSettings, FrameStatus, Gpu, GpuOptions,
    ImageGradientBuffers, ParameterBuffers,
};
use trapeze_scene::{Camera, FrameSettings, Scene, ShDegree, Splats};
use trapeze_tests::{
    Random, cloud, cloud_camera, cpu_gradients, gpu, gpu_gradients, gradient_weights,
};

/// Largest ‖g − g*‖∞ / max ‖g*‖ of a group. Both are single precision; activations differ by a few
/// units in the last place, and so do the sums over some thousand pixels.
const TOLERANCE: f64 = 1e-3;

/// Arrays of the parameters, by name.
fn groups(splats: &Splats) -> [(&'static str, &[f32]); 6] {
    [
        ("positions", splats.positions.as_flattened()),
        ("log_scales", splats.log_scales.as_flattened()),
        ("rotations", splats.rotations.as_flattened()),
        ("opacity_logits", &splats.opacity_logits),
        ("sh_dc", splats.sh_dc.as_flattened()),
        ("sh_rest", &splats.sh_rest),
    ]
}

fn assert_same_gradients(found: &Splats, expected: &Splats) {
    for ((name, found), (_, expected)) in groups(found).into_iter().zip(groups(expected)) {
        assert_eq!(found.len(), expected.len(), "{name}");
        let largest = expected.iter().fold(0.0f32, |m, g| m.max(g.abs()));
        let error = found
            .iter()
            .zip(expected)
            .map(|(a, b)| f64::from((a - b).abs()))
            // `f64::max` would pass over NaN.
            .fold(0.0, |m: f64, d| if d <= m { m } else { d });
        println!("{name}: {:.1e}", error / f64::from(largest.max(f32::MIN_POSITIVE)));
        assert!(error <= TOLERANCE * f64::from(largest), "{name}: {error} of {largest}");
    }
}

fn assert_follows_the_cpu(gpu: &Gpu, scene: &Scene, camera: &Camera, depth: bool) {
    let settings = FrameSettings { depth, ..FrameSettings::default() };
    let color = gradient_weights(scene, camera, &settings);
    let mut random = Random::new(5);
    let by_depth: Vec<f32> =
        color.iter().map(|w| if w[0] == 0.0 { 0.0 } else { random.signed() }).collect();
    let expected_depth = depth.then_some(&by_depth[..]);
    let gradient = ImageGradient { color: &color, expected_depth };
    let found = gpu_gradients(gpu, scene, camera, &settings, &gradient);
    assert_same_gradients(&found, &cpu_gradients(scene, camera, &settings, &gradient));
}

#[test]
fn random_scenes_have_the_gradients_of_the_cpu() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    for (seed, degree) in (0..).zip(ShDegree::ALL) {
        let scene = cloud(700, degree, seed);
        assert_follows_the_cpu(&gpu, &scene, &cloud_camera(150, 90), false);
    }
}

#[test]
fn a_gradient_by_depth_is_that_of_the_cpu() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    assert_follows_the_cpu(&gpu, &cloud(300, ShDegree::One, 12), &cloud_camera(90, 70), true);
}

#[test]
fn weak_devices_and_those_of_apple_have_the_same_gradients() {
    for profile in [DeviceProfile::Weak, DeviceProfile::Apple] {
        let Some(gpu) = gpu(profile) else { return };
        for depth in [false, true] {
            let scene = cloud(200, ShDegree::Three, 3);
            assert_follows_the_cpu(&gpu, &scene, &cloud_camera(70, 60), depth);
        }
    }
}

#[test]
fn nothing_to_see_is_a_gradient_of_zero() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    let settings = FrameSettings::default();
    let color = vec![[1.0, -2.0, 3.0, 0.5]; 40 * 30];
    let gradient = ImageGradient { color: &color, expected_depth: None };
    let mut scene = cloud(50, ShDegree::Two, 1);
    for position in &mut scene.splats.positions {
        // Behind a camera that looks from negative z.
        position[2] -= 100.0;
    }
    let found = gpu_gradients(&gpu, &scene, &cloud_camera(40, 30), &settings, &gradient);
    for (name, values) in groups(&found) {
        assert!(!values.is_empty() && values.iter().all(|&g| g == 0.0), "{name}");
    }
    let none = Scene::from_splats(Splats { sh_degree: ShDegree::Two, ..Splats::default() });
    assert!(gpu_gradients(&gpu, &none, &cloud_camera(40, 30), &settings, &gradient).is_empty());
}

/// Everything that a training run on the GPU holds on to.
struct Run {
    gpu: Gpu,
    renderer: DifferentiableRenderer,
    parameters: ParameterBuffers,
    gradients: ParameterBuffers,
    by_color: wgpu::Buffer,
}

const SIZE: (u32, u32) = (96, 64);

impl Run {
    fn new(gpu: &Gpu, splats: &Splats, entries: u32) -> Self {
        let count = splats.len() as u32;
        let mut gradients = ParameterBuffers::zeroed(gpu, count, splats.sh_degree).unwrap();
        gradients.count = count;
        let mut random = Random::new(9);
        let weights: Vec<[f32; 4]> = (0..SIZE.0 * SIZE.1).map(|_| random.vector(1.0)).collect();
        Self {
            renderer: DifferentiableRenderer::new(gpu, count, entries).unwrap(),
            parameters: ParameterBuffers::from_splats(gpu, splats, count).unwrap(),
            gradients,
            by_color: gpu.storage_of("weights", &weights).unwrap(),
            gpu: gpu.clone(),
        }
    }

    /// One step, submitted: both passes, and a late look at the counts.
    fn step(&mut self, step: u64, camera: &Camera, status: &mut LateReader) {
        let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
        let by_image = ImageGradientBuffers { color: &self.by_color, expected_depth: None };
        let settings = ForwardSettings::default();
        self.renderer.forward(&mut encoder, &self.parameters, camera, settings).unwrap();
        self.renderer.backward(&mut encoder, &self.parameters, by_image, &self.gradients).unwrap();
        status.record(&mut encoder, step, &[self.renderer.status_words()]);
        self.gpu.queue().submit([encoder.finish()]);
        status.submitted();
    }

    fn found(&self) -> Splats {
        self.gradients.read(&self.gpu).unwrap()
    }
}

/// What has arrived, in order, once all of it has.
fn all_status(gpu: &Gpu, status: &mut LateReader) -> Vec<(u64, FrameStatus)> {
    let mut all = Vec::new();
    while status.under_way() > 0 {
        gpu.poll().unwrap();
        if let Some((step, words)) = status.take().unwrap() {
            all.push((step, FrameStatus::from_words(&words)));
        }
    }
    all
}

#[test]
fn a_frame_that_does_not_fit_stops_the_run_until_there_is_room() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    let mut scene = cloud(300, ShDegree::One, 8);
    scene.splats.log_scales.as_flattened_mut().iter_mut().for_each(|s| *s += 1.5);
    let near = cloud_camera(SIZE.0, SIZE.1);
    // From far away the splats are few pixels, and so few entries.
    let mut far = near.clone();
    far.world_to_camera.w_axis.z += 40.0;
    let mut status = LateReader::new(&gpu, 8, 4).unwrap();

    let mut roomy = Run::new(&gpu, &scene.splats, 1 << 16);
    roomy.step(0, &far, &mut status);
    let far_gradients = roomy.found();
    let far_entries = all_status(&gpu, &mut status)[0].1.most_entries;
    roomy.step(0, &near, &mut status);
    let near_gradients = roomy.found();
    let near_entries = all_status(&gpu, &mut status)[0].1.most_entries;
    assert!(far_entries * 2 < near_entries, "{far_entries} {near_entries}");

    let mut run = Run::new(&gpu, &scene.splats, far_entries);
    for (step, camera) in [&far, &near, &far].into_iter().enumerate() {
        run.step(step as u64, camera, &mut status);
    }
    let halted = run.found();
    assert!(groups(&halted).iter().all(|(_, values)| values.iter().all(|&g| g == 0.0)));
    let told = all_status(&gpu, &mut status);
    assert_eq!(told.len(), 3);
    assert_eq!(told.iter().map(|(_, s)| s.halted).collect::<Vec<_>>(), [false, true, true]);
    assert!(told[0].1.wants_room(run.renderer.entry_capacity()));
    assert_eq!((told[2].1.drawn_frames, told[2].1.most_entries), (1, near_entries));

    // Step 1 and what follows, again.
    run.renderer.make_room(told[2].1.most_entries).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    run.renderer.record_resume(&mut encoder);
    gpu.queue().submit([encoder.finish()]);
    run.step(1, &near, &mut status);
    assert!(run.found() == near_gradients, "not the bits of a run that had room");
    run.step(2, &far, &mut status);
    assert!(run.found() == far_gradients, "not the bits of a run that had room");
    let told = all_status(&gpu, &mut status);
    assert!(told.iter().all(|(_, s)| !s.halted) && told[1].1.drawn_frames == 2);
}

#[test]
fn a_step_creates_nothing_and_waits_for_nothing_and_has_the_same_bits_again() {
    // A device of its own: the counts of objects are the device's.
    if gpu(DeviceProfile::Full).is_none() {
        return;
    }
    let gpu = Gpu::open(&GpuOptions::default()).unwrap();
    let scene = cloud(300, ShDegree::Two, 21);
    let mut run = Run::new(&gpu, &scene.splats, 1 << 16);
    let mut status = LateReader::new(&gpu, 8, 8).unwrap();
    let camera = cloud_camera(SIZE.0, SIZE.1);
    run.step(0, &camera, &mut status);
    let first = run.found();
    let created = gpu.created();
    for step in 1..12 {
        run.step(step, &camera, &mut status);
        gpu.poll().unwrap();
        while status.take().unwrap().is_some() {}
    }
    assert_eq!(gpu.created(), created);
    assert!(run.found() == first, "the same step has other bits");
}

#[test]
fn what_was_drawn_is_told_splat_by_splat() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    let mut scene = cloud(200, ShDegree::Zero, 2);
    for (i, position) in scene.splats.positions.iter_mut().enumerate() {
        if i % 3 == 0 {
            position[2] -= 100.0;
        }
    }
    let mut run = Run::new(&gpu, &scene.splats, 1 << 16);
    let mut status = LateReader::new(&gpu, 8, 1).unwrap();
    run.step(0, &cloud_camera(SIZE.0, SIZE.1), &mut status);
    let flags: Vec<u32> = trapeze_gpu::compute::read(&gpu, run.renderer.visible(), 200).unwrap();
    assert!(flags.iter().enumerate().all(|(i, &flag)| i % 3 != 0 || flag == 0));
    let drawn = flags.iter().sum::<u32>();
    assert_eq!(all_status(&gpu, &mut status)[0].1.visible, drawn);
    assert!(drawn > 50, "{drawn}");
    let found = run.found();
    for (flag, logit) in flags.iter().zip(&found.opacity_logits) {
        assert!(*flag == 1 || *logit == 0.0);
    }
}

#[test]
fn gradients_of_another_frame_are_refused_by_name() {
    let Some(gpu) = gpu(DeviceProfile::Full) else { return };
    let scene = cloud(20, ShDegree::One, 2);
    let mut run = Run::new(&gpu, &scene.splats, 1 << 12);
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    let color = ImageGradientBuffers { color: &run.by_color, expected_depth: None };
    let error = run.renderer.backward(&mut encoder, &run.parameters, color, &run.gradients);
    assert!(error.unwrap_err().to_string().contains("rendered frames"));
    let camera = cloud_camera(SIZE.0, SIZE.1);
    let settings = ForwardSettings::default();
    run.renderer.forward(&mut encoder, &run.parameters, &camera, settings).unwrap();
    let depth = ImageGradientBuffers { expected_depth: Some(&run.by_color), ..color };
    let error = run.renderer.backward(&mut encoder, &run.parameters, depth, &run.gradients);
    assert!(error.unwrap_err().to_string().contains("depth"));
    let small = gpu.storage("small", 64).unwrap();
    let short = ImageGradientBuffers { color: &small, expected_depth: None };
    let error = run.renderer.backward(&mut encoder, &run.parameters, short, &run.gradients);
    assert!(error.unwrap_err().to_string().contains("color gradient"));
    let other = ParameterBuffers::zeroed(&gpu, 20, ShDegree::Zero).unwrap();
    let error = run.renderer.backward(&mut encoder, &run.parameters, color, &other);
    assert!(error.unwrap_err().to_string().contains("degree"));
}
