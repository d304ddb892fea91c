//! Random scenes with poison in any field.

use trapeze_scene::{Camera, Scene, ShDegree};
use trapeze_tests::{HeadBiases, Random, cloud, cloud_camera, constant_network, sliding_network};

/// Numbers that break kernels.
pub(crate) const POISON: [f32; 18] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-40,
    -1e-40,
    0.0,
    -0.0,
    1e30,
    -1e30,
    1e20,
    -1e12,
    1e7,
    -1e4,
    88.0,
    -104.0,
];

/// Overwrites one random component.
fn spoil(random: &mut Random, components: &mut [f32]) {
    if !components.is_empty() {
        components[random.below(components.len())] = random.choose(&POISON);
    }
}

/// A small cloud in which one splat in four has one to three poisoned components.
pub(crate) fn poisoned_scene(random: &mut Random, seed: u64) -> Scene {
    let degree = random.choose(&ShDegree::ALL);
    let mut scene = cloud(1 + random.below(60), degree, seed);
    let splats = &mut scene.splats;
    let stride = splats.sh_rest_stride();
    for i in 0..splats.len() {
        if random.below(4) != 0 {
            continue;
        }
        for _ in 0..=random.below(3) {
            match random.below(6) {
                0 => spoil(random, &mut splats.positions[i]),
                1 => spoil(random, &mut splats.log_scales[i]),
                2 => spoil(random, &mut splats.rotations[i]),
                3 => spoil(random, &mut splats.opacity_logits[i..=i]),
                4 => spoil(random, &mut splats.sh_dc[i]),
                _ => spoil(random, &mut splats.sh_rest[i * stride..(i + 1) * stride]),
            }
        }
    }
    scene.deformation = match random.below(4) {
        0 => Some(sliding_network(&HeadBiases::default())),
        1 => {
            let mut biases = HeadBiases::default();
            match random.below(3) {
                0 => spoil(random, &mut biases.position),
                1 => spoil(random, &mut biases.rotation),
                _ => spoil(random, &mut biases.scale),
            }
            Some(constant_network(&biases))
        }
        _ => None,
    };
    scene
}

/// A camera around the cloud, sometimes inside it, in a small odd frame.
pub(crate) fn any_camera(random: &mut Random) -> Camera {
    let mut camera = cloud_camera(20 + random.below(40) as u32, 15 + random.below(40) as u32);
    let nearer = random.between(-3.6, 1.0);
    camera.world_to_camera.w_axis.z += f64::from(nearer);
    camera
}
