//! A backend whose image is trivially differentiable: pixel p shows the colour of splat p mod n,
//! the same from every camera. Everything else is real: loss, optimiser, densification, the lag of
//! the reports. More splats reproduce more detail, SH bands nothing.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use fearless_simd::Level;
use trapeze_scene::{Camera, Frame, FrameSettings, SH_C0, ShDegree, sigmoid};

use crate::TrainingState;
use crate::backend::{BackendError, StepReport, TrainingBackend, TrainingView};
use crate::densify::densify;
use crate::loss::{ImageLoss, TargetImage};
use crate::optimizer::apply_update;
use crate::report_queue::ReportQueue;
use crate::schedule::{DensifyPlan, StepPlan};
use crate::zeros_like;

/// What goes wrong, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Failure {
    /// The loss is NaN while the rate of the colours is above this.
    LossAbove(f64),
    /// Parameters are skipped, once.
    SkippedOnce,
    /// The device is lost, this many times.
    DeviceLost(u32),
    /// Memory runs out, every time.
    OutOfMemory,
}

/// Failures by step, shared so that they can be set while a trainer owns the backend.
pub(super) type Failures = Arc<Mutex<BTreeMap<u32, Failure>>>;

#[derive(Default)]
pub(super) struct Mosaic {
    pub(super) state: TrainingState,
    pub(super) targets: BTreeMap<u32, Arc<TargetImage>>,
    pub(super) reports: ReportQueue,
    pub(super) loss: ImageLoss,
    pub(super) failures: Failures,
    /// Views that were shown, in order.
    pub(super) shown: Vec<u32>,
    /// Largest number of splats that was announced.
    pub(super) capacity: u32,
    /// Photographs that it keeps; `None` keeps all.
    pub(super) keeps: Option<usize>,
}

impl Mosaic {
    fn image(&self, pixels: usize) -> Vec<[f32; 4]> {
        let colors = &self.state.splats.sh_dc;
        let pixel = |p: usize| {
            let [r, g, b] = colors[p % colors.len()].map(|c| 0.5 + SH_C0 as f32 * c);
            [r, g, b, 1.0]
        };
        (0..pixels).map(pixel).collect()
    }

    fn fail(&mut self, plan: &StepPlan) -> Result<Option<Failure>, BackendError> {
        let mut failures = self.failures.lock().unwrap();
        let Some(failure) = failures.get(&plan.step).copied() else { return Ok(None) };
        match failure {
            Failure::LossAbove(_) => {}
            Failure::SkippedOnce => drop(failures.remove(&plan.step)),
            Failure::DeviceLost(times) => {
                failures.insert(plan.step, Failure::DeviceLost(times.saturating_sub(1)));
                if times > 0 {
                    self.state = TrainingState::default();
                    return Err(BackendError::DeviceLost("unplugged".into()));
                }
                return Ok(None);
            }
            Failure::OutOfMemory => {
                self.state = TrainingState::default();
                let what = "splats".into();
                return Err(BackendError::OutOfMemory { what, needed: 2, available: 1 });
            }
        }
        Ok(Some(failure))
    }
}

impl TrainingBackend for Mosaic {
    fn load(&mut self, state: TrainingState, capacity: u32) -> Result<(), BackendError> {
        assert!(capacity as usize >= state.splats.len());
        self.state = state;
        self.capacity = capacity;
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
        if self.keeps.is_some_and(|keeps| self.targets.len() >= keeps) {
            self.targets.clear();
        }
        self.targets.insert(view, target);
        Ok(())
    }

    fn step(&mut self, plan: &StepPlan, view: &TrainingView) -> Result<(), BackendError> {
        let target = self
            .targets
            .get(&view.id)
            .cloned()
            .ok_or(BackendError::MissingTarget { id: view.id })?;
        let failure = self.fail(plan)?;
        self.shown.push(view.id);
        self.state.raise_sh_degree(plan.sh_degree);
        let render = self.image(target.len());
        let mut gradient = vec![[0.0; 4]; render.len()];
        let mut loss = self
            .loss
            .evaluate(&render, &target, plan.background, plan.ssim_weight, &mut gradient)
            .map_err(|error| BackendError::View { id: view.id, reason: error.to_string() })?;
        let mut gradients = zeros_like(&self.state.splats);
        let n = self.state.splats.len();
        for (p, pixel) in gradient.iter().enumerate() {
            for c in 0..3 {
                gradients.sh_dc[p % n][c] += SH_C0 as f32 * pixel[c];
            }
        }
        let mut not_finite = apply_update(Level::new(), &mut self.state, &mut gradients, &[], plan);
        match failure {
            Some(Failure::LossAbove(rate)) if plan.rates.sh_dc > rate => loss.total = f64::NAN,
            Some(Failure::SkippedOnce) => not_finite += 5,
            _ => {}
        }
        self.reports.push(StepReport { step: plan.step, loss, not_finite, visible: n as u32 });
        Ok(())
    }

    fn densify(&mut self, plan: &DensifyPlan) -> Result<(), BackendError> {
        assert!(plan.count <= self.capacity, "{} of {}", plan.count, self.capacity);
        densify(&mut self.state, plan);
        Ok(())
    }

    fn splat_count(&self) -> u32 {
        self.state.splats.len() as u32
    }

    fn reports(&mut self, step: u32) -> Result<Vec<StepReport>, BackendError> {
        Ok(self.reports.take_up_to(step))
    }

    /// Without a splat its pixels are black.
    fn opacity_gradient(
        &mut self,
        _: &TrainingView,
        _: ShDegree,
        by_image: &[[f32; 4]],
    ) -> Result<Vec<f32>, BackendError> {
        let splats = &self.state.splats;
        let mut gradient = vec![0.0; splats.len()];
        for (p, (pixel, by)) in self.image(by_image.len()).iter().zip(by_image).enumerate() {
            let i = p % splats.len();
            let transparency = sigmoid(-f64::from(splats.opacity_logits[i])) as f32;
            gradient[i] += transparency * pixel.iter().zip(by).map(|(c, by)| c * by).sum::<f32>();
        }
        Ok(gradient)
    }

    fn render(&mut self, camera: &Camera, _: &FrameSettings) -> Result<Frame, BackendError> {
        let (width, height) = (camera.width, camera.height);
        let color = self.image(width as usize * height as usize);
        Ok(Frame { width, height, color, ..Frame::default() })
    }
}
