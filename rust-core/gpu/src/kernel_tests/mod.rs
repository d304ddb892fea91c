//! Kernels by themselves, on the device at hand.

mod activation;
mod metal;
mod sort;
mod trigonometry;

use crate::{Gpu, GpuError, GpuOptions};

/// A device, or none, loudly.
pub(crate) fn device() -> Option<Gpu> {
    match Gpu::open(&GpuOptions::default()) {
        Ok(gpu) => Some(gpu),
        Err(GpuError::NoAdapter { .. }) => {
            eprintln!("SKIPPED: GPU tests need a Vulkan or Metal device (mesa-vulkan-drivers)");
            None
        }
        Err(error) => panic!("{error}"),
    }
}
