//! The stages put together.

use std::sync::Arc;
use std::time::Duration;

use trapeze_scene::{Camera, Frame, FrameSettings, NO_SPLAT, Scene, ShDegree};

use crate::activate::HarmonicsStorage;
use crate::deform::{DeformStage, DeformWork, NetworkPrecision};
use crate::kernels::Kernels;
use crate::layout::{Pose, argument, counter};
use crate::project::{ProjectStage, ProjectedBuffers, frame_uniform};
use crate::readback::{self, CountReader, Counts};
use crate::region::TILE;
use crate::scene_buffers::SceneBuffers;
use crate::sort::{PairBuffers, SortPlan};
use crate::stage_pass::{Groups, Stage, begin};
use crate::surface::ImageView;
use crate::tiles::{DrawingOrder, EntryBuffers, Target, TargetRequest, max_capacity, tile_count};
use crate::timing::{StageTimes, Timer};
use crate::{Gpu, GpuError};

/// How a scene is kept on the GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RendererOptions {
    /// Storage of SH coefficients.
    pub harmonics: HarmonicsStorage,
    /// Highest SH band to keep.
    pub max_sh_degree: ShDegree,
    /// Arithmetic of the deformation network.
    pub precision: NetworkPrecision,
    /// Tile entries to make room for at first; the buffers grow when a frame needs more.
    pub initial_entries: Option<u32>,
}

impl Default for RendererOptions {
    fn default() -> Self {
        Self {
            harmonics: HarmonicsStorage::default(),
            max_sh_degree: ShDegree::Three,
            precision: NetworkPrecision::default(),
            initial_entries: None,
        }
    }
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// Index of the top contributor.
    pub splat: u32,
    /// Label of its cluster, when the scene has clusters.
    pub cluster: Option<u32>,
    /// Median depth where transmittance falls to ½, else expected depth; world units.
    pub depth: f32,
}

/// Renders a scene on the GPU.
///
/// [`render`](Self::render) waits for the image and returns it. [`draw`](Self::draw) is for
/// playback: it submits a frame and returns; in the steady state it creates nothing and waits for
/// nothing. What it drew stays on the GPU.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    scene: Arc<Scene>,
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
    pixel: Target,
    /// Regions that the last frame needed.
    pieces: u32,
    counts: CountReader,
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
        let buffers = SceneBuffers::upload(gpu, &scene, options.max_sh_degree, options.harmonics)?;
        let splats = buffers.count;
        let counts = gpu.storage("counts", 4 * counter::COUNT as u64)?;
        let deform = match &scene.deformation {
            Some(network) => {
                Some(DeformStage::new(gpu, &scene, network, &buffers, &counts, options.precision)?)
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
        let capacity = options
            .initial_entries
            .unwrap_or(splats.saturating_mul(4).saturating_add(1 << 16))
            .clamp(1, max_capacity(gpu));
        Ok(Self {
            gpu: gpu.clone(),
            scene,
            frame_uniform,
            deform,
            project,
            projected,
            entries: EntryBuffers::new(gpu, sort_kernels, &order.counts, capacity)?,
            depth_blocks: splats.div_ceil(depth_sort.block),
            depth_sort,
            main: Target::new(gpu)?,
            pixel: Target::new(gpu)?,
            pieces: 1,
            counts: CountReader::new(gpu)?,
            timer: Timer::new(gpu)?,
            last_counts: Counts::default(),
            order,
            buffers,
        })
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
                frame.top_contributor = values.iter().map(|v| v[2]).collect();
            }
        }
        Ok(frame)
    }

    /// What is seen at pixel (x, y), or `None` where nothing is or outside the image. Only that
    /// pixel's tile is blended; the image of the last frame stays.
    ///
    /// # Errors
    /// Those of [`render`](Self::render).
    pub fn pick(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
        (x, y): (u32, u32),
    ) -> Result<Option<Pick>, GpuError> {
        camera.validate()?;
        if x >= camera.width || y >= camera.height {
            return Ok(None);
        }
        self.draw_until_complete(camera, settings, true, Output::Tile([x / TILE, y / TILE]))?;
        let pixels = u64::from(TILE * TILE);
        let values: Vec<[u32; 4]> = readback::read(&self.gpu, &self.pixel.layers, pixels)?;
        let [expected, median, splat, label] = values[((y % TILE) * TILE + x % TILE) as usize];
        let (expected, median) = (f32::from_bits(expected), f32::from_bits(median));
        Ok((splat != NO_SPLAT).then(|| Pick {
            splat,
            cluster: self.scene.clusters.as_ref().map(|_| label),
            depth: if median.is_nan() { expected } else { median },
        }))
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
        if let Some(counts) = self.counts.latest() {
            self.last_counts = counts;
            grown = self.make_room(counts, tile_count(self.main.size()))?;
        }
        let layers = settings.depth || settings.top_contributor;
        let mut encoder = self.encode(camera, settings, layers, Output::Image, false)?;
        self.counts.record(&mut encoder, &self.order.counts);
        self.gpu.queue().submit([encoder.finish()]);
        self.counts.map();
        Ok(grown)
    }

    /// Draws one frame, waits for it, and returns the time that each stage took on the GPU; `None`
    /// where the device cannot tell.
    ///
    /// # Errors
    /// Those of [`render`](Self::render).
    pub fn draw_timed(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Option<StageTimes>, GpuError> {
        camera.validate()?;
        let layers = settings.depth || settings.top_contributor;
        self.draw_until_complete(camera, settings, layers, Output::Image)?;
        match &self.timer {
            Some(timer) if self.main.regions().len() == 1 => timer.read(&self.gpu),
            _ => Ok(None),
        }
    }

    /// Makes the next frame evaluate the network again, whatever was drawn last: for benchmarks.
    pub fn forget_deformation(&mut self) {
        if let Some(stage) = &mut self.deform {
            stage.invalidate();
        }
    }

    /// Name of the kernel that evaluates the network; `None` in scenes without one.
    #[must_use]
    pub fn network_kernel(&self) -> Option<&'static str> {
        self.deform.as_ref().map(DeformStage::kernel_name)
    }

    /// Poses the splats and nothing else, and returns the time it took on the GPU; `None` where the
    /// device cannot tell.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn deform_timed(
        &mut self,
        time: f32,
        static_threshold: Option<f32>,
    ) -> Result<Option<Duration>, GpuError> {
        let Some(stage) = &mut self.deform else { return Ok(None) };
        // The dispatch's size is computed by a kernel that is bound to a target.
        let request =
            TargetRequest { size: [TILE; 2], only_tile: Some([0, 0]), layers: false, pieces: 1 };
        let kernels = self.gpu.kernels();
        self.pixel.prepare(&self.gpu, request, self.entries.pairs.capacity)?;
        self.pixel.bind(&self.gpu, &kernels.tiles, &self.order, &self.projected, &self.entries);
        let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
        let queries = self.timer.as_ref().map(Timer::queries);
        let work = stage.prepare(&self.gpu, time, static_threshold);
        record_deform(stage, work, kernels, &self.pixel, &self.order, &mut encoder, queries);
        if let Some(timer) = &self.timer {
            timer.resolve_deform(&mut encoder);
        }
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.wait()?;
        self.timer.as_ref().map_or(Ok(None), |timer| timer.read_deform(&self.gpu))
    }

    /// Positions of all splats at a time, relative to the scene's origin.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn deformed_positions(
        &mut self,
        time: f32,
        static_threshold: Option<f32>,
    ) -> Result<Vec<[f32; 3]>, GpuError> {
        self.deform_timed(time, static_threshold)?;
        let poses = self.deform.as_ref().map_or(&self.buffers.canonical_poses, |s| &s.poses);
        let poses: Vec<Pose> = readback::read(&self.gpu, poses, u64::from(self.buffers.count))?;
        Ok(poses.iter().map(|pose| pose.position).collect())
    }

    /// Draws until the frame has fitted into the buffers.
    fn draw_until_complete(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
        layers: bool,
        output: Output,
    ) -> Result<(), GpuError> {
        loop {
            let encoder = self.encode(camera, settings, layers, output, true)?;
            self.gpu.queue().submit([encoder.finish()]);
            let counts = readback::counts(&self.gpu, &self.order.counts)?;
            self.last_counts = counts;
            let tiles = match output {
                Output::Image => tile_count([camera.width, camera.height]),
                Output::Tile(_) => 1,
            };
            if !self.make_room(counts, tiles)? {
                return Ok(());
            }
        }
    }

    /// Makes room for the entries that a frame needed; `false` when there was enough.
    fn make_room(&mut self, counts: Counts, tiles: u32) -> Result<bool, GpuError> {
        let need = counts.most_entries;
        let capacity = self.entries.pairs.capacity;
        if need <= capacity {
            return Ok(false);
        }
        let most = max_capacity(&self.gpu);
        if need > most {
            // Regions of the image, one after the other.
            let times = need.div_ceil(most).max(2);
            if self.pieces >= tiles {
                return Err(GpuError::OutOfMemory {
                    what: "splats in one tile",
                    need: u64::from(need) * 16,
                    have: u64::from(most) * 16,
                });
            }
            self.pieces = self.pieces.saturating_mul(times).min(tiles);
        }
        let wanted = (u64::from(need) * 5 / 4).min(u64::from(most)) as u32;
        if wanted > capacity {
            // The old buffers go first: both together might not fit.
            self.main.unbind();
            self.pixel.unbind();
            let kernels = &self.gpu.kernels().sort;
            self.entries = EntryBuffers::new(&self.gpu, kernels, &self.order.counts, wanted)?;
        }
        Ok(true)
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
            Output::Tile(_) => &mut self.pixel,
        };
        target.prepare(gpu, request, self.entries.pairs.capacity)?;
        target.bind(gpu, &kernels.tiles, &self.order, &self.projected, &self.entries);
        let target = &*target;

        self.buffers.select(gpu, settings);
        let camera = camera.relative_to(self.scene.origin);
        let frame = frame_uniform(&camera, settings, &self.buffers);
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

/// Lowest bits of the digits of a depth.
const DEPTH_SHIFTS: [u32; 4] = [0, 8, 16, 24];
