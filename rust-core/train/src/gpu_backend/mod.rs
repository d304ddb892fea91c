//! Training on the GPU: parameters, gradients and moments stay there, and no step waits.
//!
//! A step is one submission: the renderer's forward pass, the loss and its gradient, a report, the
//! renderer's backward pass, Adam and the noise. The host writes two uniform blocks, records and
//! returns; in the steady state it creates nothing. Reports go into a ring on the GPU, are copied
//! out eight steps at a time and mapped without waiting; [`reports`](TrainingBackend::reports) waits
//! for one submission, and only when the GPU is further behind than the step that is asked for.
//!
//! Tile entries that do not fit halt the run on the GPU (see
//! [`trapeze_gpu::DifferentiableRenderer`]): the step and all after it change nothing until the host,
//! which hears of it a few steps later, has made room and given the orders since then again. Orders
//! are pure functions of the state, so the result is that of a run with enough room.
//!
//! A scene that moves has two passes more: the network deforms the splats before they are drawn, and
//! takes the gradients back to the canonical splats and to its weights
//! ([`trapeze_gpu::DifferentiableDeformation`]); Adam updates both. What waits there is a look at the
//! splats that may rest ([`look`](TrainingBackend::look)), a few dozen times in a run.
//!
//! The twins of the kernels are the CPU's: tests compare each of them.

mod densify_stage;
mod device;
mod kernels;
mod layout;
mod look;
mod loss_stage;
mod memory;
mod network_stage;
mod options;
mod orders;
mod record;
mod reports;
mod splats;
mod targets;
#[cfg(test)]
mod tests;
mod timing;
mod update_stage;
mod waiting;

use std::sync::Arc;

use trapeze_gpu::{Created, ForwardSettings, Gpu, GpuError, ParameterBuffers};
use trapeze_scene::deformation::RestingSplats;
use trapeze_scene::{Camera, DeformationNetwork, Frame, FrameSettings, ShDegree};

use crate::backend::{BackendError, StepReport, TrainingBackend, TrainingView};
use crate::loss::TargetImage;
use crate::report_queue::ReportQueue;
use crate::rest::Look;
use crate::schedule::{DensifyPlan, StepPlan};
use crate::{TrainedNetwork, TrainingState};
use device::{DeviceSide, Run};
pub use memory::GpuMemoryPlan;
use network_stage::NetworkStage;
pub use options::GpuBackendOptions;
use orders::{Order, OrderLog, StepOrder};
use targets::ResidentTargets;
pub use timing::GpuStepTimes;

/// Trains on a GPU.
pub struct GpuBackend {
    options: GpuBackendOptions,
    device: DeviceSide,
    /// What [`load`](TrainingBackend::load) brought.
    run: Option<Run>,
    targets: ResidentTargets,
    log: OrderLog,
    /// Reports that have arrived and were not asked for yet.
    ready: ReportQueue,
    /// Steps taken.
    step: u32,
    waits: u64,
    halts: u64,
}

impl GpuBackend {
    /// A backend without splats on an open device; [`load`](TrainingBackend::load) brings them. After
    /// the device was lost, `load` opens another with the same options.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] when the device has no room for anything.
    pub fn new(gpu: &Gpu, options: GpuBackendOptions) -> Result<Self, GpuError> {
        Ok(Self {
            device: DeviceSide::new(gpu.clone())?,
            run: None,
            targets: ResidentTargets::new(options.target_budget),
            log: OrderLog::default(),
            ready: ReportQueue::default(),
            step: 0,
            waits: 0,
            halts: 0,
            options,
        })
    }

    /// The device that it trains on.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        &self.device.gpu
    }

    /// The splats as they are on the device, posed at `time` when a network moves them: a renderer on
    /// the same [`Gpu`] can draw them without a copy, until the next step is asked for. `None` before
    /// [`load`](TrainingBackend::load).
    ///
    /// # Errors
    /// [`BackendError`] when the device fails.
    pub fn resident_splats(&mut self, time: f32) -> Result<Option<ParameterBuffers>, BackendError> {
        let Some(run) = &mut self.run else { return Ok(None) };
        let mut encoder = self.device.gpu.device().create_command_encoder(&Default::default());
        let posed = run.record_pose(&mut encoder, time).map_err(backend_error)?;
        if run.network.is_some() {
            self.device.submit(encoder);
        }
        Ok(Some(posed))
    }

    /// Times that reports had to be waited for.
    #[must_use]
    pub fn report_waits(&self) -> u64 {
        self.waits
    }

    /// Times that steps were repeated because tile entries had not fitted.
    #[must_use]
    pub fn halts(&self) -> u64 {
        self.halts
    }

    /// Objects that were created on the device, and waits for all of its work.
    #[must_use]
    pub fn created(&self) -> Created {
        self.device.gpu.created()
    }

    /// What the run takes on the device.
    #[must_use]
    pub fn memory_plan(&self) -> Option<GpuMemoryPlan> {
        let run = self.run.as_ref()?;
        let splats = &run.splats.parameters;
        self.plan(splats.capacity, splats.sh_degree, run.network.as_ref().map(NetworkStage::form))
            .ok()
    }

    fn plan(
        &self,
        capacity: u32,
        degree: ShDegree,
        network: Option<&DeformationNetwork>,
    ) -> Result<GpuMemoryPlan, GpuError> {
        let plan = GpuMemoryPlan::new(capacity, degree, self.options.target_budget);
        match network {
            None => Ok(plan),
            Some(network) => plan.with_network(network, capacity, self.options.activation_budget),
        }
    }

    /// Errors when nothing can be asked of the device.
    fn check_device(&self) -> Result<(), BackendError> {
        self.device.gpu.check().map_err(backend_error)?;
        if self.run.is_none() {
            return Err(BackendError::Render("no splats were loaded".into()));
        }
        Ok(())
    }

    /// Gives an order, and remembers it until it is known to have been carried out.
    fn give(&mut self, order: Order) -> Result<(), BackendError> {
        self.check_device()?;
        let splats = self.splat_count();
        let result = match &order {
            Order::Step(step) => self.record_step(step),
            Order::Densify(plan, step) => self.record_densify(plan, *step),
        };
        match result {
            Ok(()) => {
                self.log.push(splats, order);
                Ok(())
            }
            Err(error) => {
                self.run = None;
                Err(match (error, order) {
                    (GpuError::Scene(error), Order::Step(step)) => {
                        BackendError::View { id: step.view.id, reason: error.to_string() }
                    }
                    (error, _) => backend_error(error),
                })
            }
        }
    }

    fn has_resting(&self) -> bool {
        let network = self.run.as_ref().and_then(|run| run.network.as_ref());
        network.is_some_and(|network| network.resting().is_some())
    }

    /// Opens the device again after it was lost.
    fn reopen(&mut self) -> Result<(), BackendError> {
        self.run = None;
        self.targets.clear();
        let open = || DeviceSide::new(self.device.gpu.reopened()?);
        self.device = open().map_err(backend_error)?;
        Ok(())
    }
}

impl TrainingBackend for GpuBackend {
    fn working_bytes(&self, splats: u32, pixels: u64) -> u64 {
        memory::working_bytes(splats, pixels)
    }

    fn network_working_bytes(&self, splats: u32) -> u64 {
        let network = TrainedNetwork::standard(0).network;
        NetworkStage::bytes(&network, splats, self.options.activation_budget).unwrap_or(u64::MAX)
    }

    fn target_budget(&self) -> u64 {
        self.options.target_budget
    }

    fn load(&mut self, state: TrainingState, capacity: u32) -> Result<(), BackendError> {
        self.log.clear();
        self.ready.clear();
        let DeviceSide { gpu, reports, .. } = &mut self.device;
        let idle = gpu.check().and_then(|()| gpu.wait()).and_then(|()| reports.discard());
        if idle.is_err() {
            self.reopen()?;
        }
        let capacity = capacity.max(state.splats.len() as u32);
        let degree = state.splats.sh_degree;
        let network = state.network.as_ref().map(|trained| &trained.network);
        let plan = self.plan(capacity, degree, network).map_err(backend_error)?;
        plan.check(capacity, self.options.memory_budget)?;
        let last = self.run.take();
        let loaded = device::load(&mut self.device, last, &state, capacity, &self.options);
        self.run = Some(loaded.map_err(backend_error)?);
        self.targets.unbind();
        self.step = state.step;
        Ok(())
    }

    fn state(&mut self) -> Result<TrainingState, BackendError> {
        self.settle()?;
        let Some(run) = &self.run else { return Ok(TrainingState::default()) };
        let mut state = run.splats.read(&self.device.gpu, self.step).map_err(backend_error)?;
        let network = run.network.as_ref().map(NetworkStage::read).transpose();
        state.network = network.map_err(backend_error)?;
        state.resting = run.network.as_ref().and_then(|stage| stage.resting().cloned());
        Ok(state)
    }

    fn has_target(&self, view: u32) -> bool {
        self.targets.contains(view)
    }

    fn admit_target(&mut self, view: u32, target: Arc<TargetImage>) -> Result<(), BackendError> {
        self.targets.admit(&self.device.gpu, view, &target)
    }

    fn step(&mut self, plan: &StepPlan, view: &TrainingView) -> Result<(), BackendError> {
        let missing = BackendError::MissingTarget { id: view.id };
        let target = self.targets.get(view.id).ok_or(missing)?.target.clone();
        let size = [view.camera.width, view.camera.height];
        if size != target.size {
            let [width, height] = target.size;
            let reason = format!("expected {width} x {height} pixels, found {size:?}");
            return Err(BackendError::View { id: view.id, reason });
        }
        if self.device.reports.is_full() {
            self.waits += 1;
            self.device.reports.wait_for_oldest(&self.device.gpu).map_err(backend_error)?;
            self.collect()?;
        }
        let order = StepOrder { plan: plan.clone(), view: view.clone(), target };
        self.give(Order::Step(Box::new(order)))
    }

    fn densify(&mut self, plan: &DensifyPlan) -> Result<(), BackendError> {
        // Steps that would have to be repeated need the splats to rest that rested in them.
        if self.has_resting() {
            self.settle()?;
            self.rest(None)?;
        }
        self.give(Order::Densify(*plan, self.step))
    }

    fn splat_count(&self) -> u32 {
        self.run.as_ref().map_or(0, |run| run.splats.count())
    }

    fn reports(&mut self, step: u32) -> Result<Vec<StepReport>, BackendError> {
        self.check_device()?;
        self.wait_for(step)?;
        Ok(self.ready.take_up_to(step))
    }

    fn look(&mut self, times: &[f32]) -> Result<Look, BackendError> {
        self.settle()?;
        self.rest(None)?;
        let Some(run) = &mut self.run else { return Ok(Look::default()) };
        look::look(&mut self.device, run, times).map_err(backend_error)
    }

    fn rest(&mut self, resting: Option<RestingSplats>) -> Result<(), BackendError> {
        self.check_device()?;
        let Some(network) = self.run.as_mut().and_then(|run| run.network.as_mut()) else {
            return Ok(());
        };
        network.rest(resting).map_err(backend_error)
    }

    fn opacity_gradient(
        &mut self,
        view: &TrainingView,
        sh_degree: ShDegree,
        by_image: &[[f32; 4]],
    ) -> Result<Vec<f32>, BackendError> {
        self.settle()?;
        let size = [view.camera.width, view.camera.height];
        let pixels = size[0] as usize * size[1] as usize;
        if by_image.len() != pixels {
            let reason = format!("expected {pixels} pixels, found {}", by_image.len());
            return Err(BackendError::View { id: view.id, reason });
        }
        let Some(run) = &mut self.run else { return Ok(Vec::new()) };
        let device = &mut self.device;
        let replaced = device.loss.prepare(&device.gpu, size).map_err(backend_error)?;
        if run.bind_image(device, replaced) {
            self.targets.unbind();
        }
        let settings = ForwardSettings { max_sh_degree: sh_degree, depth: false };
        run.opacity_gradient(device, view, settings, by_image).map_err(backend_error)
    }

    fn render(&mut self, camera: &Camera, settings: &FrameSettings) -> Result<Frame, BackendError> {
        self.settle()?;
        let Some(run) = &mut self.run else { return Ok(Frame::default()) };
        let forward =
            ForwardSettings { max_sh_degree: settings.max_sh_degree, depth: settings.depth };
        let mut encoder = self.device.gpu.device().create_command_encoder(&Default::default());
        let posed = run.record_pose(&mut encoder, settings.time).map_err(backend_error)?;
        self.device.submit(encoder);
        let result = run.renderer.forward_and_wait(&posed, camera, forward);
        result.map(|(frame, _)| frame).map_err(backend_error)
    }
}

/// What a fault of the device means for a run.
fn backend_error(error: GpuError) -> BackendError {
    match error {
        GpuError::DeviceLost(reason) | GpuError::Device(reason) => BackendError::DeviceLost(reason),
        GpuError::OutOfMemory { what, need, have } => {
            BackendError::OutOfMemory { what: what.into(), needed: need, available: have }
        }
        other => BackendError::Render(other.to_string()),
    }
}
