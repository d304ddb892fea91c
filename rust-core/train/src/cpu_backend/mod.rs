//! Training on the CPU: the backend that carries out every order at once.

mod targets;

use std::sync::Arc;
use std::time::{Duration, Instant};

use fearless_simd::Level;
use trapeze_cpu::{DifferentiableRenderer, ImageGradient, RendererOptions};
use trapeze_scene::{Camera, Frame, FrameSettings, Scene, Splats};

use crate::TrainingState;
use crate::backend::{BackendError, StepReport, TrainingBackend, TrainingView};
use crate::densify::densify;
use crate::loss::{ImageLoss, LossValue, TargetImage};
use crate::optimizer::apply_update;
use crate::report_queue::ReportQueue;
use crate::schedule::{DensifyPlan, StepPlan};
use targets::ResidentTargets;

/// How the CPU trains; nothing but the SIMD level changes a result, and that by rounding.
#[derive(Clone, Copy, Debug)]
pub struct CpuBackendOptions {
    /// SIMD instructions to use.
    pub level: Level,
    /// Bytes that photographs may take; the one in use stays in any case.
    pub target_budget: usize,
    /// Bytes that splats, optimiser and gradients may take.
    pub splat_budget: u64,
}

impl Default for CpuBackendOptions {
    /// The machine's best instructions, 128 MiB of photographs, 4 GiB of splats.
    fn default() -> Self {
        Self { level: Level::new(), target_budget: 128 << 20, splat_budget: 4 << 30 }
    }
}

/// Time spent in each part of the steps so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CpuStepTimes {
    /// Rendering.
    pub forward: Duration,
    /// Loss and its gradient.
    pub loss: Duration,
    /// Sums over the pixels of each splat.
    pub rasterize_backward: Duration,
    /// From these to the stored parameters.
    pub project_backward: Duration,
    /// Regularisers, optimiser and noise.
    pub update: Duration,
}

/// Trains with all threads of the current rayon pool.
pub struct CpuBackend {
    options: CpuBackendOptions,
    state: TrainingState,
    /// What is rendered: a scene of nothing but the state's splats, which are lent to it.
    scene: Scene,
    renderer: DifferentiableRenderer,
    loss: ImageLoss,
    by_image: Vec<[f32; 4]>,
    by_splats: Splats,
    targets: ResidentTargets,
    reports: ReportQueue,
    times: CpuStepTimes,
}

impl CpuBackend {
    /// A backend without splats; [`load`](TrainingBackend::load) brings them.
    #[must_use]
    pub fn new(options: CpuBackendOptions) -> Self {
        let CpuBackendOptions { level, target_budget, .. } = options;
        let renderer = RendererOptions { level, ..RendererOptions::default() };
        Self {
            options,
            state: TrainingState::default(),
            scene: Scene::default(),
            renderer: DifferentiableRenderer::new(renderer),
            loss: ImageLoss::with_level(level),
            by_image: Vec::new(),
            by_splats: Splats::default(),
            targets: ResidentTargets::new(target_budget),
            reports: ReportQueue::default(),
            times: CpuStepTimes::default(),
        }
    }

    /// Time spent in each part of the steps so far.
    #[must_use]
    pub fn step_times(&self) -> CpuStepTimes {
        self.times
    }

    /// Bytes of parameters, moments, gradients and projected splats.
    fn splat_bytes(state: &TrainingState, capacity: u32) -> u64 {
        let splats = u64::from(capacity).max(state.splats.len() as u64);
        let state_bytes = TrainingState::bytes(splats, state.splats.sh_degree);
        // Gradients are a third of a state; poses, projected splats (twice: before and after they
        // are sorted), sums and keys.
        state_bytes + state_bytes / 3 + splats * (44 + 2 * 64 + 40 + 16)
    }

    /// Renders the resident splats and carries the loss back to `by_splats`.
    fn differentiate(
        &mut self,
        plan: &StepPlan,
        view: &TrainingView,
        target: &TargetImage,
    ) -> Result<LossValue, BackendError> {
        std::mem::swap(&mut self.scene.splats, &mut self.state.splats);
        let loss = self.differentiate_scene(plan, view, target);
        std::mem::swap(&mut self.scene.splats, &mut self.state.splats);
        loss.map_err(|reason| BackendError::View { id: view.id, reason })
    }

    fn differentiate_scene(
        &mut self,
        plan: &StepPlan,
        view: &TrainingView,
        target: &TargetImage,
    ) -> Result<LossValue, String> {
        let settings = FrameSettings {
            time: view.time,
            max_sh_degree: plan.sh_degree,
            ..FrameSettings::default()
        };
        let start = Instant::now();
        let frame = self
            .renderer
            .forward(&self.scene, &view.camera, &settings)
            .map_err(|error| error.to_string())?;
        self.times.forward += start.elapsed();
        let start = Instant::now();
        self.by_image.resize(frame.color.len(), [0.0; 4]);
        let loss = self
            .loss
            .evaluate(&frame.color, target, plan.background, plan.ssim_weight, &mut self.by_image)
            .map_err(|error| error.to_string())?;
        self.times.loss += start.elapsed();
        let gradient = ImageGradient { color: &self.by_image, expected_depth: None };
        self.renderer
            .backward(&self.scene, &gradient, &mut self.by_splats)
            .map_err(|error| error.to_string())?;
        let passes = self.renderer.times();
        self.times.rasterize_backward += passes.rasterize_backward;
        self.times.project_backward += passes.project_backward;
        Ok(loss)
    }
}

impl Default for CpuBackend {
    fn default() -> Self {
        Self::new(CpuBackendOptions::default())
    }
}

impl TrainingBackend for CpuBackend {
    fn target_budget(&self) -> u64 {
        self.options.target_budget as u64
    }

    fn load(&mut self, state: &TrainingState, capacity: u32) -> Result<(), BackendError> {
        let (needed, available) = (Self::splat_bytes(state, capacity), self.options.splat_budget);
        if needed > available {
            let what =
                format!("{} splats and their optimiser", capacity.max(state.splats.len() as u32));
            return Err(BackendError::OutOfMemory { what, needed, available });
        }
        self.state.clone_from(state);
        self.reports.clear();
        Ok(())
    }

    fn state(&mut self) -> Result<TrainingState, BackendError> {
        Ok(self.state.clone())
    }

    fn has_target(&self, view: u32) -> bool {
        self.targets.get(view).is_some()
    }

    fn admit_target(&mut self, view: u32, target: Arc<TargetImage>) -> Result<(), BackendError> {
        self.targets.admit(view, target)
    }

    fn step(&mut self, plan: &StepPlan, view: &TrainingView) -> Result<(), BackendError> {
        let missing = BackendError::MissingTarget { id: view.id };
        let target = self.targets.get(view.id).ok_or(missing)?.clone();
        self.state.raise_sh_degree(plan.sh_degree);
        let loss = self.differentiate(plan, view, &target)?;
        let visible = self.renderer.visible_splats() as u32;
        let start = Instant::now();
        let not_finite =
            apply_update(self.options.level, &mut self.state, &mut self.by_splats, plan);
        self.times.update += start.elapsed();
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
        std::mem::swap(&mut self.scene.splats, &mut self.state.splats);
        let frame = self.renderer.forward(&self.scene, camera, settings).cloned();
        std::mem::swap(&mut self.scene.splats, &mut self.state.splats);
        frame.map_err(|error| BackendError::Render(error.to_string()))
    }
}
