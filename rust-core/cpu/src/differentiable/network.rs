//! The last stage of the way back: through the deformation network to its weights.

use trapeze_scene::deformation::RestingSplats;
use trapeze_scene::{DeformationNetwork, Scene, is_dynamic};

use super::DifferentiableRenderer;
use crate::deform_backward::{MovedSplats, OutputGradient, network_backward};

impl DifferentiableRenderer {
    /// From the gradients by the network's outputs to those by its weights: splats of one time
    /// together, those that a masked frame holds at t = 0 apart.
    pub(super) fn carry_to_network(
        &self,
        scene: &Scene,
        network: &DeformationNetwork,
        by_network: &mut [f32],
    ) {
        let Some(last) = &self.last else { return };
        let is_held = |i: usize| match (&scene.motion, last.static_threshold) {
            (Some(motion), Some(threshold)) => !is_dynamic(motion.values[i], threshold),
            _ => false,
        };
        let resting = self.resting.iter().filter(|_| last.static_threshold.is_none());
        let mut is_constant = vec![false; self.by_outputs.len()];
        for i in resting.flat_map(RestingSplats::resting) {
            is_constant[i as usize] = true;
        }
        let mut now = MovedSplats::default();
        let mut at_rest = MovedSplats::default();
        for (i, by_output) in self.by_outputs.iter().enumerate() {
            if is_constant[i] || *by_output == OutputGradient::default() {
                continue;
            }
            let splats = if is_held(i) { &mut at_rest } else { &mut now };
            let [x, y, z] = scene.splats.positions[i].map(f64::from);
            let origin = scene.origin;
            splats.positions.push([x + origin.x, y + origin.y, z + origin.z]);
            splats.by_outputs.push(*by_output);
        }
        for (time, splats) in [(f64::from(last.time), now), (0.0, at_rest)] {
            if !splats.positions.is_empty() {
                network_backward(self.options.level, network, time, &splats, by_network);
            }
        }
    }
}
