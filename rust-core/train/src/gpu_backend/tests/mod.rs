//! The kernels against their twins on the CPU, and the backend as a whole.

mod densify;
mod loss;
mod update;

use trapeze_gpu::{Gpu, GpuError, GpuOptions};

/// A device, or none, loudly.
pub(super) fn device() -> Option<Gpu> {
    match Gpu::open(&GpuOptions::default()) {
        Ok(gpu) => Some(gpu),
        Err(GpuError::NoAdapter { .. }) => {
            eprintln!("SKIPPED: GPU tests need a Vulkan or Metal device (mesa-vulkan-drivers)");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// Records and submits one compute pass.
fn run(gpu: &Gpu, record: impl FnOnce(&mut wgpu::ComputePass<'_>)) {
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    record(&mut encoder.begin_compute_pass(&Default::default()));
    gpu.queue().submit([encoder.finish()]);
}
