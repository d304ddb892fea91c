//! Random well-conditioned scenes and image gradients.

use glam::DVec3;
use trapeze_cpu::reference::ReferenceFrame;
use trapeze_scene::{Camera, Scene, ShDegree, Splats};

/// A small generator (Numerical Recipes' LCG, upper bits), enough to scatter splats.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Uniform in 0–1.
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u32 << 24) as f32
    }

    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }
}

/// Splats in a ball before the camera: visible, none opaque enough to reach the clamp of α or dark
/// enough to reach the clamp of colour, all depths apart.
pub(crate) fn scene(seed: u64, count: usize, degree: ShDegree) -> Scene {
    let mut random = Random::new(seed);
    let mut splats = Splats { sh_degree: degree, ..Splats::default() };
    for i in 0..count {
        // Depths on a jittered grid: no two swap within a difference step.
        let depth = (i as f32 + random.between(0.2, 0.8)) / count as f32 * 2.0 - 1.0;
        splats.positions.push([random.between(-0.8, 0.8), random.between(-0.6, 0.6), depth]);
        splats.log_scales.push(std::array::from_fn(|_| random.between(-3.0, -1.4)));
        splats.rotations.push(std::array::from_fn(|_| random.between(-1.0, 1.0)));
        splats.opacity_logits.push(random.between(-2.0, 2.5));
        splats.sh_dc.push(std::array::from_fn(|_| random.between(0.2, 2.0)));
        for _ in 0..splats.sh_rest_stride() {
            splats.sh_rest.push(random.between(-0.06, 0.06));
        }
    }
    Scene::from_splats(splats)
}

/// A camera that sees the ball, with an off-centre principal point.
pub(crate) fn camera(size: (u32, u32)) -> Camera {
    let eye = DVec3::new(0.3, -0.2, -3.0);
    let mut camera = Camera::look_at(eye, DVec3::new(0.05, 0.0, 0.0), DVec3::NEG_Y, 0.7, size);
    camera.cx += 1.7;
    camera.cy -= 0.9;
    camera
}

/// Weights in ±1 for every pixel and channel; zero where the frame was closer than `margin` to a
/// decision, so that no cut-off is crossed within a difference step.
pub(crate) fn image_weights(
    seed: u64,
    frame: &ReferenceFrame,
    margin: f64,
) -> (Vec<[f32; 4]>, Vec<f32>) {
    let mut random = Random::new(seed ^ 0xabcd);
    let mut color = Vec::new();
    let mut depth = Vec::new();
    for i in 0..frame.color.len() {
        let counts = f32::from(u8::from(frame.margin[i] > margin));
        color.push(std::array::from_fn(|_| random.between(-1.0, 1.0) * counts));
        let hit = f32::from(u8::from(frame.color[i][3] > 0.05));
        depth.push(random.between(-1.0, 1.0) * counts * hit);
    }
    (color, depth)
}
