//! Scenes and networks for the tests of this crate. Each test uses some of them.
#![allow(dead_code)]

use trapeze_scene::deformation::{NamedTensors, Tensor};
use trapeze_scene::{DeformationNetwork, Scene, Splats};

/// Uniform pseudo-random numbers in −1 … 1 (a 64-bit linear congruential generator).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 40) as f32 / (1u32 << 23) as f32) - 1.0
    }

    pub(crate) fn vector<const N: usize>(&mut self, scale: f32) -> [f32; N] {
        std::array::from_fn(|_| self.next() * scale)
    }
}

/// Shape of a random network.
pub(crate) struct Shape {
    pub(crate) inputs: usize,
    pub(crate) width: usize,
    pub(crate) depth: usize,
    pub(crate) blender: bool,
    pub(crate) six_dof: bool,
}

pub(crate) const STANDARD: Shape =
    Shape { inputs: 84, width: 256, depth: 8, blender: false, six_dof: false };

/// A network with weights that keep the activations' size from layer to layer (He et al. 2015).
pub(crate) fn random_network(shape: &Shape, seed: u64) -> DeformationNetwork {
    let mut random = Random(seed);
    let mut tensors = NamedTensors::new();
    let mut add = |name: &str, outputs: usize, inputs: usize, gain: f32| {
        let scale = gain * (6.0 / inputs as f32).sqrt();
        let weight = (0..outputs * inputs).map(|_| random.next() * scale).collect();
        let bias = (0..outputs).map(|_| random.next() * 0.1 * gain).collect();
        let weight = Tensor { shape: vec![outputs, inputs], data: weight };
        tensors.insert(format!("{name}.weight"), weight);
        tensors.insert(format!("{name}.bias"), Tensor { shape: vec![outputs], data: bias });
    };
    let skip = shape.depth / 2 + 1;
    for i in 0..shape.depth {
        let inputs = match i {
            0 => shape.inputs,
            i if i == skip => shape.inputs + shape.width,
            _ => shape.width,
        };
        add(&format!("linear.{i}"), shape.width, inputs, 1.0);
    }
    if shape.blender {
        add("timenet.0", 256, 13, 1.0);
        add("timenet.2", 30, 256, 1.0);
    }
    let position: &[&str] =
        if shape.six_dof { &["branch_w", "branch_v"] } else { &["gaussian_warp"] };
    for name in position {
        add(name, 3, shape.width, 0.3);
    }
    add("gaussian_rotation", 4, shape.width, 0.3);
    add("gaussian_scaling", 3, shape.width, 0.05);
    DeformationNetwork::from_tensors(tensors).unwrap()
}

/// Splats all over a cube of side 2.
pub(crate) fn random_splats(n: usize, seed: u64) -> Splats {
    let mut random = Random(seed);
    Splats {
        positions: (0..n).map(|_| random.vector(1.0)).collect(),
        log_scales: (0..n).map(|_| random.vector(1.0).map(|x: f32| x - 3.0)).collect(),
        rotations: (0..n).map(|_| random.vector(1.0)).collect(),
        opacity_logits: vec![0.0; n],
        sh_dc: vec![[0.0; 3]; n],
        ..Splats::default()
    }
}

/// A scene of random splats that a random network moves.
pub(crate) fn random_scene(n: usize, shape: &Shape, seed: u64) -> Scene {
    Scene {
        deformation: Some(random_network(shape, seed)),
        ..Scene::from_splats(random_splats(n, seed + 1))
    }
}
