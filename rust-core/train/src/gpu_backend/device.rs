//! What lives on the device: what every run shares, and what belongs to the splats of one.

use trapeze_gpu::compute::{read, whole};
use trapeze_gpu::{
    DifferentiableRenderer, ForwardSettings, Gpu, GpuError, ImageGradientBuffers, ParameterBuffers,
};
use trapeze_scene::ShDegree;

use super::densify_stage::DensifyStage;
use super::kernels::TrainingKernels;
use super::layout::TrainingStep;
use super::loss_stage::LossBuffers;
use super::memory::initial_entries;
use super::network_stage::{NetworkStage, Place};
use super::reports::ReportRing;
use super::splats::ResidentSplats;
use super::targets::GpuTarget;
use super::update_stage::UpdateStage;
use super::{GpuBackendOptions, timing};
use crate::TrainingState;
use crate::backend::TrainingView;
use crate::schedule::StepPlan;

/// What does not depend on the splats.
pub(super) struct DeviceSide {
    pub(super) gpu: Gpu,
    pub(super) kernels: TrainingKernels,
    /// The uniform block of the step.
    pub(super) uniform: wgpu::Buffer,
    pub(super) loss: LossBuffers,
    pub(super) reports: ReportRing,
}

impl DeviceSide {
    pub(super) fn new(gpu: Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            kernels: TrainingKernels::new(&gpu),
            uniform: gpu.uniform_of("training step", &[0; size_of::<TrainingStep>()]),
            loss: LossBuffers::new(&gpu)?,
            reports: ReportRing::new(&gpu)?,
            gpu,
        })
    }

    /// Binds a view whose render is `image` to the loss.
    pub(super) fn bind_loss(&self, image: &wgpu::Buffer, target: &GpuTarget) -> wgpu::BindGroup {
        self.loss.bind(&self.gpu, &self.kernels, &self.uniform, image, target)
    }

    pub(super) fn submit(&mut self, encoder: wgpu::CommandEncoder) {
        let index = self.gpu.queue().submit([encoder.finish()]);
        self.reports.submitted(index);
    }
}

/// Splats under training, and what is bound to their buffers.
pub(super) struct Run {
    pub(super) splats: ResidentSplats,
    /// What moves the splats in time.
    pub(super) network: Option<NetworkStage>,
    pub(super) renderer: DifferentiableRenderer,
    update: UpdateStage,
    /// Made for the first change of the set.
    densify: Option<DensifyStage>,
    /// The image that is bound, and the report of its loss.
    image: Option<(wgpu::Buffer, wgpu::BindGroup)>,
}

/// Brings a state to the device, into the buffers of the last run where it fits.
pub(super) fn load(
    device: &mut DeviceSide,
    last: Option<Run>,
    state: &TrainingState,
    capacity: u32,
    options: &GpuBackendOptions,
) -> Result<Run, GpuError> {
    let gpu = &device.gpu;
    let mut reused = last.filter(|run| run.splats.parameters.capacity >= capacity);
    if let Some(run) = &mut reused
        && !run.splats.write(gpu, state)?
    {
        reused = None;
    }
    let mut run = match reused {
        Some(run) => run,
        None => Run::new(device, state, capacity, options.initial_entries)?,
    };
    run.load_network(device, state, options)?;
    let mut encoder = device.gpu.device().create_command_encoder(&Default::default());
    run.renderer.record_resume(&mut encoder);
    device.gpu.queue().submit([encoder.finish()]);
    Ok(run)
}

impl Run {
    fn new(
        device: &mut DeviceSide,
        state: &TrainingState,
        capacity: u32,
        entries: Option<u32>,
    ) -> Result<Self, GpuError> {
        let DeviceSide { gpu, kernels, uniform, reports, .. } = device;
        let splats = ResidentSplats::upload(gpu, state, capacity)?;
        let entries = entries.unwrap_or_else(|| initial_entries(capacity));
        let renderer = DifferentiableRenderer::new(gpu, capacity, entries)?;
        let counts = renderer.counts();
        let update = UpdateStage::new(gpu, kernels, &splats, uniform, counts, &reports.buffer);
        Ok(Self { splats, network: None, renderer, update, densify: None, image: None })
    }

    /// Brings the state's network to the device, into the buffers of the last one where it fits.
    fn load_network(
        &mut self,
        device: &DeviceSide,
        state: &TrainingState,
        options: &GpuBackendOptions,
    ) -> Result<(), GpuError> {
        let last = self.network.take();
        let Some(trained) = &state.network else { return Ok(()) };
        let DeviceSide { gpu, kernels, reports, .. } = device;
        let capacity = self.splats.parameters.capacity;
        if let Some(mut stage) = last
            && stage.write(gpu, trained, capacity)?
        {
            stage.rest(state.resting.clone())?;
            self.network = Some(stage);
            return Ok(());
        }
        let (counts, reports) = (self.renderer.counts(), &reports.buffer);
        let products = options.network_products.suited(gpu, &state.splats.positions);
        tracing::info!("products of the network: {products:?}");
        let place = Place {
            capacity,
            activation_budget: options.activation_budget,
            products,
            counts,
            reports,
        };
        let mut stage = NetworkStage::upload(gpu, kernels, trained, place)?;
        stage.rest(state.resting.clone())?;
        self.network = Some(stage);
        Ok(())
    }

    /// Records posing the splats at a time, and returns what to draw: the splats themselves in a static
    /// scene.
    pub(super) fn record_pose(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        time: f32,
    ) -> Result<ParameterBuffers, GpuError> {
        let canonical = &self.splats.parameters;
        let Some(network) = &mut self.network else { return Ok(canonical.clone()) };
        network.record_forward(&mut timing::begin(encoder, "deform", None), canonical, time)
    }

    /// Waits for the gradient by opacity logits of a view, in the buffers of a step: the image's gradient
    /// in that of the loss, which has its size.
    pub(super) fn opacity_gradient(
        &mut self,
        device: &mut DeviceSide,
        view: &TrainingView,
        settings: ForwardSettings,
        by_image: &[[f32; 4]],
    ) -> Result<Vec<f32>, GpuError> {
        let mut encoder = device.gpu.device().create_command_encoder(&Default::default());
        let posed = self.record_pose(&mut encoder, view.time)?;
        device.submit(encoder);
        self.renderer.forward_and_wait(&posed, &view.camera, settings)?;
        device.gpu.write(&device.loss.gradient, by_image)?;
        let by_image = ImageGradientBuffers { color: &device.loss.gradient, expected_depth: None };
        let mut encoder = device.gpu.device().create_command_encoder(&Default::default());
        self.renderer.backward(&mut encoder, &posed, by_image, &self.splats.gradients)?;
        device.submit(encoder);
        read(&device.gpu, &self.splats.gradients.opacity_logits, self.splats.count().into())
    }

    /// Records more SH bands, where `degree` has them.
    pub(super) fn raise_degree(
        &mut self,
        device: &mut DeviceSide,
        degree: ShDegree,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), GpuError> {
        if degree <= self.splats.degree() {
            return Ok(());
        }
        let DeviceSide { gpu, kernels, uniform, reports, .. } = device;
        self.splats.raise_degree(gpu, kernels, degree, encoder)?;
        let (splats, counts) = (&self.splats, self.renderer.counts());
        self.update = UpdateStage::new(gpu, kernels, splats, uniform, counts, &reports.buffer);
        self.densify = None;
        Ok(())
    }

    pub(super) fn densify_stage(
        &mut self,
        gpu: &Gpu,
        kernels: &mut TrainingKernels,
    ) -> Result<&DensifyStage, GpuError> {
        let stage = match self.densify.take() {
            Some(stage) => stage,
            None => DensifyStage::new(gpu, kernels, &self.splats, self.renderer.counts())?,
        };
        Ok(self.densify.insert(stage))
    }

    /// Binds the report to the buffers of the image and of the loss, where these have been
    /// `replaced`; whether something was.
    pub(super) fn bind_image(&mut self, device: &DeviceSide, replaced: bool) -> bool {
        let image = self.renderer.image();
        if !replaced && self.image.as_ref().is_some_and(|(bound, _)| bound == image) {
            return false;
        }
        let bind_group = device.kernels.report_interface.bind(
            &device.gpu,
            &[
                whole(&device.uniform),
                whole(&device.loss.tile_sums),
                whole(self.renderer.counts()),
                whole(&device.reports.buffer),
            ],
        );
        self.image = Some((image.clone(), bind_group));
        true
    }

    /// Writes the uniform blocks of a step, before the next submission; its report goes to `slot`.
    pub(super) fn write_step(
        &self,
        device: &DeviceSide,
        plan: &StepPlan,
        target: &GpuTarget,
        slot: u32,
    ) {
        let splats = self.splats.count();
        let numbers = TrainingStep::new(plan, splats, target.size, target.is_weighted, slot);
        device.gpu.queue().write_buffer(&device.uniform, 0, bytemuck::bytes_of(&numbers));
        if let (Some(step), Some(network)) = (&plan.network, &self.network) {
            network.write_step(&device.gpu, step, slot);
        }
    }

    pub(super) fn record_report(
        &self,
        kernels: &TrainingKernels,
        pass: &mut wgpu::ComputePass<'_>,
    ) {
        if let Some((_, bind_group)) = &self.image {
            pass.set_pipeline(&kernels.report);
            pass.set_bind_group(0, bind_group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        }
    }

    pub(super) fn record_update(
        &self,
        kernels: &TrainingKernels,
        pass: &mut wgpu::ComputePass<'_>,
        plan: &StepPlan,
    ) {
        self.update.record(kernels, pass, self.splats.count(), plan.noise.is_some());
        if let (Some(_), Some(network)) = (&plan.network, &self.network) {
            network.record_update(kernels, pass);
        }
    }

    /// Makes room for a view that needed `entries`, and ends the halt.
    pub(super) fn make_room(&mut self, gpu: &Gpu, entries: u32) -> Result<(), GpuError> {
        self.renderer.make_room(entries)?;
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        self.renderer.record_resume(&mut encoder);
        gpu.queue().submit([encoder.finish()]);
        Ok(())
    }

    /// Makes the buffers larger before they are full. When they cannot grow, nothing is lost: a view
    /// that needs more says so.
    pub(super) fn grow_ahead(&mut self, entries: u32) {
        let capacity = u64::from(self.renderer.entry_capacity());
        if u64::from(entries) * 4 > capacity * 3
            && let Err(error) = self.renderer.make_room(entries.saturating_mul(3) / 2)
        {
            tracing::debug!("tile entries stay at {capacity}: {error}");
        }
    }
}
