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

use rayon::prelude::*;
use trapeze_scene::{Camera, ColorSource, Frame, FrameSettings, Scene, SceneError, Splats};

use crate::RendererOptions;
use crate::bin::{BandLists, bin_bands};
use crate::deform::{DeformationOptions, DeformationStage, Deformed};
use crate::deform_backward::{PoseRule, unit_backward};
use crate::gradient::{GradientChunk, ImageGradient, PoseGradients, gradient_chunks, reset_like};
use crate::project::{ProjectedSplat, ProjectionStage, project};
use crate::project_backward::{BackwardView, SplatInput, project_backward};
use crate::rasterize::{Outputs, Target, rasterize};
use crate::rasterize_backward::{BackwardTarget, SplatSums, rasterize_backward};
use crate::sort::SortStage;

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
    projected: Vec<ProjectedSplat>,
    sort: SortStage,
    sorted: Vec<ProjectedSplat>,
    bands: BandLists,
    frame: Frame,
    last: Option<LastFrame>,
}

/// How the frame that is saved came about.
#[derive(Clone, Debug)]
struct LastFrame {
    view: BackwardView,
    pose_rule: PoseRule,
    splats: usize,
}

/// No rank: a splat that was not drawn.
const NOT_DRAWN: u32 = u32::MAX;

impl DifferentiableRenderer {
    /// A renderer with a choice of SIMD level and tile size.
    #[must_use]
    pub fn new(options: RendererOptions) -> Self {
        Self {
            options,
            poses: Deformed::default(),
            projection: ProjectionStage::default(),
            projected: Vec::new(),
            sort: SortStage::default(),
            sorted: Vec::new(),
            bands: BandLists::default(),
            frame: Frame::default(),
            last: None,
        }
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
        let relative = camera.relative_to(scene.origin);
        let pose_rule = self.pose(scene, settings);
        self.projection.set_splats(&scene.splats);
        project(scene, &self.projection, &self.poses, &relative, settings, &mut self.projected);
        self.sort.sort(&self.projected, &mut self.sorted);
        let size = (camera.width, camera.height);
        self.bands = bin_bands(self.options.level, &self.sorted, size, self.options.tile);
        let target = Target {
            width: camera.width,
            height: camera.height,
            tile: self.options.tile,
            outputs: Outputs { depth: settings.depth, top_contributor: settings.top_contributor },
            level: self.options.level,
        };
        rasterize(&self.sorted, &self.bands, &target, &mut self.frame);
        let degree = match settings.color_source {
            ColorSource::SphericalHarmonics => {
                Some(scene.splats.sh_degree.min(settings.max_sh_degree))
            }
            ColorSource::Clusters | ColorSource::Motion => None,
        };
        let view = BackwardView::new(&relative, degree);
        self.last = Some(LastFrame { view, pose_rule, splats: scene.len() });
        Ok(&self.frame)
    }

    /// The vector–Jacobian product of the last [`forward`](Self::forward): ∂L/∂(stored parameters)
    /// from ∂L/∂frame. `scene` must be the one that was rendered, unchanged.
    ///
    /// `by_splats` takes the shape of the scene's splats; splats that no pixel saw get zeros.
    /// The derivative is that of the image away from its cut-offs (α = 1/255, T = 10⁻⁴, the order
    /// of splats), which are taken as constant; at a clamp (α = 0.99, a colour of 0, the floor of a
    /// deformed scale) it is zero. In scenes with a deformation network the network's outputs are
    /// taken as given. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// [`SceneError::Length`] when the gradient or the scene does not belong to the last frame, or
    /// depth is asked for that it did not have.
    pub fn backward(
        &self,
        scene: &Scene,
        gradient: &ImageGradient<'_>,
        by_splats: &mut Splats,
    ) -> Result<(), SceneError> {
        self.backward_to(scene, gradient, by_splats, None)
    }

    /// [`backward`](Self::backward), which also gives the gradient by the poses: where a network's
    /// own backward pass starts.
    ///
    /// # Errors
    /// Those of [`backward`](Self::backward).
    pub fn backward_with_poses(
        &self,
        scene: &Scene,
        gradient: &ImageGradient<'_>,
        by_splats: &mut Splats,
        by_poses: &mut PoseGradients,
    ) -> Result<(), SceneError> {
        self.backward_to(scene, gradient, by_splats, Some(by_poses))
    }

    fn backward_to(
        &self,
        scene: &Scene,
        gradient: &ImageGradient<'_>,
        by_splats: &mut Splats,
        by_poses: Option<&mut PoseGradients>,
    ) -> Result<(), SceneError> {
        let last = self.checked(scene, gradient)?;
        let target = BackwardTarget { tile: self.options.tile, level: self.options.level };
        let sums = rasterize_backward(&self.sorted, &self.bands, &self.frame, gradient, target);
        let mut rank_of = vec![NOT_DRAWN; last.splats];
        for (rank, splat) in (0u32..).zip(&self.sorted) {
            rank_of[splat.index as usize] = rank;
        }
        reset_like(by_splats, &scene.splats);
        gradient_chunks(by_splats, by_poses).into_par_iter().for_each(|mut chunk| {
            for at in 0..chunk.len() {
                let rank = rank_of[chunk.first + at];
                if rank != NOT_DRAWN {
                    self.backward_splat(scene, last, rank as usize, &sums, &mut chunk, at);
                }
            }
        });
        Ok(())
    }

    /// Carries the sums of one splat back to its parameters, entry `at` of a chunk.
    fn backward_splat(
        &self,
        scene: &Scene,
        last: &LastFrame,
        rank: usize,
        sums: &[SplatSums],
        chunk: &mut GradientChunk<'_>,
        at: usize,
    ) {
        let splats = &scene.splats;
        let i = chunk.first + at;
        let pose = self.poses.pose(i);
        let input = SplatInput { pose, sh_dc: splats.sh_dc[i], sh_rest: splats.sh_rest_of(i) };
        let sh_rest = chunk.sh_rest_of(at);
        let by_pose =
            project_backward(&last.view, &input, &self.sorted[rank], &sums[rank], sh_rest);
        if let Some(poses) = &mut chunk.poses {
            poses.positions[at] = by_pose.position;
            poses.rotations[at] = by_pose.rotation;
            poses.scales[at] = by_pose.scale;
        }
        let by_sum = last.pose_rule.sum_backward(&pose, by_pose.rotation, by_pose.scale);
        let canonical = match last.pose_rule {
            PoseRule::Static => pose,
            PoseRule::Deformed(_) => Deformed::static_pose(splats, i),
        };
        chunk.positions[at] = by_pose.position;
        chunk.rotations[at] =
            unit_backward(canonical.rotation, canonical.rotation_length, by_sum.rotation);
        chunk.log_scales[at] = std::array::from_fn(|c| by_sum.scale[c] * canonical.scale[c]);
        // d log₂ σ(x) = (1 − σ(x)) / ln 2 dx.
        let transparency = 1.0 - self.projection.opacities()[i];
        chunk.opacity_logits[at] = by_pose.log2_opacity * transparency * std::f32::consts::LOG2_E;
        chunk.sh_dc[at] = by_pose.sh_dc;
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
        self.poses.clone_from(stage.deform(scene, settings.time, settings.static_threshold));
        PoseRule::Deformed(network.rotation_rule)
    }

    fn checked(
        &self,
        scene: &Scene,
        gradient: &ImageGradient<'_>,
    ) -> Result<&LastFrame, SceneError> {
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
        Ok(last)
    }
}
