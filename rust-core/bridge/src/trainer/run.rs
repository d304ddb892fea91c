//! A training run on either kind of device.

use trapeze_formats::dataset::Dataset;
use trapeze_scene::{Camera, Frame, Scene};
use trapeze_train::backend::TrainingBackend;
use trapeze_train::checkpoint::Progress;
use trapeze_train::config::TrainingConfig;
use trapeze_train::trainer::{Event, TrainError, Trainer, TrainingSummary};
use trapeze_train::{CpuBackend, GpuBackend, GpuBackendOptions, TrainerOptions};

use crate::device::Device;
use crate::failure::{Code, Failure};
use crate::ffi::Backend;

/// What is asked of a [`Trainer`], whatever it trains on.
pub(super) trait TrainingRun: Send {
    fn step(&self) -> u32;
    fn is_finished(&self) -> bool;
    fn config(&self) -> &TrainingConfig;
    fn progress(&self) -> &Progress;
    fn splat_count(&self) -> u32;
    fn summary(&self) -> TrainingSummary;
    fn advance(&mut self, observer: &mut dyn FnMut(Event)) -> Result<(), TrainError>;
    fn save(&mut self, observer: &mut dyn FnMut(Event)) -> Result<(), TrainError>;
    fn render(&mut self, camera: &Camera, time: f32) -> Result<Frame, TrainError>;
    fn scene(&mut self) -> Result<Scene, TrainError>;
}

impl<B: TrainingBackend + Send> TrainingRun for Trainer<B> {
    fn step(&self) -> u32 {
        Trainer::step(self)
    }

    fn is_finished(&self) -> bool {
        Trainer::is_finished(self)
    }

    fn config(&self) -> &TrainingConfig {
        Trainer::config(self)
    }

    fn progress(&self) -> &Progress {
        Trainer::progress(self)
    }

    fn splat_count(&self) -> u32 {
        Trainer::splat_count(self)
    }

    fn summary(&self) -> TrainingSummary {
        Trainer::summary(self)
    }

    /// One step.
    fn advance(&mut self, observer: &mut dyn FnMut(Event)) -> Result<(), TrainError> {
        Trainer::advance(self, 1, observer).map(drop)
    }

    fn save(&mut self, observer: &mut dyn FnMut(Event)) -> Result<(), TrainError> {
        Trainer::save(self, observer).map(drop)
    }

    fn render(&mut self, camera: &Camera, time: f32) -> Result<Frame, TrainError> {
        Trainer::render(self, camera, time)
    }

    fn scene(&mut self) -> Result<Scene, TrainError> {
        Trainer::scene(self)
    }
}

/// What a run trains on: the graphics device where it is worth it, or what was asked for.
pub(super) fn training_device(device: &Device, wanted: Backend) -> Result<Device, Failure> {
    if matches!(wanted, Backend::Cpu) {
        return Ok(Device::cpu());
    }
    match device.gpu()? {
        None if matches!(wanted, Backend::Gpu) => {
            let message = "training: expected a graphics device, found the CPU alone";
            Err(Failure::new(Code::NoDevice, message))
        }
        // Kernels that run on the CPU after all are slower there than the CPU's own.
        Some(gpu) if gpu.is_software() && matches!(wanted, Backend::Automatic) => Ok(Device::cpu()),
        _ => Ok(device.clone()),
    }
}

/// Begins a run on a device, or goes on with the one whose checkpoints there are: those of one kind of
/// device serve the other.
pub(super) fn resume(
    device: &Device,
    dataset: &Dataset,
    config: TrainingConfig,
    options: TrainerOptions,
) -> Result<Box<dyn TrainingRun>, Failure> {
    match device.gpu()? {
        None => Ok(Box::new(Trainer::resume(dataset, config, CpuBackend::default(), options)?)),
        Some(gpu) => {
            let limits = options.memory_limit.map_or_else(GpuBackendOptions::default, |bytes| {
                GpuBackendOptions::within(&gpu, bytes)
            });
            let backend = GpuBackend::new(&gpu, limits)?;
            Ok(Box::new(Trainer::resume(dataset, config, backend, options)?))
        }
    }
}

/// Steps from one report to the next, of `steps` steps.
pub(super) fn report_interval(device: &Device, steps: u32) -> Result<u32, Failure> {
    Ok(match device.gpu()? {
        None => (steps / 200).clamp(5, 100),
        // A report waits, renders and compares: as much as a dozen steps.
        Some(_) => (steps / 100).clamp(25, 200),
    })
}
