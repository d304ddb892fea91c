//! Something that takes long: how far it is, and whether anybody still wants it.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};

use crate::failure::{Code, Failure, guarded_or};
use crate::ffi::{Stage, WorkProgress};

/// Shared by the thread that works and the one that waits: the first tells, the second cancels.
#[derive(Debug)]
pub(crate) struct Work {
    cancelled: AtomicBool,
    stage: AtomicU8,
    /// Bits of a share in 0–1; NaN where the end is not known.
    fraction: AtomicU64,
}

/// In the order of their declaration.
const STAGES: [Stage; 8] = [
    Stage::Preparing,
    Stage::Reading,
    Stage::Uploading,
    Stage::Compiling,
    Stage::Encoding,
    Stage::Rendering,
    Stage::Measuring,
    Stage::Writing,
];

impl Default for Work {
    fn default() -> Self {
        Self {
            cancelled: AtomicBool::new(false),
            stage: AtomicU8::new(0),
            fraction: AtomicU64::new(f64::NAN.to_bits()),
        }
    }
}

impl Work {
    pub(crate) fn new() -> Self {
        Self::default()
    }

    pub(crate) fn cancel(&self) {
        self.cancelled.store(true, Ordering::Release);
    }

    pub(crate) fn progress(&self) -> WorkProgress {
        guarded_or(WorkProgress { stage: Stage::Preparing, fraction: f64::NAN }, || WorkProgress {
            stage: STAGES[usize::from(self.stage.load(Ordering::Relaxed))],
            fraction: f64::from_bits(self.fraction.load(Ordering::Relaxed)),
        })
    }

    /// Tells how far the work is.
    ///
    /// # Errors
    /// [`Code::Cancelled`] when nobody wants it any more.
    pub(crate) fn step(&self, stage: Stage, fraction: Option<f64>) -> Result<(), Failure> {
        self.stage.store(stage as u8, Ordering::Relaxed);
        self.fraction.store(fraction.unwrap_or(f64::NAN).to_bits(), Ordering::Relaxed);
        self.check()
    }

    /// The same for code that is told through a [`ControlFlow`].
    pub(crate) fn flow(&self, stage: Stage, fraction: Option<f64>) -> ControlFlow<()> {
        self.step(stage, fraction).map_or(ControlFlow::Break(()), ControlFlow::Continue)
    }

    /// # Errors
    /// [`Code::Cancelled`] when nobody wants the work any more.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        if self.cancelled.load(Ordering::Acquire) { Err(Self::cancelled()) } else { Ok(()) }
    }

    pub(crate) fn cancelled() -> Failure {
        Failure::new(Code::Cancelled, "cancelled")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_is_told_as_what_it_is() {
        for (i, stage) in STAGES.into_iter().enumerate() {
            assert_eq!(stage as usize, i);
        }
    }

    #[test]
    fn news_arrive_and_a_cancelled_work_stops_at_its_next_step() {
        let work = Work::new();
        assert!(work.progress().fraction.is_nan());
        work.step(Stage::Measuring, Some(0.25)).unwrap();
        let WorkProgress { stage, fraction } = work.progress();
        assert!(matches!(stage, Stage::Measuring) && fraction == 0.25);
        work.cancel();
        let failure = work.step(Stage::Writing, None).unwrap_err();
        assert_eq!(failure.kind(), Code::Cancelled);
        assert!(work.flow(Stage::Writing, None).is_break());
    }
}
