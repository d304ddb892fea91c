//! Pictures for the image tower.

use std::error::Error;
use std::sync::Arc;

use trapeze_cpu::deform::DeformationStage;
use trapeze_query::crops::CropRenderer;
use trapeze_scene::{Camera, Frame, FrameSettings, Scene};

use crate::failure::Failure;
use crate::renderer::{Backend, Renderer};
use crate::work::Work;

/// A renderer of its own, in full precision and with all harmonics, on the device of the one that is
/// on the screen.
pub(super) struct OffscreenCrops<'a> {
    backend: Backend,
    scene: Arc<Scene>,
    /// Where the splats are on a graphics device is not read back; it is computed here as well, for
    /// the few times at which clusters are looked at. Made when it is first asked for.
    stage: Option<DeformationStage>,
    work: &'a Work,
}

impl<'a> OffscreenCrops<'a> {
    pub(super) fn new(
        renderer: &Renderer,
        scene: &Arc<Scene>,
        work: &'a Work,
    ) -> Result<Self, Failure> {
        let backend = renderer.offscreen(Arc::clone(scene))?;
        Ok(Self { backend, scene: Arc::clone(scene), stage: None, work })
    }
}

impl CropRenderer for OffscreenCrops<'_> {
    fn positions(&mut self, time: f32) -> Vec<[f32; 3]> {
        match &mut self.backend {
            Backend::Cpu(renderer) => renderer.positions(time).to_vec(),
            Backend::Gpu(_) => {
                let stage = self.stage.get_or_insert_with(|| DeformationStage::new(&self.scene));
                stage.evaluate(time, None).positions.clone()
            }
        }
    }

    /// Ends as cancelled when nobody waits any more: a cluster takes dozens of frames.
    fn render(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Frame, Box<dyn Error + Send + Sync>> {
        self.work.check()?;
        Ok(self.backend.render(camera, settings)?)
    }
}
