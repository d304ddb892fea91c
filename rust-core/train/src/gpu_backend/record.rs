//! Orders as commands of the device.

use trapeze_gpu::{ForwardSettings, GpuError, ImageGradientBuffers};

use super::loss_stage::record_loss;
use super::orders::StepOrder;
use super::splats::ResidentSplats;
use super::{GpuBackend, timing};
use crate::schedule::DensifyPlan;

impl GpuBackend {
    pub(super) fn record_step(&mut self, step: &StepOrder) -> Result<(), GpuError> {
        let StepOrder { plan, view, target } = step;
        let Some(run) = &mut self.run else { return Ok(()) };
        let device = &mut self.device;
        let mut encoder = device.gpu.device().create_command_encoder(&Default::default());
        run.raise_degree(device, plan.sh_degree, &mut encoder)?;
        let settings = ForwardSettings { max_sh_degree: plan.sh_degree, depth: false };
        let drawn = match &plan.network {
            None => run.splats.parameters.clone(),
            Some(_) => run.record_pose(&mut encoder, plan.time_of(view))?,
        };
        run.renderer.forward(&mut encoder, &drawn, &view.camera, settings)?;
        let replaced = device.loss.prepare(&device.gpu, target.size)?;
        if run.bind_image(device, replaced) {
            self.targets.unbind();
        }
        let bind = || device.bind_loss(run.renderer.image(), target);
        let bind_group = match self.targets.get(view.id) {
            Some(resident) => resident.loss.get_or_insert_with(bind).clone(),
            // Dropped since the step was first asked for.
            None => bind(),
        };
        let slot = device.reports.take_slot();
        run.write_step(device, plan, target, slot);
        {
            let mut pass = timing::begin(&mut encoder, "loss", None);
            record_loss(&device.kernels, &mut pass, &bind_group, target.size);
            run.record_report(&device.kernels, &mut pass);
        }
        let by_image = ImageGradientBuffers { color: &device.loss.gradient, expected_depth: None };
        run.renderer.backward(&mut encoder, &drawn, by_image, &run.splats.gradients)?;
        if let (Some(_), Some(network)) = (&plan.network, &mut run.network) {
            let (parameters, gradients) = (&run.splats.parameters, &run.splats.gradients);
            let mut pass = timing::begin(&mut encoder, "deform_backward", None);
            network.record_backward(&mut pass, parameters, gradients)?;
        }
        {
            let mut pass = timing::begin(&mut encoder, "update", None);
            run.record_update(&device.kernels, &mut pass, plan);
        }
        device.reports.record(&mut encoder, false);
        device.submit(encoder);
        self.step = plan.step + 1;
        Ok(())
    }

    pub(super) fn record_densify(&mut self, plan: &DensifyPlan, step: u32) -> Result<(), GpuError> {
        let Some(run) = &mut self.run else { return Ok(()) };
        let splats = run.splats.count();
        if splats == 0 {
            return Ok(());
        }
        let degree = run.splats.degree();
        let bytes = |count| ResidentSplats::bytes(count, degree);
        let (need, have) = (bytes(plan.count), bytes(run.splats.parameters.capacity));
        if need > have {
            return Err(GpuError::OutOfMemory { what: "splats", need, have });
        }
        let device = &mut self.device;
        let mut encoder = device.gpu.device().create_command_encoder(&Default::default());
        let stage = run.densify_stage(&device.gpu, &mut device.kernels)?;
        stage.record(&device.gpu, &device.kernels, &mut encoder, plan, (splats, step));
        device.submit(encoder);
        run.splats.set_count(plan.count.max(splats));
        Ok(())
    }
}
