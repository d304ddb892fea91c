//! What each stage of a step takes on the GPU.

use std::time::Duration;

use trapeze_gpu::compute::read;
use trapeze_gpu::{
    DeformationTimes, ForwardSettings, Gpu, GpuError, ImageGradientBuffers, PassTimes,
};

use super::loss_stage::record_loss;
use super::targets::GpuTarget;
use super::{GpuBackend, backend_error};
use crate::backend::{BackendError, TrainingView};
use crate::schedule::StepPlan;

/// Time that each part of a step took on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GpuStepTimes {
    /// The renderer's two passes, stage by stage.
    pub passes: PassTimes,
    /// The deformation network's two passes, kernel by kernel; zero in a static scene.
    pub deform: DeformationTimes,
    /// Loss, its gradient and the report.
    pub loss: Duration,
    /// Adam, regularisers and noise.
    pub update: Duration,
}

impl GpuStepTimes {
    /// The sum of the stages, without what is between them.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.passes.total() + self.deform.total() + self.loss + self.update
    }
}

/// A pair of timestamps for each of a few passes.
struct PassTimer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    count: u32,
}

impl PassTimer {
    /// `None` where the device has no timestamps.
    fn new(gpu: &Gpu, passes: u32) -> Result<Option<Self>, GpuError> {
        if !gpu.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Ok(None);
        }
        let count = 2 * passes;
        let queries = gpu.device().create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("passes"),
            ty: wgpu::QueryType::Timestamp,
            count,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = gpu.buffer("timestamps", u64::from(count) * 8, usage)?;
        Ok(Some(Self { queries, resolved, count }))
    }

    fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..self.count, &self.resolved, 0);
    }

    /// Waits for the times of all passes.
    fn read(&self, gpu: &Gpu) -> Result<Vec<Duration>, GpuError> {
        let ticks: Vec<u64> = read(gpu, &self.resolved, u64::from(self.count))?;
        let period = f64::from(gpu.queue().get_timestamp_period());
        let (pairs, _) = ticks.as_chunks::<2>();
        let time = |&[from, to]: &[u64; 2]| {
            Duration::from_nanos((to.saturating_sub(from) as f64 * period) as u64)
        };
        Ok(pairs.iter().map(time).collect())
    }
}

/// Begins a pass; with a query set, its start and end go to queries 2·pass and 2·pass + 1.
pub(super) fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &'static str,
    timestamps: Option<(&wgpu::QuerySet, u32)>,
) -> wgpu::ComputePass<'a> {
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some(label),
        timestamp_writes: timestamps.map(|(query_set, pass)| wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(2 * pass),
            end_of_pass_write_index: Some(2 * pass + 1),
        }),
    })
}

impl GpuBackend {
    /// Takes the step of a plan apart and returns what each stage took; `None` where the device cannot
    /// tell. It waits, and the state changes as by a step that nobody reports: for benchmarks, when a
    /// run is over.
    ///
    /// # Errors
    /// Those of [`step`](crate::backend::TrainingBackend::step).
    pub fn time_stages(
        &mut self,
        plan: &StepPlan,
        view: &TrainingView,
    ) -> Result<Option<GpuStepTimes>, BackendError> {
        self.settle()?;
        let missing = BackendError::MissingTarget { id: view.id };
        let target = self.targets.get(view.id).ok_or(missing)?.target.clone();
        let times = self.timed(plan, view, &target);
        times.map_err(backend_error)
    }

    fn timed(
        &mut self,
        plan: &StepPlan,
        view: &TrainingView,
        target: &GpuTarget,
    ) -> Result<Option<GpuStepTimes>, GpuError> {
        let (device, Some(run)) = (&mut self.device, &mut self.run) else { return Ok(None) };
        device.loss.prepare(&device.gpu, target.size)?;
        let (canonical, gradients) = (run.splats.parameters.clone(), run.splats.gradients.clone());
        let mut network = run.network.as_mut().zip(plan.network);
        let (mut deform, drawn) = match &mut network {
            None => (DeformationTimes::default(), canonical.clone()),
            Some((network, _)) => {
                let (times, drawn) = network.timed_forward(&canonical, plan.time_of(view))?;
                let Some(times) = times else { return Ok(None) };
                (times, drawn)
            }
        };
        let by_image = ImageGradientBuffers { color: &device.loss.gradient, expected_depth: None };
        let settings = ForwardSettings { max_sh_degree: plan.sh_degree, depth: false };
        let passes =
            run.renderer.timed_passes(&drawn, &view.camera, settings, by_image, &gradients)?;
        let Some(passes) = passes else { return Ok(None) };
        if let Some((network, _)) = &mut network {
            deform += network.timed_backward(&canonical, &gradients)?.unwrap_or_default();
        }
        run.bind_image(device, true);
        self.targets.unbind();
        let bind_group = device.bind_loss(run.renderer.image(), target);
        run.write_step(device, plan, target, 0);
        let Some(timer) = PassTimer::new(&device.gpu, 2)? else { return Ok(None) };
        let mut encoder = device.gpu.device().create_command_encoder(&Default::default());
        {
            let mut pass = begin(&mut encoder, "loss", Some((&timer.queries, 0)));
            record_loss(&device.kernels, &mut pass, &bind_group, target.size);
            run.record_report(&device.kernels, &mut pass);
        }
        {
            let mut pass = begin(&mut encoder, "update", Some((&timer.queries, 1)));
            run.record_update(&device.kernels, &mut pass, plan);
        }
        timer.resolve(&mut encoder);
        device.submit(encoder);
        let times = timer.read(&device.gpu)?;
        Ok(Some(GpuStepTimes { passes, deform, loss: times[0], update: times[1] }))
    }
}
