//! Training on the CPU: the backend that carries out every order at once.

mod targets;

use std::sync::Arc;
use std::time::{Duration, Instant};

use fearless_simd::Level;
use trapeze_cpu::{DifferentiableRenderer, ImageGradient, RendererOptions};
use trapeze_scene::deformation::RestingSplats;
use trapeze_scene::{Camera, Frame, FrameSettings, Scene, ShDegree, Splats};

use crate::backend::{BackendError, StepReport, TrainingBackend, TrainingView};
use crate::densify::densify;
use crate::loss::{ImageLoss, LossValue, TargetImage};
use crate::optimizer::apply_update;
use crate::report_queue::ReportQueue;
use crate::rest::{Look, look_at};
use crate::schedule::{DensifyPlan, StepPlan};
use crate::{TrainedNetwork, TrainingState};
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

/// Bytes that the network's way back takes at most: sixteen sums in the shape of the network, and
/// the activations of as many batches of 128 splats.
const NETWORK_WORKING_BYTES: u64 = 64 << 20;

/// Bytes that rendering takes for each splat at most: its pose 44, projected twice (before and after the
/// sort) 128, sort keys 16, sums 40, and for each of the three bands of the image that it may touch in the
/// mean 8 in the band's list, which may be half empty, and 64 of sums.
const WORKING_BYTES_OF_SPLAT: u64 = 44 + 128 + 16 + 40 + 3 * (2 * 8 + 64);

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
    /// Through the deformation network to its weights.
    pub deform_backward: Duration,
    /// Regularisers, optimiser and noise.
    pub update: Duration,
}

/// Trains with all threads of the current rayon pool.
pub struct CpuBackend {
    options: CpuBackendOptions,
    state: TrainingState,
    /// What is rendered: the state's splats, which are lent to it, and a copy of its network.
    scene: Scene,
    renderer: DifferentiableRenderer,
    loss: ImageLoss,
    by_image: Vec<[f32; 4]>,
    by_splats: Splats,
    by_network: Vec<f32>,
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
            by_network: Vec::new(),
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
        // are sorted), sums with the lanes that they are made in, and keys.
        let splat_bytes = state_bytes + state_bytes / 3 + splats * (44 + 2 * 64 + 40 + 64 + 16);
        // Parameters, moments, gradient, the copy that is rendered; the way back.
        let network = match state.network {
            Some(_) => 2 * TrainedNetwork::bytes() + NETWORK_WORKING_BYTES,
            None => 0,
        };
        splat_bytes + network
    }

    /// Lends the splats to the scene that is rendered, or takes them back. The network, where it is
    /// asked for, is copied: two megabytes beside the gigaflops that it takes to use it.
    fn lend(&mut self, with_network: bool) {
        std::mem::swap(&mut self.scene.splats, &mut self.state.splats);
        let network = self.state.network.as_ref().filter(|_| with_network);
        self.scene.deformation = network.map(|trained| trained.network.clone());
    }

    fn step_in_pool(&mut self, plan: &StepPlan, view: &TrainingView) -> Result<(), BackendError> {
        let missing = BackendError::MissingTarget { id: view.id };
        let target = self.targets.get(view.id).ok_or(missing)?.clone();
        self.state.raise_sh_degree(plan.sh_degree);
        let loss = self.differentiate(plan, view, &target)?;
        let visible = self.renderer.visible_splats() as u32;
        let start = Instant::now();
        let (by_splats, by_network) = (&mut self.by_splats, &self.by_network);
        let not_finite =
            apply_update(self.options.level, &mut self.state, by_splats, by_network, plan);
        self.times.update += start.elapsed();
        self.reports.push(StepReport { step: plan.step, loss, not_finite, visible });
        Ok(())
    }

    /// Renders the resident splats and carries the loss back to `by_splats`.
    fn differentiate(
        &mut self,
        plan: &StepPlan,
        view: &TrainingView,
        target: &TargetImage,
    ) -> Result<LossValue, BackendError> {
        self.lend(plan.network.is_some());
        let loss = self.differentiate_scene(plan, view, target);
        self.lend(false);
        loss.map_err(|reason| BackendError::View { id: view.id, reason })
    }

    fn differentiate_scene(
        &mut self,
        plan: &StepPlan,
        view: &TrainingView,
        target: &TargetImage,
    ) -> Result<LossValue, String> {
        let settings = FrameSettings {
            time: plan.time_of(view),
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
            .backward_with_network(
                &self.scene,
                &gradient,
                &mut self.by_splats,
                &mut self.by_network,
            )
            .map_err(|error| error.to_string())?;
        let passes = self.renderer.times();
        self.times.rasterize_backward += passes.rasterize_backward;
        self.times.project_backward += passes.project_backward;
        self.times.deform_backward += passes.deform_backward;
        Ok(loss)
    }
}

impl Default for CpuBackend {
    fn default() -> Self {
        Self::new(CpuBackendOptions::default())
    }
}

impl TrainingBackend for CpuBackend {
    fn working_bytes(&self, splats: u32, pixels: u64) -> u64 {
        WORKING_BYTES_OF_SPLAT * u64::from(splats) + 64 * pixels
    }

    fn network_working_bytes(&self, _splats: u32) -> u64 {
        NETWORK_WORKING_BYTES
    }

    fn target_budget(&self) -> u64 {
        self.options.target_budget as u64
    }

    fn load(&mut self, state: TrainingState, capacity: u32) -> Result<(), BackendError> {
        let (needed, available) = (Self::splat_bytes(&state, capacity), self.options.splat_budget);
        if needed > available {
            let what =
                format!("{} splats and their optimiser", capacity.max(state.splats.len() as u32));
            return Err(BackendError::OutOfMemory { what, needed, available });
        }
        self.renderer.set_resting(state.resting.clone());
        self.state = state;
        self.reports.clear();
        Ok(())
    }

    fn state(&mut self) -> Result<TrainingState, BackendError> {
        Ok(self.state.clone())
    }

    fn take_state(&mut self) -> Result<TrainingState, BackendError> {
        Ok(std::mem::take(&mut self.state))
    }

    fn put_back(&mut self, state: TrainingState) {
        self.state = state;
    }

    fn release(&mut self) {
        self.state = TrainingState::default();
    }

    fn has_target(&self, view: u32) -> bool {
        self.targets.get(view).is_some()
    }

    fn admit_target(&mut self, view: u32, target: Arc<TargetImage>) -> Result<(), BackendError> {
        self.targets.admit(view, target)
    }

    /// The step as a whole runs on a thread of the pool: from outside, each of its twenty parallel loops
    /// would wake a worker and wait for it to wake the caller.
    fn step(&mut self, plan: &StepPlan, view: &TrainingView) -> Result<(), BackendError> {
        rayon::scope(|_| self.step_in_pool(plan, view))
    }

    fn densify(&mut self, plan: &DensifyPlan) -> Result<(), BackendError> {
        densify(&mut self.state, plan);
        self.renderer.set_resting(None);
        Ok(())
    }

    fn splat_count(&self) -> u32 {
        self.state.splats.len() as u32
    }

    fn reports(&mut self, step: u32) -> Result<Vec<StepReport>, BackendError> {
        Ok(self.reports.take_up_to(step))
    }

    fn look(&mut self, times: &[f32]) -> Result<Look, BackendError> {
        self.rest(None)?;
        self.lend(true);
        let look = look_at(&self.scene, self.options.level, times);
        self.lend(false);
        Ok(look)
    }

    fn rest(&mut self, resting: Option<RestingSplats>) -> Result<(), BackendError> {
        self.renderer.set_resting(resting.clone());
        self.state.resting = resting;
        Ok(())
    }

    fn opacity_gradient(
        &mut self,
        view: &TrainingView,
        sh_degree: ShDegree,
        by_image: &[[f32; 4]],
    ) -> Result<Vec<f32>, BackendError> {
        self.lend(true);
        let settings =
            FrameSettings { time: view.time, max_sh_degree: sh_degree, ..FrameSettings::default() };
        let Self { renderer, scene, by_splats, .. } = self;
        let drawn = renderer.forward(scene, &view.camera, &settings).map(|_| ());
        let gradient = ImageGradient { color: by_image, expected_depth: None };
        let result = drawn.map_err(|error| error.to_string()).and_then(|()| {
            renderer.backward(scene, &gradient, by_splats).map_err(|error| error.to_string())
        });
        self.lend(false);
        result.map_err(|reason| BackendError::View { id: view.id, reason })?;
        Ok(self.by_splats.opacity_logits.clone())
    }

    fn render(&mut self, camera: &Camera, settings: &FrameSettings) -> Result<Frame, BackendError> {
        self.lend(true);
        let frame = self.renderer.forward(&self.scene, camera, settings).cloned();
        self.lend(false);
        frame.map_err(|error| BackendError::Render(error.to_string()))
    }
}
