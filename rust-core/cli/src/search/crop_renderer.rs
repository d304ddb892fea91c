//! The CPU renderer as the source of crops.

use std::error::Error;
use std::sync::Arc;

use trapeze_cpu::Renderer;
use trapeze_cpu::deform::DeformationStage;
use trapeze_query::crops::CropRenderer;
use trapeze_scene::{Camera, Frame, FrameSettings, Scene};

/// Renders the scene that is searched.
pub(crate) struct CpuCropRenderer(Renderer);

impl CpuCropRenderer {
    pub(crate) fn new(scene: Arc<Scene>) -> Self {
        Self(Renderer::new(scene))
    }
}

impl CropRenderer for CpuCropRenderer {
    fn positions(&mut self, time: f32) -> Vec<[f32; 3]> {
        self.0.positions(time).to_vec()
    }

    fn render(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Frame, Box<dyn Error + Send + Sync>> {
        Ok(self.0.render(camera, settings)?)
    }
}

/// Centres of all splats at each of the times.
pub(crate) fn positions_at(scene: &Scene, times: &[f32]) -> Vec<Vec<[f32; 3]>> {
    let mut stage = DeformationStage::new(scene);
    times.iter().map(|&time| stage.evaluate(time, None).positions.clone()).collect()
}
