//! The stages and their mirror images put together: render with saved state, then carry any
//! gradient of the image back to the parameters.
//!
//! ```
//! # use trapeze_cpu::{DifferentiableRenderer, ImageGradient, RendererOptions};
//! # use trapeze_scene::{Camera, FrameSettings, Scene, Splats};
//! # fn descend(scene: &Scene, camera: &Camera) -> Result<Splats, trapeze_scene::SceneError> {
//! let mut renderer = DifferentiableRenderer::new(RendererOptions::default());
//! let frame = renderer.forward(scene, camera, &FrameSettings::default())?;
//! // L = ½ Σ |rgb|²: any function of the frame will do.
//! let by_color: Vec<_> = frame.color.iter().map(|&[r, g, b, _]| [r, g, b, 0.0]).collect();
//! let gradient = ImageGradient { color: &by_color, expected_depth: None };
//! let mut by_splats = Splats::default();
//! renderer.backward(scene, &gradient, &mut by_splats)?;
//! # Ok(by_splats)
//! # }
//! ```
//!
//! In a scene that moves, [`DifferentiableRenderer::backward_with_network`] also gives the gradient by
//! the weights of the network, in the order of `weights.bin`: a loss on the frame at any time trains
//! splats and network together.

mod network;
mod splats;

use std::time::{Duration, Instant};

use fearless_simd::dispatch;
use rayon::prelude::*;
use trapeze_scene::deformation::RestingSplats;
use trapeze_scene::{Camera, ColorSource, Frame, FrameSettings, Scene, SceneError, Splats};

use crate::bin::BandLists;
use crate::deform::{DeformationOptions, DeformationStage, Deformed};
use crate::deform_backward::{OutputGradient, PoseRule};
use crate::gradient::{ImageGradient, PoseGradients, gradient_chunks, shape_like};
use crate::project::{ProjectedSplat, ProjectedSplats, ProjectionStage, project};
use crate::project_backward::BackwardView;
use crate::rasterize::{Outputs, Target, rasterize};
use crate::rasterize_backward::{BackwardInput, BackwardMemory, rasterize_backward};
use crate::sort::SortStage;
use crate::{RendererOptions, StageTimes};
use splats::{NOT_DRAWN, SplatsBackward, backward_chunk};

/// Renders frames and keeps what the backward pass needs; one frame after another from the same
/// working memory.
///
/// Unlike [`Renderer`](crate::Renderer) it prepares nothing that outlives a frame, since the splats
/// change between frames.
#[derive(Debug)]
pub struct DifferentiableRenderer {
    options: RendererOptions,
    poses: Deformed,
    projection: ProjectionStage,
    projected: ProjectedSplats,
    sort: SortStage,
    sorted: Vec<ProjectedSplat>,
    bands: BandLists,
    frame: Frame,
    memory: BackwardMemory,
    by_outputs: Vec<OutputGradient>,
    resting: Option<RestingSplats>,
    last: Option<LastFrame>,
    times: PassTimes,
}

/// Time spent in each stage of the last forward and backward pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PassTimes {
    /// Stages of the forward pass.
    pub forward: StageTimes,
    /// Sums over the pixels of each splat.
    pub rasterize_backward: Duration,
    /// From these to the stored parameters.
    pub project_backward: Duration,
    /// Through the deformation network to its weights.
    pub deform_backward: Duration,
}

/// How the frame that is saved came about.
#[derive(Clone, Debug)]
struct LastFrame {
    view: BackwardView,
    pose_rule: PoseRule,
    time: f32,
    static_threshold: Option<f32>,
    splats: usize,
}

impl DifferentiableRenderer {
    /// A renderer with a choice of SIMD level and tile size.
    #[must_use]
    pub fn new(options: RendererOptions) -> Self {
        Self {
            options,
            poses: Deformed::default(),
            projection: ProjectionStage::default(),
            projected: ProjectedSplats::default(),
            sort: SortStage::default(),
            sorted: Vec::new(),
            bands: BandLists::default(),
            frame: Frame::default(),
            memory: BackwardMemory::default(),
            by_outputs: Vec::new(),
            resting: None,
            last: None,
            times: PassTimes::default(),
        }
    }

    /// From the next forward pass on, the network is evaluated for the splats that move, at the time of
    /// the frame; the others get what they hold, and no gradient goes from them to the network. `None`
    /// moves all. A masked frame ([`FrameSettings::static_threshold`]) is not affected.
    pub fn set_resting(&mut self, resting: Option<RestingSplats>) {
        self.resting = resting;
        self.last = None;
    }

    /// The splats that rest, if any.
    #[must_use]
    pub fn resting(&self) -> Option<&RestingSplats> {
        self.resting.as_ref()
    }

    /// The frame of the last forward pass.
    #[must_use]
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Splats that the last forward pass drew, after culling.
    #[must_use]
    pub fn visible_splats(&self) -> usize {
        self.sorted.len()
    }

    /// Time spent in each stage of the last passes.
    #[must_use]
    pub fn times(&self) -> PassTimes {
        self.times
    }

    /// Renders one frame, the same as [`Renderer::render`](crate::Renderer::render) does, and saves
    /// what [`backward`](Self::backward) needs.
    ///
    /// # Errors
    /// [`SceneError::Camera`] when the camera cannot project; [`SceneError::Length`] when an array
    /// of the scene does not have one entry per splat.
    pub fn forward(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<&Frame, SceneError> {
        self.last = None;
        camera.validate()?;
        scene.splats.validate()?;
        if let Some(resting) = &self.resting
            && resting.splats() != scene.len()
        {
            let (expected, found) = (scene.len(), resting.splats());
            return Err(SceneError::Length { field: "resting splats", expected, found });
        }
        let relative = camera.relative_to(scene.origin);
        let mut clock = Clock::start();
        let pose_rule = self.pose(scene, settings);
        let mut times = StageTimes { deform: clock.lap(), ..StageTimes::default() };
        self.projection.set_splats(&scene.splats);
        project(scene, &self.projection, &self.poses, &relative, settings, &mut self.projected);
        times.project = clock.lap();
        self.sort.sort(&self.projected, &mut self.sorted);
        times.sort = clock.lap();
        let size = (camera.width, camera.height);
        self.bands.fill(self.options.level, &self.sorted, size, self.options.tile);
        times.bin = clock.lap();
        let target = Target {
            width: camera.width,
            height: camera.height,
            tile: self.options.tile,
            outputs: Outputs { depth: settings.depth, top_contributor: settings.top_contributor },
            level: self.options.level,
        };
        rasterize(&self.sorted, &self.bands, &target, &mut self.frame);
        times.rasterize = clock.lap();
        self.times.forward = times;
        let degree = match settings.color_source {
            ColorSource::SphericalHarmonics => {
                Some(scene.splats.sh_degree.min(settings.max_sh_degree))
            }
            ColorSource::Clusters | ColorSource::Motion | ColorSource::Depth(_) => None,
        };
        let view = BackwardView::new(&relative, degree);
        self.last = Some(LastFrame {
            view,
            pose_rule,
            time: settings.time,
            static_threshold: settings.static_threshold,
            splats: scene.len(),
        });
        Ok(&self.frame)
    }

    /// The vector–Jacobian product of the last [`forward`](Self::forward): ∂L/∂(stored parameters)
    /// from ∂L/∂frame. `scene` must be the one that was rendered, unchanged.
    ///
    /// `by_splats` takes the shape of the scene's splats; splats that no pixel saw get zeros.
    /// The derivative is that of the image away from its cut-offs (α = 1/255, T = 10⁻⁴, the order
    /// of splats), which are taken as constant; at a clamp (α = 0.99, a colour of 0, the floor of a
    /// deformed scale) it is zero. In scenes with a deformation network the network's outputs are
    /// taken as given; [`backward_with_network`](Self::backward_with_network) differentiates by its
    /// weights too. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// [`SceneError::Length`] when the gradient or the scene does not belong to the last frame, or
    /// depth is asked for that it did not have.
    pub fn backward(
        &mut self,
        scene: &Scene,
        gradient: &ImageGradient<'_>,
        by_splats: &mut Splats,
    ) -> Result<(), SceneError> {
        self.backward_to(scene, gradient, by_splats, None, None)
    }

    /// [`backward`](Self::backward), which goes on through the deformation network: `by_network` gets
    /// ∂L/∂(its weights and biases), layer by layer in the order of [`DeformationNetwork::layers`](trapeze_scene::DeformationNetwork::layers),
    /// the weight (row-major, outputs × inputs) before the bias. Without a network it gets nothing.
    ///
    /// The positions that enter the network are taken as constant, as in training (Deformable 3D
    /// Gaussians). Only splats that some pixel saw are carried back; none of it depends on the
    /// number of threads.
    ///
    /// # Errors
    /// Those of [`backward`](Self::backward).
    pub fn backward_with_network(
        &mut self,
        scene: &Scene,
        gradient: &ImageGradient<'_>,
        by_splats: &mut Splats,
        by_network: &mut Vec<f32>,
    ) -> Result<(), SceneError> {
        by_network.clear();
        let Some(network) = &scene.deformation else {
            return self.backward(scene, gradient, by_splats);
        };
        let mut by_outputs = std::mem::take(&mut self.by_outputs);
        let carried = self.backward_to(scene, gradient, by_splats, None, Some(&mut by_outputs));
        self.by_outputs = by_outputs;
        carried?;
        by_network.resize(network.parameter_count(), 0.0);
        let mut clock = Clock::start();
        self.carry_to_network(scene, network, by_network);
        self.times.deform_backward = clock.lap();
        Ok(())
    }

    /// [`backward`](Self::backward), which also gives the gradient by the poses.
    ///
    /// # Errors
    /// Those of [`backward`](Self::backward).
    pub fn backward_with_poses(
        &mut self,
        scene: &Scene,
        gradient: &ImageGradient<'_>,
        by_splats: &mut Splats,
        by_poses: &mut PoseGradients,
    ) -> Result<(), SceneError> {
        self.backward_to(scene, gradient, by_splats, Some(by_poses), None)
    }

    fn backward_to(
        &mut self,
        scene: &Scene,
        gradient: &ImageGradient<'_>,
        by_splats: &mut Splats,
        by_poses: Option<&mut PoseGradients>,
        by_outputs: Option<&mut Vec<OutputGradient>>,
    ) -> Result<(), SceneError> {
        let mut clock = Clock::start();
        self.check(scene, gradient)?;
        let Some(last) = &self.last else { return Ok(()) };
        let rasterized = BackwardInput {
            splats: &self.sorted,
            bands: &self.bands,
            frame: &self.frame,
            gradient: *gradient,
            tile: self.options.tile,
            level: self.options.level,
        };
        let sums = rasterize_backward(&rasterized, &mut self.memory);
        let rasterize_backward = clock.lap();
        let mut rank_of = vec![NOT_DRAWN; last.splats];
        for (rank, splat) in (0u32..).zip(&self.sorted) {
            rank_of[splat.index as usize] = rank;
        }
        let input = SplatsBackward {
            splats: &scene.splats,
            poses: &self.poses,
            opacities: self.projection.opacities(),
            sorted: &self.sorted,
            rank_of: &rank_of,
            sums,
            last,
        };
        shape_like(by_splats, &scene.splats);
        gradient_chunks(by_splats, by_poses, by_outputs).into_par_iter().for_each(|mut chunk| {
            dispatch!(self.options.level, simd => backward_chunk(simd, &input, &mut chunk));
        });
        self.times.rasterize_backward = rasterize_backward;
        self.times.project_backward = clock.lap();
        self.times.deform_backward = Duration::ZERO;
        Ok(())
    }

    /// Stage 1, and how it was done.
    fn pose(&mut self, scene: &Scene, settings: &FrameSettings) -> PoseRule {
        let Some(network) = &scene.deformation else {
            self.poses.set_static(&scene.splats);
            return PoseRule::Static;
        };
        // Nothing is kept between frames, so the terms of the positions are not worth memory.
        let options = DeformationOptions { level: self.options.level, position_term_budget: 0 };
        let mut stage = DeformationStage::with_options(scene, options);
        let poses = match (&self.resting, settings.static_threshold) {
            (Some(resting), None) => stage.evaluate_beside(settings.time, resting),
            _ => stage.deform(scene, settings.time, settings.static_threshold),
        };
        self.poses.clone_from(poses);
        PoseRule::Deformed(network.rotation_rule)
    }

    /// Whether the last frame was rendered from `scene` and is what `gradient` is of.
    fn check(&self, scene: &Scene, gradient: &ImageGradient<'_>) -> Result<(), SceneError> {
        let length = |field, expected, found| SceneError::Length { field, expected, found };
        let pixels = self.frame.color.len();
        let last = self.last.as_ref().ok_or(length("rendered frames", 1, 0))?;
        if scene.len() != last.splats {
            return Err(length("splats of the rendered scene", last.splats, scene.len()));
        }
        scene.splats.validate()?;
        if gradient.color.len() != pixels {
            return Err(length("pixels of the color gradient", pixels, gradient.color.len()));
        }
        if let Some(depth) = gradient.expected_depth {
            let found = depth.len().min(self.frame.expected_depth.len());
            if depth.len() != pixels || found != pixels {
                return Err(length("pixels of the depth gradient", pixels, found));
            }
        }
        Ok(())
    }
}

/// Time since the last lap.
struct Clock(Instant);

impl Clock {
    fn start() -> Self {
        Self(Instant::now())
    }

    fn lap(&mut self) -> Duration {
        let now = Instant::now();
        now - std::mem::replace(&mut self.0, now)
    }
}
