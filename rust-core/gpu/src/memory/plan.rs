//! Bytes per buffer, from the numbers that decide them.

use serde::Serialize;
use trapeze_scene::{Scene, ShDegree};

use crate::deform::PackedWeights;
use crate::layout::{Cluster, Pose};
use crate::region::image_tiles;
use crate::sort::keys_per_thread;
use crate::tiles::PIXEL_BYTES;
use crate::{Gpu, GpuError, RendererOptions};

/// The numbers of a scene that decide what it takes on a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneSize {
    /// Splats.
    pub splats: u32,
    /// Highest SH band that is not zero.
    pub sh_degree: ShDegree,
    /// Rows of the cluster table.
    pub clusters: u32,
    /// Bytes of the deformation network's weights in single precision, as packed for the kernels.
    pub network_bytes: Option<u64>,
    /// Whether the scene has motion values.
    pub motion: bool,
}

impl SceneSize {
    /// The size of a scene.
    ///
    /// # Errors
    /// [`GpuError::Network`] when the kernels cannot evaluate its network.
    pub fn of(scene: &Scene) -> Result<Self, GpuError> {
        let packed = scene.deformation.as_ref().map(PackedWeights::new).transpose()?;
        Ok(Self {
            splats: scene.len() as u32,
            sh_degree: scene.splats.used_sh_degree(),
            clusters: scene.clusters.as_ref().map_or(0, |clusters| clusters.table.len() as u32),
            network_bytes: packed.map(|p| 4 * (p.weights.len() + p.biases.len()) as u64),
            motion: scene.motion.is_some(),
        })
    }
}

/// Buffers of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedBuffer {
    /// What they hold.
    pub name: &'static str,
    /// Bytes of all of them together.
    pub bytes: u64,
    /// Bytes of the largest binding of one of them that cannot be taken apart.
    pub binding: u64,
    /// Bytes of the largest of them.
    pub largest: u64,
}

/// What a renderer puts on the device, buffer by buffer. Uniform blocks, counters and staging
/// buffers, less than 64 KiB together, are left out, as is what the driver needs for itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MemoryPlan {
    /// The buffers, in the order of the stages.
    pub buffers: Vec<PlannedBuffer>,
}

/// Tile entries that there is room for at first.
pub(crate) fn initial_entries(splats: u32, options: &RendererOptions) -> u32 {
    let wanted =
        options.initial_entries.unwrap_or_else(|| splats.saturating_mul(4).saturating_add(1 << 16));
    wanted.min(options.max_entries.unwrap_or(u32::MAX)).max(1)
}

/// Bytes of the counts that a sort of so many pairs keeps per block.
fn block_count_bytes(pairs: u64, capacity: u32) -> u64 {
    let block = 256 * u64::from(keys_per_thread(capacity));
    pairs.div_ceil(block).max(1) * 256 * 4
}

impl MemoryPlan {
    /// The plan for a scene with these options, for images of `image` pixels, with depths and top
    /// contributors if `layers`.
    #[must_use]
    pub fn new(size: &SceneSize, options: &RendererOptions, image: [u32; 2], layers: bool) -> Self {
        let splats = size.splats.min(options.max_splats.unwrap_or(u32::MAX));
        let n = u64::from(splats);
        let degree = size.sh_degree.min(options.max_sh_degree);
        let harmonics = 4 * options.harmonics.words(degree) as u64 * n.next_multiple_of(32);
        let poses = size_of::<Pose>() as u64 * n;
        let mut buffers = Vec::new();
        let mut add = |name, count: u64, bytes: u64, windowed: bool| {
            let binding = if windowed { 0 } else { bytes };
            buffers.push(PlannedBuffer { name, bytes: count * bytes, binding, largest: bytes });
        };
        let moves = size.network_bytes.is_some();
        // The network binds its poses whole; the projection in windows.
        add("poses", 1, poses, !moves);
        add("harmonics", 1, harmonics, true);
        if size.motion {
            add("motion values", 1, 4 * n, !moves);
        }
        add("clusters", 1, size_of::<Cluster>() as u64 * u64::from(size.clusters.max(1)), false);
        if let Some(weights) = size.network_bytes {
            // Both precisions, when the second has to prove itself against the first.
            let half =
                if options.precision == crate::NetworkPrecision::Half { weights / 2 } else { 0 };
            add("network weights", 1, weights + half, false);
            add("deformed poses", 1, poses, false);
            add("list of moving splats", 1, 4 * n, false);
            if size.motion {
                add("poses at t = 0", 1, poses, false);
            }
        }
        add("projected splats", 3, 16 * n, false);
        add("depth sort", 4, 4 * n, false);
        add("depth sort counts", 1, block_count_bytes(n, splats), false);
        add("entries of groups", 1, 4 * n.div_ceil(64), false);
        let capacity = initial_entries(splats, options);
        let entries = u64::from(capacity);
        add("tile entries", 4, 4 * entries, false);
        add("tile entry counts", 2, block_count_bytes(entries, capacity), false);
        let [width, height] = image.map(u64::from);
        add("image", 1, width * height * PIXEL_BYTES, true);
        if layers {
            add("depth and top contributor", 1, width * height * PIXEL_BYTES, true);
        }
        let [across, down] = image_tiles(image).map(u64::from);
        add("tile starts", 1, 4 * (across * down + 1), false);
        Self { buffers }
    }

    /// Bytes of all buffers.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.buffers.iter().map(|buffer| buffer.bytes).sum()
    }

    /// Whether the device's limits allow each buffer.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] that names the first that they do not.
    pub fn check(&self, gpu: &Gpu) -> Result<(), GpuError> {
        let most = [gpu.max_binding(), gpu.limits().max_buffer_size];
        for buffer in &self.buffers {
            for (need, have) in [buffer.binding, buffer.largest].into_iter().zip(most) {
                if need > have {
                    return Err(GpuError::OutOfMemory { what: buffer.name, need, have });
                }
            }
        }
        Ok(())
    }
}
