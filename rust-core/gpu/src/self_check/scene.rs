//! A small scene that every device makes alike, bit by bit: splats of every shape, with harmonics of
//! degree 3, clusters, motion values, and a network of the usual size.

use glam::{DMat4, DVec3};
use trapeze_scene::deformation::{Encoding, Linear, PositionHead, RotationRule};
use trapeze_scene::{Camera, DeformationNetwork, Motion, Scene, ShDegree, Splats};

const SPLATS: usize = 600;
const WIDTH: usize = 256;
const DEPTH: usize = 8;
const SKIP_AFTER: usize = 4;

/// Numbers from −1 to 1 that look random (SplitMix64, the highest 24 bits: exact in f32).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }

    fn array<const N: usize>(&mut self) -> [f32; N] {
        std::array::from_fn(|_| self.next())
    }

    fn layer(&mut self, inputs: usize, outputs: usize, gain: f32) -> Linear {
        Linear {
            inputs,
            outputs,
            weight: (0..inputs * outputs).map(|_| gain * self.next()).collect(),
            bias: (0..outputs).map(|_| 0.05 * self.next()).collect(),
        }
    }
}

/// The camera of all checks.
pub(super) fn camera() -> Camera {
    Camera {
        width: 64,
        height: 48,
        fx: 55.0,
        fy: 55.0,
        cx: 31.5,
        cy: 24.25,
        world_to_camera: DMat4::from_translation(DVec3::new(0.0, 0.0, 2.5)),
    }
}

/// The scene without its network.
pub(super) fn still() -> Scene {
    let mut n = Numbers(1);
    let mut splats = Splats { sh_degree: ShDegree::Three, ..Splats::default() };
    for _ in 0..SPLATS {
        splats.positions.push(n.array());
        splats.log_scales.push(n.array().map(|x: f32| -3.0 + x));
        splats.rotations.push(n.array());
        splats.opacity_logits.push(1.0 + 3.0 * n.next());
        splats.sh_dc.push(n.array());
        splats.sh_rest.extend((0..45).map(|_| 0.2 * n.next()));
    }
    Scene::from_splats(splats)
}

/// The scene with a network that moves every splat by about a tenth.
pub(super) fn moving() -> Scene {
    let mut n = Numbers(2);
    let position_encoding = Encoding { dimensions: 3, octaves: 10 };
    let time_encoding = Encoding { dimensions: 1, octaves: 10 };
    let inputs = position_encoding.width() + time_encoding.width();
    let hidden = (0..DEPTH)
        .map(|layer| {
            let inputs = match layer {
                0 => inputs,
                layer if layer == SKIP_AFTER + 1 => inputs + WIDTH,
                _ => WIDTH,
            };
            // Keeps the size of the features from layer to layer (He et al. 2015).
            n.layer(inputs, WIDTH, (6.0 / inputs as f32).sqrt())
        })
        .collect();
    let network = DeformationNetwork {
        position_encoding,
        time_encoding,
        time_network: None,
        hidden,
        skip_after: SKIP_AFTER,
        position_head: PositionHead::Translation(n.layer(WIDTH, 3, 0.01)),
        rotation_head: n.layer(WIDTH, 4, 0.01),
        scale_head: n.layer(WIDTH, 3, 0.001),
        rotation_rule: RotationRule::Renormalised,
    };
    let motion =
        Motion { values: (0..SPLATS).map(|_| 0.5 + 0.5 * n.next()).collect(), ..Motion::default() };
    Scene { deformation: Some(network), motion: Some(motion), ..still() }
}
