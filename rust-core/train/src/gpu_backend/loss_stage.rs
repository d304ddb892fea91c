//! The loss of a view on the GPU: what it needs, and its dispatches.
//!
//! # Floor
//!
//! A pixel has 16 bytes of render, 4 of photograph, 16 of gradient and 36 of derivatives, which go out
//! and come back: 108 bytes if nothing is read twice, 21 MB for a view of 504 × 378: 6 µs on a card
//! with 3.3 TB/s. The tiles' surroundings make it 26²/16² = 2.6 times the reads, most of them from
//! caches. Arithmetic is 3 channels × (4 + 3) moments × 22 taps × 1.3 = 600 multiply-adds a pixel:
//! 0.2 GFLOP, 4 µs at 60 TFLOP/s. Both dispatches should stay within a few times that.

use trapeze_gpu::compute::whole;
use trapeze_gpu::{Gpu, GpuError};

use super::kernels::TrainingKernels;
use super::layout::LOSS_TILE;
use super::targets::GpuTarget;

/// Buffers between the two passes of the loss; they grow with the largest view.
pub(super) struct LossBuffers {
    derivatives: wgpu::Buffer,
    /// ∂loss / ∂image, premultiplied r g b and alpha.
    pub(super) gradient: wgpu::Buffer,
    pub(super) tile_sums: wgpu::Buffer,
    pixels: u64,
    tiles: u64,
}

impl LossBuffers {
    /// Bytes for views of `pixels` pixels, tiles aside.
    pub(super) const BYTES_PER_PIXEL: u64 = 9 * 4 + 16;

    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            derivatives: gpu.storage("derivatives of SSIM", 0)?,
            gradient: gpu.storage("gradient by image", 0)?,
            tile_sums: gpu.storage("sums of tiles", 0)?,
            pixels: 0,
            tiles: 0,
        })
    }

    /// Makes room for a view; whether buffers were replaced.
    pub(super) fn prepare(&mut self, gpu: &Gpu, image: [u32; 2]) -> Result<bool, GpuError> {
        let [width, height] = image.map(u64::from);
        let [across, down] = image.map(|size| u64::from(size.div_ceil(LOSS_TILE)));
        let (pixels, tiles) = (width * height, across * down);
        if pixels <= self.pixels && tiles <= self.tiles {
            return Ok(false);
        }
        let (need, have) = (pixels * 9 * 4, gpu.max_binding());
        if need > have {
            let what = "derivatives of SSIM in one binding";
            return Err(GpuError::OutOfMemory { what, need, have });
        }
        self.pixels = self.pixels.max(pixels);
        self.tiles = self.tiles.max(tiles);
        self.derivatives = gpu.storage("derivatives of SSIM", self.pixels * 9 * 4)?;
        self.gradient = gpu.storage("gradient by image", self.pixels * 16)?;
        self.tile_sums = gpu.storage("sums of tiles", self.tiles * 16)?;
        Ok(true)
    }

    /// Binds a view.
    pub(super) fn bind(
        &self,
        gpu: &Gpu,
        kernels: &TrainingKernels,
        step: &wgpu::Buffer,
        render: &wgpu::Buffer,
        target: &GpuTarget,
    ) -> wgpu::BindGroup {
        kernels.loss_interface.bind(
            gpu,
            &[
                whole(step),
                whole(render),
                whole(&target.photograph),
                whole(&target.weights),
                whole(&self.derivatives),
                whole(&self.gradient),
                whole(&self.tile_sums),
            ],
        )
    }
}

/// Records both passes for a view of `image` pixels.
pub(super) fn record_loss(
    kernels: &TrainingKernels,
    pass: &mut wgpu::ComputePass<'_>,
    bind_group: &wgpu::BindGroup,
    image: [u32; 2],
) {
    let [across, down] = image.map(|size| size.div_ceil(LOSS_TILE));
    pass.set_bind_group(0, bind_group, &[]);
    pass.set_pipeline(&kernels.loss);
    pass.dispatch_workgroups(across, down, 1);
    pass.set_pipeline(&kernels.loss_backward);
    pass.dispatch_workgroups(across, down, 1);
}
