//! What a stage costs and gives, for benchmarks and tests.

use std::time::Duration;

use trapeze_scene::{Camera, FrameSettings};

use super::{Output, Renderer, record_deform};
use crate::deform::DeformStage;
use crate::layout::Pose;
use crate::region::TILE;
use crate::tiles::TargetRequest;
use crate::timing::{StageTimes, Timer};
use crate::{GpuError, readback};

impl Renderer {
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
        self.pick.target.prepare(&self.gpu, request, self.entries.pairs.capacity)?;
        self.pick.target.bind(
            &self.gpu,
            &kernels.tiles,
            &self.order,
            &self.projected,
            &self.entries,
        );
        let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
        let queries = self.timer.as_ref().map(Timer::queries);
        let work = stage.prepare(&self.gpu, time, static_threshold);
        record_deform(stage, work, kernels, &self.pick.target, &self.order, &mut encoder, queries);
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
}
