//! Scenes made splat by splat.

use glam::{DMat4, DVec3};
use trapeze_scene::{Camera, Scene, ShDegree, Splats};

use crate::Random;

/// One splat as it is stored, to be changed field by field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Centre, world units.
    pub position: [f32; 3],
    /// Natural logarithms of the standard deviations.
    pub log_scale: [f32; 3],
    /// Quaternion (w, x, y, z).
    pub rotation: [f32; 4],
    /// Opacity before the logistic function.
    pub logit: f32,
    /// SH coefficient of band 0, r g b.
    pub dc: [f32; 3],
}

impl Default for Splat {
    /// Two units in front of a camera at the origin, 0.2 across, half transparent, grey-blue.
    fn default() -> Self {
        Self {
            position: [0.0, 0.0, 2.0],
            log_scale: [0.2f32.ln(); 3],
            rotation: [1.0, 0.0, 0.0, 0.0],
            logit: 0.0,
            dc: [0.4, 0.9, 1.3],
        }
    }
}

/// A static scene of SH degree 0.
#[must_use]
pub fn scene_of(splats: &[Splat]) -> Scene {
    Scene::from_splats(Splats {
        positions: splats.iter().map(|s| s.position).collect(),
        log_scales: splats.iter().map(|s| s.log_scale).collect(),
        rotations: splats.iter().map(|s| s.rotation).collect(),
        opacity_logits: splats.iter().map(|s| s.logit).collect(),
        sh_dc: splats.iter().map(|s| s.dc).collect(),
        sh_rest: Vec::new(),
        sh_degree: ShDegree::Zero,
    })
}

/// Random splats all over a cube of side 2, with harmonics up to `degree`.
#[must_use]
pub fn cloud(n: usize, degree: ShDegree, seed: u64) -> Scene {
    let mut random = Random::new(seed);
    let splats: Vec<Splat> = (0..n)
        .map(|_| Splat {
            position: random.vector(1.0),
            log_scale: std::array::from_fn(|_| random.between(-5.0, -2.0)),
            rotation: random.vector(1.0),
            logit: random.between(-3.0, 3.0),
            dc: random.vector(1.5),
        })
        .collect();
    let mut scene = scene_of(&splats);
    scene.splats.sh_degree = degree;
    let rest = n * scene.splats.sh_rest_stride();
    scene.splats.sh_rest = (0..rest).map(|_| random.signed() * 0.3).collect();
    scene
}

/// A camera that sees all of [`cloud`] from a direction that is no axis.
#[must_use]
pub fn cloud_camera(width: u32, height: u32) -> Camera {
    let eye = DVec3::new(1.9, -1.3, -3.1);
    let mut camera = Camera::look_at(eye, DVec3::ZERO, DVec3::NEG_Y, 0.75, (width, height));
    // A principal point off the centre, as real captures have it.
    camera.cx += 0.031 * f64::from(width);
    camera.cy -= 0.017 * f64::from(height);
    camera
}

/// A camera at the origin that looks along +z; the focal length is the image height.
#[must_use]
pub fn camera_at_origin(width: u32, height: u32) -> Camera {
    Camera {
        width,
        height,
        fx: f64::from(height),
        fy: f64::from(height),
        cx: f64::from(width) / 2.0,
        cy: f64::from(height) / 2.0,
        world_to_camera: DMat4::IDENTITY,
    }
}
