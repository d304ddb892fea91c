//! The executable specification: every stage in f64, one splat and one pixel at a time.
//!
//! Nothing here is fast and nothing here is approximated. Where `docs/numerics.md` and this code
//! disagree, this code is right; every other path in the project is reported against it.
//!
//! Stages, in order: [`deform`], [`pose_scene`] (activations and colour), [`Projection`]
//! (EWA, Zwicker et al. 2001), [`rasterize`] (front-to-back blending, Porter & Duff 1984). Their
//! mirror images, in reverse: [`rasterize_backward`], [`Projection::project_backward`],
//! [`pose_backward`], [`network_gradient`].

pub mod deform;
mod network_backward;
mod parameters;
mod pose;
mod pose_backward;
mod project;
mod project_backward;
mod rasterize;
mod rasterize_backward;

use rayon::prelude::*;
use trapeze_scene::{Camera, FrameSettings, Scene};

use crate::gradient::ImageGradient;
use deform::NetworkOutput;

pub use network_backward::{LayerGradient, NetworkGradient, network_backward, network_gradient};
pub(crate) use network_backward::{screw_backward, time_network_backward};
pub use parameters::SplatParameters;
pub use pose::{PosedSplat, pose_scene};
pub use pose_backward::{StoredGradient, pose_backward};
pub use project::{
    ALPHA_MAX, ALPHA_MIN, JACOBIAN_MARGIN, LOW_PASS, NEAR_PLANE, ProjectedSplat, Projection,
    TRANSMITTANCE_MIN,
};
pub use project_backward::PosedGradient;
pub use rasterize::{ReferenceFrame, Visit, rasterize};
pub use rasterize_backward::{ProjectedGradient, rasterize_backward};

/// Renders one frame of a scene.
///
/// The painter's loop visits, for each splat in depth order, the pixels of a rectangle that
/// contains every pixel where its α can reach 1/255.
#[must_use]
pub fn render(scene: &Scene, camera: &Camera, settings: &FrameSettings) -> ReferenceFrame {
    render_visiting(scene, camera, settings, Visit::Rectangle)
}

/// [`render`] with a choice of which pixels each splat visits; [`Visit::AllPixels`] is the form
/// without any geometry in it, to test the rectangles against.
#[must_use]
pub fn render_visiting(
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
    visit: Visit,
) -> ReferenceFrame {
    let camera = camera.relative_to(scene.origin);
    let (_, projected) = project_in_order(scene, &camera, settings);
    rasterize(&projected, (camera.width, camera.height), visit)
}

/// Gradients of any loss on a rendered frame, by the parameters of every splat: the mirror of
/// [`render`], stage by stage.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceGradients {
    /// By the stored parameters.
    pub splats: Vec<SplatParameters>,
    /// By the pose at the time of the frame, and by opacity (0–1) and colour.
    pub poses: Vec<PosedGradient>,
    /// By what the deformation network adds to each splat: where [`network_gradient`] starts. In
    /// scenes without one, by what it would add.
    pub outputs: Vec<NetworkOutput>,
}

/// The vector–Jacobian product of [`render`] with ∂L/∂image. [`pose_backward`] says what is taken
/// as constant in scenes with a deformation network.
///
/// # Panics
/// When the gradient has another number of pixels than the camera's image.
#[must_use]
pub fn gradients(
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
    gradient: &ImageGradient<'_>,
) -> ReferenceGradients {
    let camera = camera.relative_to(scene.origin);
    let (posed, projected) = project_in_order(scene, &camera, settings);
    let by_projected = rasterize_backward(&projected, (camera.width, camera.height), gradient);
    let projection = Projection::new(&camera);
    let mut poses = vec![PosedGradient::default(); scene.len()];
    let index_of: Vec<usize> = index_of_posed(&posed, scene.len());
    for (splat, by_projected) in projected.iter().zip(&by_projected) {
        let source = &posed[index_of[splat.index as usize]];
        poses[splat.index as usize] = projection.project_backward(source, splat, by_projected);
    }
    let eye = camera.centre();
    let (splats, outputs) = poses
        .par_iter()
        .enumerate()
        .map(|(i, by_pose)| pose_backward(scene, i, eye, settings, by_pose))
        .map(|StoredGradient { splat, output }| (splat, output))
        .unzip();
    ReferenceGradients { splats, poses, outputs }
}

/// Posed splats in the order of the scene, and those that are projected in drawing order. `camera`
/// is relative to the scene's origin.
fn project_in_order(
    scene: &Scene,
    camera: &Camera,
    settings: &FrameSettings,
) -> (Vec<PosedSplat>, Vec<ProjectedSplat>) {
    let projection = Projection::new(camera);
    let posed = pose_scene(scene, camera, settings);
    let mut projected: Vec<ProjectedSplat> =
        posed.iter().filter_map(|splat| projection.project(splat)).collect();
    projected.sort_by(|a, b| a.depth.total_cmp(&b.depth).then(a.index.cmp(&b.index)));
    (posed, projected)
}

/// Where each splat of the scene is among the posed ones, which leave out what is not shown.
fn index_of_posed(posed: &[PosedSplat], splats: usize) -> Vec<usize> {
    let mut index = vec![usize::MAX; splats];
    for (at, splat) in posed.iter().enumerate() {
        index[splat.index as usize] = at;
    }
    index
}
