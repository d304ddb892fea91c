//! What frames are drawn with.

use std::sync::{Arc, Mutex};

use trapeze_gpu::{Gpu, GpuError, GpuOptions};

use crate::failure::{Failure, guarded, guarded_or, poisoned};
use crate::ffi::{Backend, Stage};
use crate::work::Work;

/// The graphics device, or the CPU. Shared by every renderer; opened again when it was lost.
#[derive(Clone, Debug)]
pub(crate) struct Device {
    /// `None` draws on the CPU.
    gpu: Option<Arc<Mutex<Gpu>>>,
}

/// Opens the device and compiles its pipelines.
pub(crate) fn open_device(backend: Backend, work: &Work) -> Result<Device, Failure> {
    guarded(|| {
        work.step(Stage::Compiling, None)?;
        let gpu = match backend {
            Backend::Cpu => return Ok(Device::cpu()),
            Backend::Gpu => Some(open()?),
            Backend::Automatic => match open() {
                Ok(gpu) => Some(gpu),
                Err(error @ (GpuError::NoAdapter { .. } | GpuError::TooWeak { .. })) => {
                    tracing::warn!("{error}; drawing on the CPU");
                    None
                }
                Err(error) => return Err(error.into()),
            },
        };
        work.check()?;
        Ok(Device { gpu: gpu.map(|gpu| Arc::new(Mutex::new(gpu))) })
    })
}

/// TRAPEZE_GPU names a part of the adapter's name, as for the command line.
fn open() -> Result<Gpu, GpuError> {
    let adapter = std::env::var("TRAPEZE_GPU").ok();
    Gpu::open(&GpuOptions { adapter, ..GpuOptions::default() })
}

impl Device {
    /// The CPU.
    pub(crate) fn cpu() -> Self {
        Self { gpu: None }
    }

    pub(crate) fn name(&self) -> String {
        guarded_or(String::new(), || match self.gpu() {
            Ok(Some(gpu)) => gpu.adapter_info().name,
            _ => "CPU".into(),
        })
    }

    /// The device as it is now: another one than before when that was lost. `None` is the CPU.
    pub(crate) fn gpu(&self) -> Result<Option<Gpu>, Failure> {
        let Some(gpu) = &self.gpu else { return Ok(None) };
        let mut gpu = gpu.lock().map_err(poisoned)?;
        if gpu.is_lost() {
            *gpu = open()?;
        }
        Ok(Some(gpu.clone()))
    }
}
