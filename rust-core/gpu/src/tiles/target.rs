//! What binning and blending draw into.

use super::{DrawingOrder, EntryBuffers, TileKernels};
use crate::kernel::{part, whole};
use crate::layout::{Region, argument};
use crate::project::ProjectedBuffers;
use crate::region::{self, TILE, TileRect, image_tiles};
use crate::sort::keys_per_thread;
use crate::stage_pass::{Groups, Stage, begin, dispatch};
use crate::{Gpu, GpuError};

/// What is drawn into: an image, and how it is cut into regions.
#[derive(Debug)]
pub(crate) struct Target {
    size: [u32; 2],
    /// Regions, and the pieces that they were cut for.
    regions: Vec<TileRect>,
    pieces: u32,
    /// Pixels and tiles that the buffers hold.
    pixels: u64,
    tiles: u32,
    /// r g b a.
    pub image: wgpu::Buffer,
    /// Depths, top contributor, label; one pixel until they are asked for.
    pub layers: wgpu::Buffer,
    layer_pixels: u64,
    tile_starts: wgpu::Buffer,
    region_uniforms: wgpu::Buffer,
    uniform_slots: usize,
    /// Capacity that the uniforms were written for.
    capacity: u32,
    bound: Option<Bound>,
}

#[derive(Debug)]
struct Bound {
    arguments: wgpu::BindGroup,
    bin: wgpu::BindGroup,
    /// For sorts of two and of three passes, whose results are in different buffers.
    ranges: [wgpu::BindGroup; 2],
    /// Windows of the image, each with bind groups for two and for three passes.
    windows: Vec<ImageWindow>,
}

#[derive(Debug)]
struct ImageWindow {
    rasterize: [wgpu::BindGroup; 2],
}

/// Bytes of a pixel in the image and in the layers.
pub(crate) const PIXEL_BYTES: u64 = 16;
/// Bytes between two regions' uniform blocks.
const REGION_STRIDE: usize = 256;

/// What a frame asks of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TargetRequest {
    pub size: [u32; 2],
    /// Draw only this tile, as an image of its own.
    pub only_tile: Option<[u32; 2]>,
    pub layers: bool,
    /// Regions to cut the image into, at least.
    pub pieces: u32,
}

impl Target {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            size: [0; 2],
            regions: Vec::new(),
            pieces: 0,
            pixels: 0,
            tiles: 0,
            image: gpu.storage("image", 0)?,
            layers: gpu.storage("layers", 0)?,
            layer_pixels: 0,
            tile_starts: gpu.storage("tile starts", 0)?,
            region_uniforms: gpu.uniform_of("regions", &[0; REGION_STRIDE]),
            uniform_slots: 1,
            capacity: 0,
            bound: None,
        })
    }

    /// Size of the image, pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Regions that the image is cut into.
    pub(crate) fn regions(&self) -> &[TileRect] {
        &self.regions
    }

    /// Forgets the bindings, when buffers outside have been replaced.
    pub(crate) fn unbind(&mut self) {
        self.bound = None;
    }

    /// Makes the target fit a request. Does nothing on the device when it already does.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        request: TargetRequest,
        capacity: u32,
    ) -> Result<(), GpuError> {
        let [width, height] = request.size;
        let stored = if request.only_tile.is_some() { [TILE, TILE] } else { request.size };
        let max_rows = rows_per_window(gpu, stored[0])?;
        let regions = match request.only_tile {
            Some(first) => vec![TileRect { first, tiles: [1, 1] }],
            None => region::cut([width, height], request.pieces, max_rows),
        };
        let unchanged =
            self.size == request.size && self.regions == regions && self.capacity == capacity;
        let windowed = regions.len() > 1;
        if windowed && !unchanged {
            // Windows of the image are bound one by one.
            self.bound = None;
        }
        self.grow(gpu, stored, request.layers, &regions)?;
        if unchanged {
            return Ok(());
        }
        if (self.regions.len() > 1) != windowed {
            self.bound = None;
        }
        self.size = request.size;
        self.pieces = request.pieces;
        self.capacity = capacity;
        self.regions = regions;
        self.write_regions(gpu, request);
        Ok(())
    }

    fn grow(
        &mut self,
        gpu: &Gpu,
        stored: [u32; 2],
        layers: bool,
        regions: &[TileRect],
    ) -> Result<(), GpuError> {
        let pixels = u64::from(stored[0]) * u64::from(stored[1]);
        if pixels > self.pixels {
            self.image = gpu.storage("image", pixels * PIXEL_BYTES)?;
            self.pixels = pixels;
            self.bound = None;
        }
        if layers && pixels > self.layer_pixels {
            self.layers = gpu.storage("layers", pixels * PIXEL_BYTES)?;
            self.layer_pixels = pixels;
            self.bound = None;
        }
        let tiles = regions.iter().map(|r| r.count()).max().unwrap_or(0);
        if tiles > self.tiles {
            self.tile_starts = gpu.storage("tile starts", (u64::from(tiles) + 1) * 4)?;
            self.tiles = tiles;
            self.bound = None;
        }
        if regions.len() > self.uniform_slots {
            self.uniform_slots = regions.len().next_power_of_two();
            self.region_uniforms =
                gpu.uniform_of("regions", &vec![0; self.uniform_slots * REGION_STRIDE]);
            self.bound = None;
        }
        Ok(())
    }

    fn write_regions(&self, gpu: &Gpu, request: TargetRequest) {
        let mut blocks = vec![0; self.regions.len() * REGION_STRIDE];
        for (block, &rect) in blocks.chunks_exact_mut(REGION_STRIDE).zip(&self.regions) {
            let (origin, stride) = match request.only_tile {
                Some([x, y]) => ([x * TILE, y * TILE], TILE),
                // A window of the image starts with the region's first row.
                None if self.regions.len() > 1 => ([0, rect.first[1] * TILE], self.size[0]),
                None => ([0, 0], self.size[0]),
            };
            let region = region::uniform(
                rect,
                self.size,
                origin,
                stride,
                self.capacity,
                keys_per_thread(self.capacity),
            );
            block[..size_of::<Region>()].copy_from_slice(bytemuck::bytes_of(&region));
        }
        gpu.queue().write_buffer(&self.region_uniforms, 0, &blocks);
    }

    /// Binds the target to the other buffers, unless it is bound already.
    pub(crate) fn bind(
        &mut self,
        gpu: &Gpu,
        kernels: &TileKernels,
        order: &DrawingOrder,
        projected: &ProjectedBuffers,
        entries: &EntryBuffers,
    ) {
        if self.bound.is_some() {
            return;
        }
        let region = || part(&self.region_uniforms, 0, size_of::<Region>() as u64);
        let pairs = &entries.pairs;
        let arguments = kernels.bind_arguments(gpu, region(), order);
        let bin = kernels.bin.bind(
            gpu,
            &[
                region(),
                whole(&order.order),
                whole(&projected.centres),
                whole(&projected.extents),
                whole(&order.counts),
                whole(&order.group_entries),
                whole(&pairs.keys[0]),
                whole(&pairs.values[0]),
            ],
        );
        // Two passes end in the first buffers, three in the second.
        let ranges = std::array::from_fn(|i| {
            kernels.ranges_interface.bind(
                gpu,
                &[region(), whole(&order.counts), whole(&pairs.keys[i]), whole(&self.tile_starts)],
            )
        });
        let windows = (0..self.regions.len())
            .map(|r| {
                let rasterize = std::array::from_fn(|i| {
                    kernels.rasterize_interface.bind(
                        gpu,
                        &[
                            region(),
                            whole(&self.tile_starts),
                            whole(&pairs.values[i]),
                            whole(&projected.centres),
                            whole(&projected.extents),
                            whole(&projected.colors),
                            self.image_window(&self.image, self.pixels, r),
                            self.image_window(&self.layers, self.layer_pixels, r),
                        ],
                    )
                });
                ImageWindow { rasterize }
            })
            .collect();
        self.bound = Some(Bound { arguments, bin, ranges, windows });
    }

    /// The part of an image that a region writes.
    fn image_window<'a>(
        &self,
        buffer: &'a wgpu::Buffer,
        pixels: u64,
        region: usize,
    ) -> wgpu::BufferBinding<'a> {
        if self.regions.len() <= 1 || pixels == 0 {
            return whole(buffer);
        }
        let rect = self.regions[region];
        let width = u64::from(self.size[0]);
        let first = u64::from(rect.first[1] * TILE);
        let rows = u64::from(rect.tiles[1] * TILE).min(u64::from(self.size[1]) - first);
        part(buffer, first * width * PIXEL_BYTES, rows * width * PIXEL_BYTES)
    }

    /// Records what follows the first pass of the depth sort: how many splats are drawn.
    pub(crate) fn record_drawing_order(
        &self,
        kernels: &TileKernels,
        pass: &mut wgpu::ComputePass<'_>,
    ) {
        let Some(bound) = &self.bound else { return };
        pass.set_pipeline(&kernels.drawing_order);
        pass.set_bind_group(0, &bound.arguments, &[0]);
        pass.dispatch_workgroups(1, 1, 1);
    }

    /// Records the workgroups of the network, from the number of splats that move.
    pub(crate) fn record_network_arguments(
        &self,
        kernels: &TileKernels,
        pass: &mut wgpu::ComputePass<'_>,
    ) {
        let Some(bound) = &self.bound else { return };
        pass.set_pipeline(&kernels.network);
        pass.set_bind_group(0, &bound.arguments, &[0]);
        pass.dispatch_workgroups(1, 1, 1);
    }

    /// Records binning and blending of all regions.
    pub(crate) fn record(
        &self,
        gpu: &Gpu,
        order: &DrawingOrder,
        entries: &EntryBuffers,
        layers: bool,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: Option<&wgpu::QuerySet>,
    ) {
        let Some(bound) = &self.bound else { return };
        let (kernels, sort_kernels) = (&gpu.kernels().tiles, &gpu.kernels().sort);
        for (i, rect) in self.regions.iter().enumerate() {
            let offset = [(i * REGION_STRIDE) as u32];
            let sort = entries.sort(rect.count());
            let sorted = sort.len() % 2;
            {
                let mut pass = begin(encoder, Stage::Bin, timestamps);
                pass.set_pipeline(&kernels.count);
                pass.set_bind_group(0, &bound.bin, &offset);
                dispatch(&mut pass, order.groups(argument::BIN));
                pass.set_pipeline(&kernels.entries);
                pass.set_bind_group(0, &bound.arguments, &offset);
                pass.dispatch_workgroups(1, 1, 1);
                pass.set_pipeline(&kernels.emit);
                pass.set_bind_group(0, &bound.bin, &offset);
                dispatch(&mut pass, order.groups(argument::EMIT));
                for step in 0..sort.len() {
                    let groups = order.groups(argument::ENTRY_SORT);
                    sort.record(sort_kernels, &mut pass, step, groups);
                }
                pass.set_pipeline(&kernels.ranges);
                pass.set_bind_group(0, &bound.ranges[sorted], &offset);
                dispatch(&mut pass, Groups::Direct((rect.count() + 1).div_ceil(256)));
            }
            let mut pass = begin(encoder, Stage::Rasterize, timestamps);
            pass.set_pipeline(kernels.blending(layers));
            pass.set_bind_group(0, &bound.windows[i].rasterize[sorted], &offset);
            dispatch(&mut pass, order.groups(argument::RASTERIZE));
        }
    }
}

/// Rows of tiles of an image whose pixels fit into one binding.
fn rows_per_window(gpu: &Gpu, width: u32) -> Result<u32, GpuError> {
    let row = u64::from(width) * u64::from(TILE) * PIXEL_BYTES;
    let have = gpu.max_binding();
    if row > have {
        return Err(GpuError::OutOfMemory { what: "a row of tiles", need: row, have });
    }
    Ok((have / row).min(u64::from(u32::MAX)) as u32)
}

/// Tiles of an image.
pub(crate) fn tile_count(size: [u32; 2]) -> u32 {
    let [across, down] = image_tiles(size);
    across * down
}
