//! Working memory of the two passes, by what its size depends on: splats, tile entries, pixels.

use crate::layout::{Region, SplatCount, counter};
use crate::project::ProjectedBuffers;
use crate::region::{self, TileRect, image_tiles};
use crate::sort::{DEPTH_SHIFTS, PairBuffers, SortPlan, keys_per_thread};
use crate::tiles::{DrawingOrder, EntryBuffers, PIXEL_BYTES};
use crate::{Gpu, GpuError};

/// One element per splat that there is room for.
#[derive(Debug)]
pub(super) struct SplatBuffers {
    pub capacity: u32,
    pub projected: ProjectedBuffers,
    /// 1 where the frame draws the splat.
    pub visible: wgpu::Buffer,
    pub first_slots: wgpu::Buffer,
    /// Three vectors of four.
    pub sums: wgpu::Buffer,
    pub pairs: PairBuffers,
    pub depth_sort: SortPlan,
    /// Blocks of the first pass of the sort, which goes over all splats.
    pub depth_blocks: u32,
    pub order: DrawingOrder,
}

/// Bytes of the sums of one splat.
const SUM_BYTES: u64 = 48;

impl SplatBuffers {
    pub(super) fn new(gpu: &Gpu, counts: &wgpu::Buffer, capacity: u32) -> Result<Self, GpuError> {
        let (sum_bytes, have) = (u64::from(capacity) * SUM_BYTES, gpu.max_binding());
        if sum_bytes > have {
            let what = "sums of all splats in one binding";
            return Err(GpuError::OutOfMemory { what, need: sum_bytes, have });
        }
        let pairs = PairBuffers::new(gpu, ["depth keys", "splats"], capacity)?;
        let sort = &gpu.kernels().sort;
        let depth_sort =
            SortPlan::new(gpu, sort, &pairs, counts, counter::VISIBLE, &DEPTH_SHIFTS, true)?;
        let sorted = &pairs.values[depth_sort.len() % 2];
        let order = DrawingOrder::new(gpu, capacity, &depth_sort, sorted, 1, counts.clone())?;
        Ok(Self {
            capacity,
            projected: ProjectedBuffers::new(gpu, capacity)?,
            visible: gpu.storage("visible", u64::from(capacity) * 4)?,
            first_slots: gpu.storage("first slots", u64::from(capacity) * 4)?,
            sums: gpu.storage("sums of splats", sum_bytes)?,
            depth_blocks: capacity.div_ceil(depth_sort.block),
            pairs,
            depth_sort,
            order,
        })
    }
}

/// Floats in the slot of an entry, with a gradient by depth.
const SLOT_FLOATS: u64 = 10;

/// Most entries that the device's limits allow.
pub(super) fn max_entries(gpu: &Gpu) -> u32 {
    (gpu.max_binding() / (SLOT_FLOATS * 4)).min(1 << 30) as u32
}

/// One element per tile entry that there is room for.
#[derive(Debug)]
pub(super) struct SlotBuffers {
    pub entries: EntryBuffers,
    pub slot_splats: wgpu::Buffer,
    /// Sums of each entry.
    pub slots: wgpu::Buffer,
}

impl SlotBuffers {
    pub(super) fn new(gpu: &Gpu, counts: &wgpu::Buffer, capacity: u32) -> Result<Self, GpuError> {
        Ok(Self {
            entries: EntryBuffers::new(gpu, &gpu.kernels().sort, counts, capacity)?,
            slot_splats: gpu.storage("splats of slots", u64::from(capacity) * 4)?,
            slots: gpu.storage("slots", u64::from(capacity) * SLOT_FLOATS * 4)?,
        })
    }

    pub(super) fn capacity(&self) -> u32 {
        self.entries.pairs.capacity
    }
}

/// The image and what goes with it; buffers only grow.
#[derive(Debug)]
pub(super) struct ImageBuffers {
    pub size: [u32; 2],
    pub image: wgpu::Buffer,
    /// Depths; small until they are asked for.
    pub layers: wgpu::Buffer,
    pub by_depth_sums: wgpu::Buffer,
    pub tile_starts: wgpu::Buffer,
    pub region: wgpu::Buffer,
    pixels: u64,
    depth_pixels: u64,
    tiles: u32,
    /// Capacity that the uniform block was written for.
    capacity: u32,
}

/// Whether buffers have been replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Prepared {
    Unchanged,
    Replaced,
}

impl ImageBuffers {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            size: [0; 2],
            image: gpu.storage("image", 0)?,
            layers: gpu.storage("layers", 0)?,
            by_depth_sums: gpu.storage("gradient by depth sums", 0)?,
            tile_starts: gpu.storage("tile starts", 0)?,
            region: gpu.uniform_of("region", &[0; size_of::<Region>()]),
            pixels: 0,
            depth_pixels: 0,
            tiles: 0,
            capacity: 0,
        })
    }

    /// Makes the buffers fit an image.
    pub(super) fn prepare(
        &mut self,
        gpu: &Gpu,
        size: [u32; 2],
        depth: bool,
        capacity: u32,
    ) -> Result<Prepared, GpuError> {
        let mut prepared = Prepared::Unchanged;
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let (need, have) = (pixels * PIXEL_BYTES, gpu.max_binding());
        if need > have {
            return Err(GpuError::OutOfMemory { what: "image in one binding", need, have });
        }
        if pixels > self.pixels {
            self.image = gpu.storage("image", need)?;
            self.pixels = pixels;
            prepared = Prepared::Replaced;
        }
        if depth && pixels > self.depth_pixels {
            self.layers = gpu.storage("layers", need)?;
            self.by_depth_sums = gpu.storage("gradient by depth sums", pixels * 8)?;
            self.depth_pixels = pixels;
            prepared = Prepared::Replaced;
        }
        let [across, down] = image_tiles(size);
        if across * down > self.tiles {
            self.tiles = across * down;
            self.tile_starts = gpu.storage("tile starts", (u64::from(self.tiles) + 1) * 4)?;
            prepared = Prepared::Replaced;
        }
        if self.size != size || self.capacity != capacity {
            (self.size, self.capacity) = (size, capacity);
            let whole = TileRect { first: [0, 0], tiles: [across, down] };
            let keys = keys_per_thread(capacity);
            let region = region::uniform(whole, size, [0, 0], size[0], capacity, keys);
            let region = Region { halts: 1, ..region };
            gpu.queue().write_buffer(&self.region, 0, bytemuck::bytes_of(&region));
        }
        Ok(prepared)
    }

    /// Tiles of the image.
    pub(super) fn tile_count(&self) -> u32 {
        let [across, down] = image_tiles(self.size);
        across * down
    }

    pub(super) fn pixel_count(&self) -> u32 {
        self.size[0] * self.size[1]
    }
}

/// The uniform blocks that each frame writes.
#[derive(Debug)]
pub(super) struct FrameUniforms {
    pub frame: wgpu::Buffer,
    pub splats: wgpu::Buffer,
}

impl FrameUniforms {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            frame: gpu.uniform_of("frame", &[0; size_of::<crate::layout::Frame>()]),
            splats: gpu.uniform_of("splat count", &[0; size_of::<SplatCount>()]),
        }
    }
}
