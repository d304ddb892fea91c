//! Training on the f64 reference: slow, and the truth that a fast backend is held to.

use std::collections::BTreeMap;
use std::sync::Arc;

use fearless_simd::Level;
use trapeze_cpu::{ImageGradient, reference};
use trapeze_scene::{Camera, Frame, FrameSettings, Scene, Splats};

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
    /// The loss of a view and its gradient by the parameters, and how many splats had any.
    fn differentiate(
        &self,
        plan: &StepPlan,
        view: &TrainingView,
        target: &TargetImage,
    ) -> Result<(LossValue, Splats, u32), BackendError> {
        let refuse = |reason: String| BackendError::View { id: view.id, reason };
        view.camera.validate().map_err(|error| refuse(error.to_string()))?;
        let scene = Scene::from_splats(self.state.splats.clone());
        let settings = FrameSettings {
            time: view.time,
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
        let by_splats = reference::gradients(&scene, &view.camera, &settings, &gradient).splats;
        let visible = by_splats.iter().filter(|by| by.sh[0] != [0.0; 3]).count() as u32;
        let value = LossValue { l1: loss.l1, ssim: loss.ssim, total: loss.total };
        Ok((value, to_single(&by_splats, &self.state.splats), visible))
    }
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
    fn load(&mut self, state: &TrainingState, _capacity: u32) -> Result<(), BackendError> {
        self.state.clone_from(state);
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
        let (loss, mut by_splats, visible) = self.differentiate(plan, view, &target)?;
        let not_finite = apply_update(Level::baseline(), &mut self.state, &mut by_splats, plan);
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

    fn render(&mut self, camera: &Camera, settings: &FrameSettings) -> Result<Frame, BackendError> {
        camera.validate().map_err(|error| BackendError::Render(error.to_string()))?;
        let scene = Scene::from_splats(self.state.splats.clone());
        Ok(reference::render(&scene, camera, settings).to_frame())
    }
}
