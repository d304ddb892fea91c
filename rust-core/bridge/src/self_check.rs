//! Whether the kernels tell the truth on the device at hand.

use trapeze_gpu::{Checked, SelfCheckReport, self_check};

use crate::device::Device;
use crate::failure::{Code, Failure, guarded};
use crate::ffi::{CheckFigures, Stage};
use crate::work::Work;

/// What was drawn, and how well.
#[derive(Debug)]
pub(crate) struct SelfCheck(SelfCheckReport);

/// Draws the check scenes with every variant of the kernels.
pub(crate) fn check_device(device: &Device, work: &Work) -> Result<SelfCheck, Failure> {
    guarded(|| {
        work.step(Stage::Rendering, None)?;
        let Some(gpu) = device.gpu()? else {
            let message = "self-check: expected a graphics device, found the CPU";
            return Err(Failure::new(Code::NoDevice, message));
        };
        let report = self_check(&gpu);
        work.check()?;
        Ok(SelfCheck(report))
    })
}

impl SelfCheck {
    pub(crate) fn device_name(&self) -> String {
        self.0.device.name.clone()
    }

    pub(crate) fn count(&self) -> usize {
        self.0.checks.len()
    }

    pub(crate) fn check(&self, index: usize) -> CheckFigures {
        let check = self.0.checks.get(index);
        CheckFigures {
            psnr: check.and_then(|check| check.psnr).unwrap_or(f64::NAN),
            milliseconds: check.map_or(f64::NAN, |check| check.milliseconds),
            passed: check.is_some_and(|check| check.passed),
        }
    }

    pub(crate) fn check_name(&self, index: usize) -> String {
        match self.0.checks.get(index).map(|check| check.checked) {
            Some(Checked::Still) => "still image",
            Some(Checked::Moving) => "deformation network",
            Some(Checked::Masked) => "static mask",
            Some(Checked::HalfHarmonics) => "harmonics in 16 bits",
            Some(Checked::ByteHarmonics) => "harmonics in 8 bits",
            Some(Checked::HalfNetwork) => "network in half precision",
            None => "",
        }
        .into()
    }

    /// Why nothing could be drawn, or what drew it.
    pub(crate) fn check_note(&self, index: usize) -> Option<String> {
        let check = self.0.checks.get(index)?;
        check.error.clone().or_else(|| check.network.map(|kernel| format!("kernel {kernel}")))
    }
}
