//! What was heard of the orders: reports, steps that have to be repeated, and waiting for them.

use super::device::DeviceSide;
use super::reports::RawReport;
use super::{GpuBackend, backend_error};
use crate::backend::{BackendError, StepReport};

impl GpuBackend {
    /// Takes the reports that have arrived.
    pub(super) fn collect(&mut self) -> Result<(), BackendError> {
        self.device.gpu.poll().map_err(backend_error)?;
        while let Some(reports) = self.device.reports.take().map_err(backend_error)? {
            for report in reports {
                if report.halted {
                    self.repeat(&report)?;
                    break;
                }
                self.make_ready(&report);
            }
        }
        Ok(())
    }

    fn make_ready(&mut self, report: &RawReport) {
        let Some(order) = self.log.pop_step() else { return };
        let [width, height] = order.target.size.map(|size| size as usize);
        self.ready.push(StepReport {
            step: order.plan.step,
            loss: report.loss(width * height, order.plan.ssim_weight),
            not_finite: report.not_finite,
            visible: report.visible,
        });
        if let Some(run) = &mut self.run {
            run.grow_ahead(report.entries);
        }
    }

    /// Makes room for the entries of the oldest step and gives its order and all later ones again.
    fn repeat(&mut self, halted: &RawReport) -> Result<(), BackendError> {
        self.halts += 1;
        let DeviceSide { gpu, reports, .. } = &mut self.device;
        gpu.wait().map_err(backend_error)?;
        reports.discard().map_err(backend_error)?;
        let Some(run) = &mut self.run else { return Ok(()) };
        run.make_room(gpu, halted.entries).map_err(backend_error)?;
        let orders = self.log.take_from_step();
        if let Some((splats, _)) = orders.first() {
            run.splats.set_count(*splats);
        }
        orders.into_iter().try_for_each(|(_, order)| self.give(order))
    }

    /// Waits for the reports of all steps up to `step`.
    pub(super) fn wait_for(&mut self, step: u32) -> Result<(), BackendError> {
        self.collect()?;
        while self.log.waits_for(step) {
            if !self.device.reports.is_waited_for() {
                self.flush();
            }
            self.waits += 1;
            let DeviceSide { gpu, reports, .. } = &self.device;
            reports.wait_for_oldest(gpu).map_err(backend_error)?;
            self.collect()?;
        }
        Ok(())
    }

    /// Sends off the copy of reports that do not make a batch yet.
    fn flush(&mut self) {
        let device = &mut self.device;
        if device.reports.has_open() {
            let mut encoder = device.gpu.device().create_command_encoder(&Default::default());
            device.reports.record(&mut encoder, true);
            device.submit(encoder);
        }
    }

    /// Waits until every order is known to have been carried out.
    pub(super) fn settle(&mut self) -> Result<(), BackendError> {
        self.check_device()?;
        self.wait_for(u32::MAX)
    }
}
