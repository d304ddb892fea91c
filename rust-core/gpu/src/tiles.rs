//! Stages 4 and 5 on the host: entries per tile, and blending.

mod target;

pub(crate) use self::target::{PIXEL_BYTES, Target, TargetRequest, tile_count};
use crate::kernel::{Binding, Interface, whole};
use crate::layout::{Sizes, argument, counter};
use crate::sort::{PairBuffers, SortKernels, SortPlan};
use crate::stage_pass::Groups;
use crate::{Gpu, GpuError, shaders};

/// Pipelines of binning and blending.
#[derive(Debug)]
pub(crate) struct TileKernels {
    arguments: Interface,
    pub drawing_order: wgpu::ComputePipeline,
    pub entries: wgpu::ComputePipeline,
    pub network: wgpu::ComputePipeline,
    bin: Interface,
    count: wgpu::ComputePipeline,
    emit: wgpu::ComputePipeline,
    pub ranges_interface: Interface,
    pub ranges: wgpu::ComputePipeline,
    pub rasterize_interface: Interface,
    /// Colour and alpha alone.
    rasterize: wgpu::ComputePipeline,
    /// With depths, top contributor and its label.
    rasterize_layers: wgpu::ComputePipeline,
}

impl TileKernels {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        use Binding::{Read, Uniform, UniformAt, Write};
        let arguments = Interface::new(
            gpu,
            "arguments",
            &shaders::ARGUMENTS.source(),
            &[UniformAt, Uniform, Write, Read, Write, Write],
        );
        let bin = Interface::new(
            gpu,
            "bin",
            &shaders::BIN.source(),
            &[UniformAt, Read, Read, Read, Read, Write, Write, Write],
        );
        let ranges = Interface::new(
            gpu,
            "ranges",
            &shaders::RANGES.source(),
            &[UniformAt, Read, Read, Write],
        );
        let rasterize = Interface::new(
            gpu,
            "rasterize",
            &shaders::RASTERIZE.source(),
            &[UniformAt, Read, Read, Read, Read, Read, Write, Write],
        );
        let layers = [("DEPTH", 1.0), ("TOP_CONTRIBUTOR", 1.0)];
        Self {
            drawing_order: arguments.pipeline(gpu, "drawing_order", &[]),
            entries: arguments.pipeline(gpu, "entries", &[]),
            network: arguments.pipeline(gpu, "network", &[]),
            arguments,
            count: bin.pipeline(gpu, "count", &[]),
            emit: bin.pipeline(gpu, "emit", &[]),
            bin,
            ranges: ranges.pipeline(gpu, "ranges", &[]),
            ranges_interface: ranges,
            rasterize: rasterize.pipeline(gpu, "rasterize", &[]),
            rasterize_layers: rasterize.pipeline(gpu, "rasterize", &layers),
            rasterize_interface: rasterize,
        }
    }

    /// The blending pipeline, with depths and top contributor or without.
    pub(crate) fn blending(&self, layers: bool) -> &wgpu::ComputePipeline {
        if layers { &self.rasterize_layers } else { &self.rasterize }
    }

    /// Binds the kernel that computes the sizes of later dispatches.
    pub(crate) fn bind_arguments(
        &self,
        gpu: &Gpu,
        region: wgpu::BufferBinding<'_>,
        order: &DrawingOrder,
    ) -> wgpu::BindGroup {
        self.arguments.bind(
            gpu,
            &[
                region,
                whole(&order.sizes),
                whole(&order.counts),
                whole(&order.digit_counts),
                whole(&order.group_entries),
                whole(&order.arguments),
            ],
        )
    }
}

/// What the tile stages read of the stages before: per scene.
#[derive(Debug)]
pub(crate) struct DrawingOrder {
    /// Splat indices in drawing order, once the depth sort is done.
    pub order: wgpu::Buffer,
    pub digit_counts: wgpu::Buffer,
    pub counts: wgpu::Buffer,
    pub arguments: wgpu::Buffer,
    pub sizes: wgpu::Buffer,
    pub group_entries: wgpu::Buffer,
}

/// Splats that one workgroup of the binning kernel takes.
const SPLATS_PER_GROUP: u32 = 64;

impl DrawingOrder {
    pub(crate) fn new(
        gpu: &Gpu,
        splats: u32,
        depth_sort: &SortPlan,
        order: &wgpu::Buffer,
        network_splats: u32,
        counts: wgpu::Buffer,
    ) -> Result<Self, GpuError> {
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::INDIRECT
            | wgpu::BufferUsages::COPY_DST;
        let sizes = Sizes { depth_block: depth_sort.block, network_splats, ..Sizes::default() };
        Ok(Self {
            order: order.clone(),
            digit_counts: depth_sort.digit_counts.clone(),
            counts,
            arguments: gpu.buffer("arguments", argument::BYTES, usage)?,
            sizes: gpu.uniform_of("sizes", bytemuck::bytes_of(&sizes)),
            group_entries: gpu
                .storage("entries of groups", u64::from(splats.div_ceil(SPLATS_PER_GROUP)) * 4)?,
        })
    }

    /// Tells the kernels how many splats a workgroup of the network takes.
    pub(crate) fn write_network_splats(&self, gpu: &Gpu, splats: u32) {
        let at = std::mem::offset_of!(Sizes, network_splats) as u64;
        gpu.queue().write_buffer(&self.sizes, at, bytemuck::bytes_of(&splats));
    }

    /// Workgroups of an indirect dispatch.
    pub(crate) fn groups(&self, slot: u64) -> Groups<'_> {
        Groups::Indirect(&self.arguments, slot * argument::STRIDE)
    }
}

/// (tile, splat) pairs and their sort.
#[derive(Debug)]
pub(crate) struct EntryBuffers {
    pub pairs: PairBuffers,
    /// Sort by the lowest 16 bits of the tile, enough for 65 536 tiles.
    sort_two: SortPlan,
    /// Sort by the lowest 24 bits.
    sort_three: SortPlan,
}

impl EntryBuffers {
    pub(crate) fn new(
        gpu: &Gpu,
        kernels: &SortKernels,
        counts: &wgpu::Buffer,
        capacity: u32,
    ) -> Result<Self, GpuError> {
        let pairs = PairBuffers::new(gpu, ["entry tiles", "entry splats"], capacity)?;
        let plan = |shifts: &[u32]| {
            SortPlan::new(gpu, kernels, &pairs, counts, counter::SORTED_ENTRIES, shifts, false)
        };
        Ok(Self { sort_two: plan(&[0, 8])?, sort_three: plan(&[0, 8, 16])?, pairs })
    }

    /// The sort for regions of so many tiles.
    pub(crate) fn sort(&self, tiles: u32) -> &SortPlan {
        if tiles <= 1 << 16 { &self.sort_two } else { &self.sort_three }
    }
}

/// Most entries that the device's limits allow.
pub(crate) fn max_capacity(gpu: &Gpu) -> u32 {
    (gpu.max_binding() / 4).min(1 << 30) as u32
}
