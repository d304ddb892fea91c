//! What a run takes on the device, before it starts.

use trapeze_gpu::GpuError;
use trapeze_scene::{DeformationNetwork, ShDegree};

use super::densify_stage::DensifyStage;
use super::loss_stage::LossBuffers;
use super::network_stage::NetworkStage;
use super::splats::ResidentSplats;
use crate::backend::BackendError;

/// Bytes on the device, by what they are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GpuMemoryPlan {
    /// Parameters, two moments and gradients, each as large as the stored splats.
    pub splats: u64,
    /// Projected splats, drawing order, weights: what a frame and a change of the set need of each.
    pub working: u64,
    /// Tile entries, to begin with.
    pub entries: u64,
    /// Photographs, at most.
    pub targets: u64,
    /// The deformation network: parameters, moments, gradients, activations, deformed splats.
    pub network: u64,
}

/// Bytes of working memory that the renderer has for each splat: ellipse, extent and colour 48, sums
/// 48, sort pairs 16, visible and first slot 8, order and counts 8.
const RENDERER_BYTES: u64 = 128;
/// Bytes of a tile entry: sort pairs 16, splat 4, sums 40.
const ENTRY_BYTES: u64 = 60;
/// Bytes of a pixel of the image, beside those of the loss.
const IMAGE_BYTES: u64 = 16;

/// Tile entries to begin with; the buffers grow when a view needs more.
pub(super) fn initial_entries(splats: u32) -> u32 {
    splats.saturating_mul(4).saturating_add(1 << 16)
}

/// Working memory for `splats` splats and views of `pixels` pixels, tile entries included.
pub(super) fn working_bytes(splats: u32, pixels: u64) -> u64 {
    let entries = u64::from(initial_entries(splats)) * ENTRY_BYTES;
    let per_pixel = IMAGE_BYTES + LossBuffers::BYTES_PER_PIXEL;
    per_splat_bytes(splats) + entries + pixels * per_pixel
}

fn per_splat_bytes(splats: u32) -> u64 {
    u64::from(splats) * RENDERER_BYTES + DensifyStage::bytes(splats)
}

impl GpuMemoryPlan {
    /// The plan for at most `capacity` splats of `degree` and `targets` bytes of photographs.
    #[must_use]
    pub fn new(capacity: u32, degree: ShDegree, targets: u64) -> Self {
        Self {
            splats: ResidentSplats::bytes(capacity, degree),
            working: per_splat_bytes(capacity),
            entries: u64::from(initial_entries(capacity)) * ENTRY_BYTES,
            targets,
            network: 0,
        }
    }

    /// The same with a network, whose activations take at most `activation_budget` bytes.
    ///
    /// # Errors
    /// [`GpuError::Untrainable`] names what the kernels do not train.
    pub fn with_network(
        self,
        network: &DeformationNetwork,
        capacity: u32,
        activation_budget: u64,
    ) -> Result<Self, GpuError> {
        let network = NetworkStage::bytes(network, capacity, activation_budget)?;
        Ok(Self { network, ..self })
    }

    /// The sum.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.splats + self.working + self.entries + self.targets + self.network
    }

    /// Refuses what is more than `available` bytes.
    pub(super) fn check(&self, capacity: u32, available: u64) -> Result<(), BackendError> {
        if self.total() <= available {
            return Ok(());
        }
        let megabytes = |bytes: u64| bytes.div_ceil(1 << 20);
        let what = format!(
            "{capacity} splats on the GPU (parameters {} MB, working memory {}, tile entries {}, \
             photographs {}, network {})",
            megabytes(self.splats),
            megabytes(self.working),
            megabytes(self.entries),
            megabytes(self.targets),
            megabytes(self.network),
        );
        Err(BackendError::OutOfMemory { what, needed: self.total(), available })
    }
}
