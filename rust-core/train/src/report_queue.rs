//! Reports between the step that made them and the trainer that asks for them.

use std::collections::VecDeque;

use crate::backend::StepReport;

/// Reports in the order of their steps, each given once: what
/// [`TrainingBackend::reports`](crate::backend::TrainingBackend::reports) gives out.
#[derive(Clone, Debug, Default)]
pub(crate) struct ReportQueue(VecDeque<StepReport>);

impl ReportQueue {
    /// Adds the report of the newest step.
    pub(crate) fn push(&mut self, report: StepReport) {
        self.0.push_back(report);
    }

    /// Takes the reports of all steps up to and including `step`.
    pub(crate) fn take_up_to(&mut self, step: u32) -> Vec<StepReport> {
        let due = self.0.partition_point(|report| report.step <= step);
        self.0.drain(..due).collect()
    }

    /// Drops what was not taken.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}
