//! Scenes with poison in any parameter, and image gradients of zero.

use trapeze_cpu::ImageGradient;
use trapeze_gpu::DeviceProfile;
use trapeze_scene::{FrameSettings, ShDegree};
use trapeze_tests::{
    Random, assert_finite_gradients, cloud, cloud_camera, cpu_gradients, gpu, gpu_gradients,
    gradients,
};

const POISON: [f32; 10] =
    [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e30, 1e-40, -0.0, 1e20, -88.0, 88.0];

#[test]
fn two_hundred_poisoned_scenes_have_finite_gradients() {
    let mut random = Random::new(20);
    for seed in 0..200 {
        let mut scene = cloud(1 + random.below(60), ShDegree::Two, seed);
        for _ in 0..random.below(12) {
            let value = random.choose(&POISON);
            let splats = &mut scene.splats;
            let i = random.below(splats.len());
            match random.below(6) {
                0 => splats.positions[i][random.below(3)] = value,
                1 => splats.log_scales[i][random.below(3)] = value,
                2 => splats.rotations[i][random.below(4)] = value,
                3 => splats.opacity_logits[i] = value,
                4 => splats.sh_dc[i][random.below(3)] = value,
                _ => {
                    let at = random.below(splats.sh_rest.len());
                    splats.sh_rest[at] = value;
                }
            }
        }
        let camera = cloud_camera(40 + seed as u32 % 30, 33);
        let all = gradients(&scene, &camera, &FrameSettings::default());
        all.iter().for_each(assert_finite_gradients);
    }
}

#[test]
fn a_gradient_of_zero_stays_zero() {
    let (scene, camera) = (cloud(50, ShDegree::One, 3), cloud_camera(30, 20));
    let settings = FrameSettings::default();
    let gradient = ImageGradient { color: &[[0.0; 4]; 600], expected_depth: None };
    let mut all = vec![cpu_gradients(&scene, &camera, &settings, &gradient)];
    let gpu = gpu(DeviceProfile::Full);
    all.extend(gpu.map(|gpu| gpu_gradients(&gpu, &scene, &camera, &settings, &gradient)));
    let zero = |values: &[f32]| values.iter().all(|&g| g == 0.0);
    for found in all {
        assert!(zero(found.positions.as_flattened()) && zero(&found.opacity_logits));
        assert!(zero(found.rotations.as_flattened()) && zero(&found.sh_rest));
    }
}
