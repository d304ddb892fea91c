//! The stages put together.

mod growth;
mod measure;
mod options;
mod pick;

use std::sync::Arc;

use trapeze_scene::{Camera, Frame, FrameSettings, NO_SPLAT, Scene};

pub use self::options::RendererOptions;
use self::pick::PickStage;
pub use self::pick::{Pick, PickTicket};

use crate::deform::{DeformStage, DeformWork, NetworkPrecision};
use crate::kernels::Kernels;
use crate::late_reader::{LateReader, Words};
use crate::layout::{argument, counter};
use crate::memory::{MemoryPlan, SceneSize, initial_entries, kept_splats, part_of};
use crate::project::{ProjectStage, ProjectedBuffers, frame_uniform};
use crate::readback::{self, Counts};
use crate::scene_buffers::{SceneBuffers, heat_scale};
use crate::sort::{DEPTH_SHIFTS, PairBuffers, SortPlan};
use crate::stage_pass::{Groups, Stage, begin};
use crate::surface::ImageView;
use crate::tiles::{DrawingOrder, EntryBuffers, Target, TargetRequest, max_capacity, tile_count};
use crate::timing::Timer;
use crate::{Gpu, GpuError};

/// Renders a scene on the GPU.
///
/// [`render`](Self::render) waits for the image and returns it. [`draw`](Self::draw) is for
/// playback: it submits a frame and returns; in the steady state it creates nothing and waits for
/// nothing. What it drew stays on the GPU.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    scene: Arc<Scene>,
    options: RendererOptions,
    /// Indices in the scene of the splats on the device, when they are not all.
    kept: Option<Vec<u32>>,
    buffers: SceneBuffers,
    frame_uniform: wgpu::Buffer,
    deform: Option<DeformStage>,
    project: ProjectStage,
    projected: ProjectedBuffers,
    depth_sort: SortPlan,
    depth_blocks: u32,
    order: DrawingOrder,
    entries: EntryBuffers,
    main: Target,
    pick: PickStage,
    /// Regions that the last frame needed.
    pieces: u32,
    /// Counts of frames under way.
    counts: LateReader,
    timer: Option<Timer>,
    last_counts: Counts,
}

impl Renderer {
    /// Uploads a scene, with the default options.
    ///
    /// # Errors
    /// [`GpuError`] when the scene does not fit together, or not into the device.
    pub fn new(gpu: &Gpu, scene: Arc<Scene>) -> Result<Self, GpuError> {
        Self::with_options(gpu, scene, RendererOptions::default())
    }

    /// Uploads a scene.
    ///
    /// # Errors
    /// [`GpuError`] when the scene does not fit together, or not into the device.
    pub fn with_options(
        gpu: &Gpu,
        scene: Arc<Scene>,
        options: RendererOptions,
    ) -> Result<Self, GpuError> {
        scene.validate()?;
        check_plan(gpu, &scene, &options)?;
        let kept = kept_splats(&scene, &options);
        let reduced = kept.as_ref().map(|kept| part_of(&scene, kept));
        let shown: &Scene = reduced.as_ref().unwrap_or(&scene);
        let mut buffers =
            SceneBuffers::upload(gpu, shown, options.max_sh_degree, options.harmonics)?;
        buffers.heat_scale = heat_scale(&scene);
        let splats = buffers.count;
        let counts = gpu.storage("counts", 4 * counter::COUNT as u64)?;
        let deform = match &shown.deformation {
            Some(network) => {
                Some(DeformStage::new(gpu, shown, network, &buffers, &counts, options.precision)?)
            }
            None => None,
        };
        let frame_uniform = gpu.uniform_of("frame", &[0; size_of::<crate::layout::Frame>()]);
        let projected = ProjectedBuffers::new(gpu, splats)?;
        let sort_kernels = &gpu.kernels().sort;
        let pairs = PairBuffers::new(gpu, ["depth keys", "splats"], splats)?;
        let depth_sort = SortPlan::new(
            gpu,
            sort_kernels,
            &pairs,
            &counts,
            counter::VISIBLE,
            &DEPTH_SHIFTS,
            true,
        )?;
        let poses = deform.as_ref().map_or(&buffers.canonical_poses, |stage| &stage.poses);
        let project = ProjectStage::new(
            gpu,
            &buffers,
            &frame_uniform,
            poses,
            &projected,
            &pairs.keys[0],
            &pairs.values[0],
        );
        let network_splats = deform.as_ref().map_or(1, DeformStage::splats_per_group);
        let order = DrawingOrder::new(
            gpu,
            splats,
            &depth_sort,
            // One pass for the low keys and four for the depths: an odd number ends in buffer 1.
            &pairs.values[(1 + DEPTH_SHIFTS.len()) % 2],
            network_splats,
            counts,
        )?;
        let capacity = initial_entries(splats, &options).min(max_capacity(gpu));
        Ok(Self {
            gpu: gpu.clone(),
            scene,
            options,
            kept,
            frame_uniform,
            deform,
            project,
            projected,
            entries: EntryBuffers::new(gpu, sort_kernels, &order.counts, capacity)?,
            depth_blocks: splats.div_ceil(depth_sort.block),
            depth_sort,
            main: Target::new(gpu)?,
            pick: PickStage::new(gpu)?,
            pieces: 1,
            counts: LateReader::new(gpu, counter::COUNT as u32, COUNTED_FRAMES)?,
            timer: Timer::new(gpu)?,
            last_counts: Counts::default(),
            order,
            buffers,
        })
    }

    /// The same renderer on another device: what to do with one whose device is lost.
    ///
    /// # Errors
    /// Those of [`with_options`](Self::with_options).
    pub fn rebuilt_on(&self, gpu: &Gpu) -> Result<Self, GpuError> {
        Self::with_options(gpu, self.scene.clone(), self.options)
    }

    /// Evaluates the network in this precision from the next frame on. Has an effect on renderers
    /// that were made for [`NetworkPrecision::Half`] and keep both kernels; creates nothing.
    pub fn set_precision(&mut self, precision: NetworkPrecision) {
        let Some(stage) = &mut self.deform else { return };
        stage.set_precision(precision);
        self.order.write_network_splats(&self.gpu, stage.splats_per_group());
    }

    /// The scene that is rendered.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The device that it is rendered on.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Splats that the last frame drew, after culling, as far as the GPU has reported.
    #[must_use]
    pub fn visible_splats(&self) -> usize {
        self.last_counts.visible as usize
    }

    /// Pairs of a splat and a tile in the last frame (its most crowded region), as far as the GPU
    /// has reported.
    #[must_use]
    pub fn tile_entries(&self) -> u32 {
        self.last_counts.most_entries
    }

    /// The image that was drawn last; a transparent pixel before the first.
    pub(crate) fn image(&self) -> ImageView<'_> {
        ImageView { buffer: &self.main.image, size: self.main.size().map(|side| side.max(1)) }
    }

    /// Renders one frame and waits for it.
    ///
    /// # Errors
    /// [`GpuError`] when the camera cannot project, the frame does not fit into the device, or the
    /// device is lost.
    pub fn render(&mut self, camera: &Camera, settings: &FrameSettings) -> Result<Frame, GpuError> {
        camera.validate()?;
        let layers = settings.depth || settings.top_contributor;
        self.draw_until_complete(camera, settings, layers, Output::Image)?;
        let pixels = u64::from(camera.width) * u64::from(camera.height);
        let mut frame = Frame { width: camera.width, height: camera.height, ..Frame::default() };
        frame.color = readback::read(&self.gpu, &self.main.image, pixels)?;
        if layers {
            let values: Vec<[u32; 4]> = readback::read(&self.gpu, &self.main.layers, pixels)?;
            if settings.depth {
                frame.expected_depth = values.iter().map(|v| f32::from_bits(v[0])).collect();
                frame.median_depth = values.iter().map(|v| f32::from_bits(v[1])).collect();
            }
            if settings.top_contributor {
                frame.top_contributor = values.iter().map(|v| self.index_in_scene(v[2])).collect();
            }
        }
        Ok(frame)
    }

    /// Draws one frame into the image on the GPU, without waiting for anything. Only a frame of
    /// another size than the last one is waited for: there is no image of that size that could
    /// stay on the screen until it fits.
    ///
    /// When a frame needs larger buffers than there are, the GPU leaves the last image as it is;
    /// the number that is needed arrives with a later call, which makes the buffers grow. `true`
    /// says that this has happened: the frame before was not drawn and should be drawn again.
    ///
    /// # Errors
    /// [`GpuError`] when the camera cannot project, the frame does not fit into the device, or the
    /// device is lost.
    pub fn draw(&mut self, camera: &Camera, settings: &FrameSettings) -> Result<bool, GpuError> {
        camera.validate()?;
        self.gpu.poll()?;
        if self.main.size() != [camera.width, camera.height] {
            let layers = settings.depth || settings.top_contributor;
            self.draw_until_complete(camera, settings, layers, Output::Image)?;
            return Ok(false);
        }
        let mut grown = false;
        if let Some(counts) = self.arrived_counts()? {
            self.last_counts = counts;
            grown = self.make_room(counts, tile_count(self.main.size()))?;
        }
        let layers = settings.depth || settings.top_contributor;
        let mut encoder = self.encode(camera, settings, layers, Output::Image, false)?;
        let counts = Words { buffer: &self.order.counts, first: 0, count: counter::COUNT as u32 };
        // A frame for which no slot is free is not counted; the next one is.
        self.counts.record(&mut encoder, 0, &[counts]);
        self.gpu.queue().submit([encoder.finish()]);
        self.counts.submitted();
        Ok(grown)
    }

    /// Index in the scene of a splat on the device; [`NO_SPLAT`] stays what it is.
    fn index_in_scene(&self, splat: u32) -> u32 {
        match &self.kept {
            Some(kept) => kept.get(splat as usize).copied().unwrap_or(NO_SPLAT),
            None => splat,
        }
    }

    /// Records a frame.
    fn encode(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
        layers: bool,
        output: Output,
        timed: bool,
    ) -> Result<wgpu::CommandEncoder, GpuError> {
        let gpu = &self.gpu;
        gpu.check()?;
        let kernels = gpu.kernels();
        let size = [camera.width, camera.height];
        let request = TargetRequest {
            size,
            only_tile: match output {
                Output::Image => None,
                Output::Tile(tile) => Some(tile),
            },
            layers,
            pieces: self.pieces,
        };
        let target = match output {
            Output::Image => &mut self.main,
            Output::Tile(_) => &mut self.pick.target,
        };
        target.prepare(gpu, request, self.entries.pairs.capacity)?;
        target.bind(gpu, &kernels.tiles, &self.order, &self.projected, &self.entries);
        let target = &*target;

        self.buffers.select(gpu, settings);
        let camera = camera.relative_to(self.scene.origin);
        let frame = frame_uniform(&camera, settings, self.buffers.heat_scale);
        gpu.queue().write_buffer(&self.frame_uniform, 0, bytemuck::bytes_of(&frame));

        let timestamps = self
            .timer
            .as_ref()
            .filter(|_| timed && target.regions().len() == 1)
            .map(Timer::queries);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        encoder.clear_buffer(&self.order.counts, 4 * counter::MOST_ENTRIES as u64, Some(4));
        if let Some(stage) = &mut self.deform {
            let work = stage.prepare(gpu, settings.time, settings.static_threshold);
            record_deform(stage, work, kernels, target, &self.order, &mut encoder, timestamps);
        } else if timestamps.is_some() {
            drop(begin(&mut encoder, Stage::Deform, timestamps));
        }
        self.project.record(&mut begin(&mut encoder, Stage::Project, timestamps));
        {
            let mut pass = begin(&mut encoder, Stage::Sort, timestamps);
            let groups = Groups::Direct(self.depth_blocks);
            self.depth_sort.record(&kernels.sort, &mut pass, 0, groups);
            target.record_drawing_order(&kernels.tiles, &mut pass);
            for step in 1..self.depth_sort.len() {
                let groups = self.order.groups(argument::DEPTH_SORT);
                self.depth_sort.record(&kernels.sort, &mut pass, step, groups);
            }
        }
        target.record(gpu, &self.order, &self.entries, layers, &mut encoder, timestamps);
        if let Some(timer) = self.timer.as_ref().filter(|_| timestamps.is_some()) {
            timer.resolve(&mut encoder);
        }
        Ok(encoder)
    }
}

/// Refuses what the device's limits do not allow, before anything is uploaded.
fn check_plan(gpu: &Gpu, scene: &Scene, options: &RendererOptions) -> Result<(), GpuError> {
    let most = max_capacity(gpu).min(options.max_entries.unwrap_or(u32::MAX));
    let options = RendererOptions { max_entries: Some(most), ..*options };
    MemoryPlan::new(&SceneSize::of(scene)?, &options, [0, 0], false).check(gpu)
}

/// Records the work of the deformation stage.
fn record_deform(
    stage: &DeformStage,
    work: DeformWork,
    kernels: &Kernels,
    target: &Target,
    order: &DrawingOrder,
    encoder: &mut wgpu::CommandEncoder,
    timestamps: Option<&wgpu::QuerySet>,
) {
    stage.clear_list(work, encoder);
    let mut pass = begin(encoder, Stage::Deform, timestamps);
    stage.record_mask(work, &mut pass);
    target.record_network_arguments(&kernels.tiles, &mut pass);
    stage.record_network(work, &mut pass, order.groups(argument::NETWORK));
}

/// What a frame is drawn into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Output {
    /// The whole image.
    Image,
    /// One tile, for picking.
    Tile([u32; 2]),
}

/// Frames under way whose counts are read.
const COUNTED_FRAMES: usize = 3;

#[cfg(test)]
mod tests;
