//! A scene for unit tests.

use glam::Vec3;
use trapeze_scene::{Clusters, Scene, Splats};

/// Two cubes of opaque splats, red at x = −1 (id 3) and blue at x = 1 (id 8), and one stray splat
/// (id 9).
pub(crate) fn two_boxes() -> Scene {
    let mut splats = Splats::default();
    let mut ids = Vec::new();
    let mut add = |position: Vec3, color: [f32; 3], id: u32| {
        splats.positions.push(position.to_array());
        splats.log_scales.push([(0.08_f32).ln(); 3]);
        splats.rotations.push([1.0, 0.0, 0.0, 0.0]);
        splats.opacity_logits.push(4.0);
        splats.sh_dc.push(color.map(|c| (c - 0.5) / 0.282_094_8));
        ids.push(id);
    };
    for (x, color, id) in [(-1.0, [0.9, 0.1, 0.1], 3), (1.0, [0.1, 0.1, 0.9], 8)] {
        for step in 0..216 {
            let grid = Vec3::new((step % 6) as f32, (step / 6 % 6) as f32, (step / 36) as f32);
            add(Vec3::new(x, 0.0, 0.0) + (grid - 2.5) * 0.12, color, id);
        }
    }
    add(Vec3::new(0.0, 0.0, 3.0), [0.5; 3], 9);
    let colors = vec![[0.5; 3]; ids.len()];
    let clusters = Clusters::from_ids(&ids, &colors).ok();
    Scene { clusters, ..Scene::from_splats(splats) }
}
