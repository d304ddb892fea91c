//! The stages put together: one frame after another from the same working memory.

use std::sync::Arc;
use std::time::{Duration, Instant};

use fearless_simd::Level;
use trapeze_scene::{Camera, Frame, FrameSettings, NO_SPLAT, Scene, SceneError};

use crate::bin::{BandLists, TileSize};
use crate::deform::{DeformationOptions, DeformationStage};
use crate::project::{ProjectedSplat, ProjectedSplats, ProjectionStage, project};
use crate::rasterize::{Outputs, Target, rasterize};
use crate::sort::SortStage;

/// How frames are made; none of it changes the image beyond rounding.
#[derive(Clone, Copy, Debug)]
pub struct RendererOptions {
    /// SIMD instructions to use: the best that the machine has, by default.
    pub level: Level,
    /// Tile size.
    pub tile: TileSize,
}

impl Default for RendererOptions {
    fn default() -> Self {
        Self { level: Level::new(), tile: TileSize::default() }
    }
}

/// Time spent in each stage of the last frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageTimes {
    /// Deformation network and its application.
    pub deform: Duration,
    /// World → image.
    pub project: Duration,
    /// Drawing order.
    pub sort: Duration,
    /// Splats by band.
    pub bin: Duration,
    /// Tile lists and blending.
    pub rasterize: Duration,
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

/// Renders a scene on the CPU with all threads of the current rayon pool.
#[derive(Debug)]
pub struct Renderer {
    scene: Arc<Scene>,
    options: RendererOptions,
    deform: DeformationStage,
    project: ProjectionStage,
    sort: SortStage,
    projected: ProjectedSplats,
    sorted: Vec<ProjectedSplat>,
    bands: BandLists,
    times: StageTimes,
}

impl Renderer {
    /// A renderer for a scene.
    #[must_use]
    pub fn new(scene: Arc<Scene>) -> Self {
        Self::with_options(scene, RendererOptions::default())
    }

    /// A renderer with a choice of SIMD level and tile size.
    #[must_use]
    pub fn with_options(scene: Arc<Scene>, options: RendererOptions) -> Self {
        Self {
            deform: DeformationStage::with_options(
                &scene,
                DeformationOptions { level: options.level, ..DeformationOptions::default() },
            ),
            project: ProjectionStage::new(&scene),
            sort: SortStage::default(),
            projected: ProjectedSplats::default(),
            sorted: Vec::new(),
            bands: BandLists::default(),
            times: StageTimes::default(),
            scene,
            options,
        }
    }

    /// The scene that is rendered.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Time spent in each stage of the last frame.
    #[must_use]
    pub fn stage_times(&self) -> StageTimes {
        self.times
    }

    /// Splats that the last frame drew, after culling.
    #[must_use]
    pub fn visible_splats(&self) -> usize {
        self.sorted.len()
    }

    /// Centres of all splats at a time, relative to the scene's origin; nothing rests. Frames of the
    /// same time that follow do not evaluate the network again.
    pub fn positions(&mut self, time: f32) -> &[[f32; 3]] {
        &self.deform.deform(&self.scene, time, None).positions
    }

    /// Renders one frame.
    ///
    /// # Errors
    /// [`SceneError::Camera`] when the camera cannot project.
    pub fn render(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Frame, SceneError> {
        let mut frame = Frame::default();
        self.render_into(camera, settings, &mut frame)?;
        Ok(frame)
    }

    /// Renders one frame into buffers that are reused.
    ///
    /// # Errors
    /// [`SceneError::Camera`] when the camera cannot project.
    pub fn render_into(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
        frame: &mut Frame,
    ) -> Result<(), SceneError> {
        camera.validate()?;
        self.order_splats(camera, settings);
        let start = Instant::now();
        let target = self.target(camera, settings);
        let size = (camera.width, camera.height);
        self.bands.fill(self.options.level, &self.sorted, size, self.options.tile);
        self.times.bin = start.elapsed();
        let start = Instant::now();
        rasterize(&self.sorted, &self.bands, &target, frame);
        self.times.rasterize = start.elapsed();
        Ok(())
    }

    /// What is seen at pixel (x, y), or `None` where nothing is or outside the image.
    ///
    /// Only that pixel is blended.
    ///
    /// # Errors
    /// [`SceneError::Camera`] when the camera cannot project.
    pub fn pick(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
        (x, y): (u32, u32),
    ) -> Result<Option<Pick>, SceneError> {
        camera.validate()?;
        if x >= camera.width || y >= camera.height {
            return Ok(None);
        }
        self.order_splats(camera, settings);
        // Move the pixel to the corner of a 1 × 1 image.
        let moved: Vec<ProjectedSplat> = self
            .sorted
            .iter()
            .map(|s| ProjectedSplat { x: s.x - x as f32, y: s.y - y as f32, ..*s })
            .filter(|s| s.x.abs() <= s.half_width + 1.0 && s.y.abs() <= s.half_height + 1.0)
            .collect();
        let outputs = Outputs { depth: true, top_contributor: true };
        let target = Target { width: 1, height: 1, outputs, ..self.target(camera, settings) };
        let mut bands = BandLists::default();
        bands.fill(self.options.level, &moved, (1, 1), self.options.tile);
        let mut frame = Frame::default();
        rasterize(&moved, &bands, &target, &mut frame);
        let splat = frame.top_contributor[0];
        let median = frame.median_depth[0];
        Ok((splat != NO_SPLAT).then(|| Pick {
            splat,
            cluster: self.scene.clusters.as_ref().map(|c| c.labels[splat as usize]),
            depth: if median.is_nan() { frame.expected_depth[0] } else { median },
        }))
    }

    fn target(&self, camera: &Camera, settings: &FrameSettings) -> Target {
        Target {
            width: camera.width,
            height: camera.height,
            tile: self.options.tile,
            outputs: Outputs { depth: settings.depth, top_contributor: settings.top_contributor },
            level: self.options.level,
        }
    }

    /// Deform, project and sort.
    fn order_splats(&mut self, camera: &Camera, settings: &FrameSettings) {
        let start = Instant::now();
        let deformed = self.deform.deform(&self.scene, settings.time, settings.static_threshold);
        self.times.deform = start.elapsed();

        let start = Instant::now();
        let camera = camera.relative_to(self.scene.origin);
        project(&self.scene, &self.project, deformed, &camera, settings, &mut self.projected);
        self.times.project = start.elapsed();

        let start = Instant::now();
        self.sort.sort(&self.projected, &mut self.sorted);
        self.times.sort = start.elapsed();
    }
}
