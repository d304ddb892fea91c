//! Training on the f64 reference: slow, and the truth that a fast backend is held to.

use std::collections::BTreeMap;
use std::sync::Arc;

use fearless_simd::Level;
use trapeze_cpu::{ImageGradient, reference};
use trapeze_scene::{Camera, Frame, FrameSettings, Scene, ShDegree, Splats};

use crate::TrainingState;
use crate::backend::{BackendError, StepReport, TrainingBackend, TrainingView};
use crate::densify::densify;
use crate::loss::reference::reference_loss;
use crate::loss::{LossValue, TargetImage};
use crate::optimizer::apply_update;
use crate::parameters::zeros_like;
use crate::report_queue::ReportQueue;
use crate::schedule::{DensifyPlan, StepPlan};

/// Renders, compares and differentiates in double precision, pixel by pixel. Parameters and their
/// update are single precision, as everywhere.
#[derive(Default)]
pub struct ReferenceBackend {
    state: TrainingState,
    targets: BTreeMap<u32, Arc<TargetImage>>,
    reports: ReportQueue,
}

impl ReferenceBackend {
    /// The loss of a view and its gradient.
    fn differentiate(
        &self,
        plan: &StepPlan,
        view: &TrainingView,
        target: &TargetImage,
    ) -> Result<(LossValue, ReferenceGradient), BackendError> {
        let refuse = |reason: String| BackendError::View { id: view.id, reason };
        view.camera.validate().map_err(|error| refuse(error.to_string()))?;
        let scene = self.scene(plan.network.is_some());
        let settings = FrameSettings {
            time: plan.time_of(view),
            max_sh_degree: plan.sh_degree,
            ..FrameSettings::default()
        };
        let render = reference::render(&scene, &view.camera, &settings);
        let background = plan.background.map(f64::from);
        let loss = reference_loss(&render.color, target, background, f64::from(plan.ssim_weight))
            .map_err(|error| refuse(error.to_string()))?;
        let by_image: Vec<[f32; 4]> =
            loss.gradient.iter().map(|pixel| pixel.map(|g| g as f32)).collect();
        let gradient = ImageGradient { color: &by_image, expected_depth: None };
        let by = reference::gradients(&scene, &view.camera, &settings, &gradient);
        let by_network = reference::network_gradient(&scene, &settings, &by.outputs);
        let value = LossValue { l1: loss.l1, ssim: loss.ssim, total: loss.total };
        let gradient = ReferenceGradient {
            by_splats: to_single(&by.splats, &self.state.splats),
            by_network: by_network.as_ref().map_or_else(Vec::new, flat_network_gradient),
            visible: by.splats.iter().filter(|by| by.sh[0] != [0.0; 3]).count() as u32,
        };
        Ok((value, gradient))
    }

    /// The resident splats, with the network that moves them where it is asked for.
    fn scene(&self, with_network: bool) -> Scene {
        let network = self.state.network.as_ref().filter(|_| with_network);
        Scene {
            deformation: network.map(|trained| trained.network.clone()),
            ..Scene::from_splats(self.state.splats.clone())
        }
    }
}

/// Gradients of one step, rounded.
struct ReferenceGradient {
    by_splats: Splats,
    /// In the order of [`network_parameters`](crate::network_parameters).
    by_network: Vec<f32>,
    /// Splats that had any.
    visible: u32,
}

fn flat_network_gradient(gradient: &reference::NetworkGradient) -> Vec<f32> {
    let layers = gradient.layers.iter();
    layers.flat_map(|layer| layer.weight.iter().chain(&layer.bias)).map(|&g| g as f32).collect()
}

/// Gradients splat by splat as the arrays that the update takes.
fn to_single(gradients: &[reference::SplatParameters], splats: &Splats) -> Splats {
    let mut out = zeros_like(splats);
    let stride = splats.sh_rest_stride();
    for (i, by) in gradients.iter().enumerate() {
        out.positions[i] = by.position.as_vec3().to_array();
        out.log_scales[i] = by.log_scale.as_vec3().to_array();
        out.rotations[i] = by.rotation.map(|g| g as f32);
        out.opacity_logits[i] = by.opacity_logit as f32;
        out.sh_dc[i] = by.sh[0].map(|g| g as f32);
        let rest = out.sh_rest[i * stride..(i + 1) * stride].iter_mut();
        for (to, from) in rest.zip(by.sh[1..].as_flattened()) {
            *to = *from as f32;
        }
    }
    out
}

impl TrainingBackend for ReferenceBackend {
    fn load(&mut self, state: TrainingState, _capacity: u32) -> Result<(), BackendError> {
        self.state = state;
        self.reports.clear();
        Ok(())
    }

    fn state(&mut self) -> Result<TrainingState, BackendError> {
        Ok(self.state.clone())
    }

    fn has_target(&self, view: u32) -> bool {
        self.targets.contains_key(&view)
    }

    fn admit_target(&mut self, view: u32, target: Arc<TargetImage>) -> Result<(), BackendError> {
        self.targets.insert(view, target);
        Ok(())
    }

    fn step(&mut self, plan: &StepPlan, view: &TrainingView) -> Result<(), BackendError> {
        let missing = BackendError::MissingTarget { id: view.id };
        let target = self.targets.get(&view.id).ok_or(missing)?.clone();
        self.state.raise_sh_degree(plan.sh_degree);
        let (loss, mut by) = self.differentiate(plan, view, &target)?;
        let (level, visible) = (Level::baseline(), by.visible);
        let not_finite =
            apply_update(level, &mut self.state, &mut by.by_splats, &by.by_network, plan);
        self.reports.push(StepReport { step: plan.step, loss, not_finite, visible });
        Ok(())
    }

    fn densify(&mut self, plan: &DensifyPlan) -> Result<(), BackendError> {
        densify(&mut self.state, plan);
        Ok(())
    }

    fn splat_count(&self) -> u32 {
        self.state.splats.len() as u32
    }

    fn reports(&mut self, step: u32) -> Result<Vec<StepReport>, BackendError> {
        Ok(self.reports.take_up_to(step))
    }

    fn opacity_gradient(
        &mut self,
        view: &TrainingView,
        sh_degree: ShDegree,
        by_image: &[[f32; 4]],
    ) -> Result<Vec<f32>, BackendError> {
        let refuse = |reason: String| BackendError::View { id: view.id, reason };
        view.camera.validate().map_err(|error| refuse(error.to_string()))?;
        let pixels = view.camera.width as usize * view.camera.height as usize;
        if by_image.len() != pixels {
            return Err(refuse(format!("expected {pixels} pixels, found {}", by_image.len())));
        }
        let settings =
            FrameSettings { time: view.time, max_sh_degree: sh_degree, ..FrameSettings::default() };
        let gradient = ImageGradient { color: by_image, expected_depth: None };
        let by = reference::gradients(&self.scene(true), &view.camera, &settings, &gradient);
        Ok(by.splats.iter().map(|by| by.opacity_logit as f32).collect())
    }

    fn render(&mut self, camera: &Camera, settings: &FrameSettings) -> Result<Frame, BackendError> {
        camera.validate().map_err(|error| BackendError::Render(error.to_string()))?;
        Ok(reference::render(&self.scene(true), camera, settings).to_frame())
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use trapeze_scene::deformation::PositionHead;

    use super::*;
    use crate::config::{DeformationTraining, TrainingConfig};
    use crate::loss::Channels;
    use crate::{TrainedNetwork, network_parameters, set_network_parameters};

    const SIZE: (u32, u32) = (20, 14);

    /// Three splats so wide that each reaches every pixel: no pixel changes sides at a cut-off of α
    /// while a weight moves. The photograph is far from the render, so no pixel's |error| has its
    /// kink there either.
    fn backend() -> (ReferenceBackend, TrainingView) {
        let splats = Splats {
            positions: vec![[-0.4, 0.2, 0.1], [0.5, -0.1, 0.6], [0.1, 0.4, -0.5]],
            log_scales: vec![[0.2, 0.4, 0.3], [0.5, 0.1, 0.4], [0.3, 0.4, 0.6]],
            rotations: vec![[1.0, 0.2, -0.1, 0.3], [0.8, -0.3, 0.4, 0.1], [0.9, 0.1, 0.5, -0.2]],
            opacity_logits: vec![-0.4, 0.1, -0.2],
            sh_dc: vec![[0.4, 0.1, 0.2], [0.1, 0.5, 0.3], [0.3, 0.2, 0.1]],
            ..Splats::default()
        };
        let mut trained = TrainedNetwork::standard(6);
        let drawn = TrainedNetwork::standard(7).network;
        // Heads that move by a few hundredths.
        let network = &mut trained.network;
        let PositionHead::Translation(warp) = &mut network.position_head else { panic!() };
        for (head, from) in
            [warp, &mut network.rotation_head, &mut network.scale_head].into_iter().zip(1..)
        {
            let n = head.weight.len();
            head.weight.copy_from_slice(&drawn.hidden[from].weight[..n]);
        }
        let state = TrainingState { network: Some(trained), ..TrainingState::new(splats) };
        let mut backend = ReferenceBackend::default();
        backend.load(state, 3).unwrap();
        let eye = DVec3::new(0.2, -0.1, -4.0);
        let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::NEG_Y, 0.7, SIZE);
        (backend, TrainingView { id: 0, camera, time: 0.4 })
    }

    #[test]
    fn the_gradient_of_the_loss_by_weights_is_the_difference_quotient() {
        let (mut backend, view) = backend();
        let white = vec![255; (SIZE.0 * SIZE.1 * 3) as usize];
        let target = TargetImage::new(SIZE.0, SIZE.1, Channels::Rgb, white).unwrap();
        let config = TrainingConfig {
            deformation: Some(DeformationTraining {
                warm_up: 0,
                time_noise: 0.05,
                ..DeformationTraining::default()
            }),
            ..TrainingConfig::fixed(10)
        };
        let plan = config.step_plan(3, 1.0, 1.0);
        assert_ne!(plan.time_of(&view), view.time);
        let (_, gradient) = backend.differentiate(&plan, &view, &target).unwrap();
        let analytic = gradient.by_network;
        let weights = network_parameters(&backend.state.network.as_ref().unwrap().network);
        let mut loss_at = |k: usize, by: f32| {
            let mut moved = weights.clone();
            moved[k] += by;
            let trained = backend.state.network.as_mut().unwrap();
            set_network_parameters(&mut trained.network, &moved);
            let (loss, _) = backend.differentiate(&plan, &view, &target).unwrap();
            (f64::from(moved[k]), loss.total)
        };
        // Of each tensor the weight with the largest gradient.
        let network = TrainedNetwork::zeros().network;
        let mut first = 0;
        for (l, layer) in network.layers().enumerate() {
            for n in [layer.weight.len(), layer.bias.len()] {
                let of_size = |k: &usize| analytic[*k].abs();
                let k =
                    (first..first + n).max_by(|a, b| of_size(a).total_cmp(&of_size(b))).unwrap();
                first += n;
                // Weights are f32, so what was really added is measured; the third derivative's
                // h²/6 and the image gradient's rounding to f32 are both below 10⁻⁵.
                let (low, high) = (loss_at(k, -3e-4), loss_at(k, 3e-4));
                let difference = (high.1 - low.1) / (high.0 - low.0);
                let exact = f64::from(analytic[k]);
                assert!(exact != 0.0);
                assert!((difference - exact).abs() <= 1e-4 * exact.abs(), "layer {l}");
            }
        }
    }
}
