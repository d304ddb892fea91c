//! Photographs on the GPU, within a byte budget.

use std::collections::VecDeque;
use std::sync::Arc;

use trapeze_gpu::{Gpu, GpuError};

use crate::backend::BackendError;
use crate::loss::{Channels, TargetImage};

/// A photograph: four bytes a pixel, and a fifth where pixels have weights.
#[derive(Debug)]
pub(super) struct GpuTarget {
    /// r g b (not premultiplied) and alpha, a byte each.
    pub(super) photograph: wgpu::Buffer,
    /// Weights of four pixels a word.
    pub(super) weights: wgpu::Buffer,
    pub(super) is_weighted: bool,
    /// Pixels across and down.
    pub(super) size: [u32; 2],
}

impl GpuTarget {
    /// Bytes that a photograph takes.
    pub(super) fn bytes(target: &TargetImage) -> u64 {
        let weights = target.mask().map_or(0, |mask| mask.len().next_multiple_of(4));
        4 * target.len() as u64 + weights as u64
    }

    pub(super) fn upload(gpu: &Gpu, target: &TargetImage) -> Result<Self, GpuError> {
        let (need, have) = (4 * target.len() as u64, gpu.max_binding());
        if need > have {
            return Err(GpuError::OutOfMemory { what: "photograph in one binding", need, have });
        }
        let pixels: Vec<u32> = match target.channels() {
            Channels::Rgb => {
                let (pixels, _) = target.pixels().as_chunks::<3>();
                pixels.iter().map(|&[r, g, b]| u32::from_le_bytes([r, g, b, 255])).collect()
            }
            Channels::Rgba => {
                let (pixels, _) = target.pixels().as_chunks::<4>();
                pixels.iter().map(|&pixel| u32::from_le_bytes(pixel)).collect()
            }
        };
        let weights: Vec<u32> = target.mask().map_or_else(Vec::new, |mask| {
            let word = |chunk: &[u8]| {
                let mut bytes = [0; 4];
                bytes[..chunk.len()].copy_from_slice(chunk);
                u32::from_le_bytes(bytes)
            };
            mask.chunks(4).map(word).collect()
        });
        Ok(Self {
            photograph: gpu.storage_of("photograph", &pixels)?,
            weights: gpu.storage_of("pixel weights", &weights)?,
            is_weighted: target.mask().is_some(),
            size: [target.width() as u32, target.height() as u32],
        })
    }
}

/// A photograph that steps have been recorded with; its buffers live as long as these do.
pub(super) struct Resident {
    pub(super) view: u32,
    bytes: u64,
    pub(super) target: Arc<GpuTarget>,
    /// The loss of this view, until a buffer that it binds is replaced.
    pub(super) loss: Option<wgpu::BindGroup>,
}

/// The photographs at hand, the latest at the back.
pub(super) struct ResidentTargets {
    budget: u64,
    bytes: u64,
    targets: VecDeque<Resident>,
}

impl ResidentTargets {
    pub(super) fn new(budget: u64) -> Self {
        Self { budget, bytes: 0, targets: VecDeque::new() }
    }

    pub(super) fn contains(&self, view: u32) -> bool {
        self.targets.iter().any(|resident| resident.view == view)
    }

    pub(super) fn get(&mut self, view: u32) -> Option<&mut Resident> {
        self.targets.iter_mut().find(|resident| resident.view == view)
    }

    /// Uploads `target`, and drops the oldest others until it fits.
    pub(super) fn admit(
        &mut self,
        gpu: &Gpu,
        view: u32,
        target: &TargetImage,
    ) -> Result<(), BackendError> {
        let bytes = GpuTarget::bytes(target);
        if bytes > self.budget {
            return Err(BackendError::OutOfMemory {
                what: format!("the photograph of view {view}"),
                needed: bytes,
                available: self.budget,
            });
        }
        if let Some(at) = self.targets.iter().position(|resident| resident.view == view) {
            self.remove(at);
        }
        while self.bytes + bytes > self.budget {
            self.remove(0);
        }
        let target = Arc::new(GpuTarget::upload(gpu, target).map_err(super::backend_error)?);
        self.bytes += bytes;
        self.targets.push_back(Resident { view, bytes, target, loss: None });
        Ok(())
    }

    /// Forgets what was bound to buffers that have been replaced.
    pub(super) fn unbind(&mut self) {
        for resident in &mut self.targets {
            resident.loss = None;
        }
    }

    pub(super) fn clear(&mut self) {
        self.targets.clear();
        self.bytes = 0;
    }

    fn remove(&mut self, at: usize) {
        if let Some(resident) = self.targets.remove(at) {
            self.bytes -= resident.bytes;
        }
    }
}
