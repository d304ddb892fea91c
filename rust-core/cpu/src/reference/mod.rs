//! The executable specification: every stage in f64, one splat and one pixel at a time.
//!
//! Nothing here is fast and nothing here is approximated. Where `docs/numerics.md` and this code
//! disagree, this code is right; every other path in the project is reported against it.
//!
//! Stages, in order: [`deform`], [`pose_scene`] (activations and colour), [`Projection`]
//! (EWA, Zwicker et al. 2001), [`rasterize`] (front-to-back blending, Porter & Duff 1984).

pub mod deform;
mod pose;
mod project;
mod rasterize;

use trapeze_scene::{Camera, FrameSettings, Scene};

pub use pose::{PosedSplat, pose_scene};
pub use project::{
    ALPHA_MAX, ALPHA_MIN, JACOBIAN_MARGIN, LOW_PASS, NEAR_PLANE, ProjectedSplat, Projection,
    TRANSMITTANCE_MIN,
};
pub use rasterize::{ReferenceFrame, Visit, rasterize};

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
    let projection = Projection::new(&camera);
    let mut projected: Vec<ProjectedSplat> = pose_scene(scene, &camera, settings)
        .iter()
        .filter_map(|splat| projection.project(splat))
        .collect();
    projected.sort_by(|a, b| a.depth.total_cmp(&b.depth).then(a.index.cmp(&b.index)));
    rasterize(&projected, (camera.width, camera.height), visit)
}
