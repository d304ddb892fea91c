//! Scenes to write and read back.

use fastrand::Rng;
use trapeze_scene::{Features, Scene, ShDegree, Splats};

/// Splats with values as they are in captures, the same for the same seed.
pub(crate) fn random_scene(count: usize, sh_degree: ShDegree, seed: u64) -> Scene {
    let mut rng = Rng::with_seed(seed);
    let mut between = |low: f32, high: f32| low + (high - low) * rng.f32();
    let mut three = |low: f32, high: f32| -> Vec<[f32; 3]> {
        (0..count).map(|_| std::array::from_fn(|_| between(low, high))).collect()
    };
    let (positions, log_scales, sh_dc) = (three(-5.0, 5.0), three(-8.0, 1.0), three(-1.7, 1.7));
    Scene::from_splats(Splats {
        positions,
        log_scales,
        rotations: (0..count).map(|_| std::array::from_fn(|_| between(-1.0, 1.0))).collect(),
        opacity_logits: (0..count).map(|_| between(-5.0, 5.0)).collect(),
        sh_dc,
        sh_rest: (0..count * sh_degree.rest_coefficients() * 3)
            .map(|_| between(-1.0, 1.0))
            .collect(),
        sh_degree,
    })
}

/// Feature vectors that tell every value apart.
pub(crate) fn numbered_features(count: usize, dimensions: usize) -> Features {
    Features { dimensions, values: (0..count * dimensions).map(|i| i as f32).collect() }
}
