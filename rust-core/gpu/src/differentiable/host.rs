//! Both passes for callers that hold everything on the host, and wait.

use trapeze_scene::{Camera, Frame, Splats};

use super::{DifferentiableRenderer, ForwardSettings, FrameStatus, ImageGradientBuffers};
use crate::compute::{counter, read};
use crate::{GpuError, ParameterBuffers};

impl DifferentiableRenderer {
    /// Draws one frame, waiting until it has fitted into the buffers, and returns it. `camera` is
    /// relative to the origin of the splats.
    ///
    /// # Errors
    /// Those of [`forward`](Self::forward) and [`make_room`](Self::make_room), and
    /// [`GpuError::Device`] when the device is lost.
    pub fn forward_and_wait(
        &mut self,
        parameters: &ParameterBuffers,
        camera: &Camera,
        settings: ForwardSettings,
    ) -> Result<(Frame, FrameStatus), GpuError> {
        let status = loop {
            let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
            self.record_resume(&mut encoder);
            self.forward(&mut encoder, parameters, camera, settings)?;
            self.gpu.queue().submit([encoder.finish()]);
            let words: Vec<u32> = read(&self.gpu, &self.counts, counter::COUNT as u64)?;
            let status = FrameStatus::from_words(&words);
            if !status.halted {
                break status;
            }
            self.make_room(status.most_entries)?;
        };
        let pixels = u64::from(self.image.pixel_count());
        let mut frame = Frame { width: camera.width, height: camera.height, ..Frame::default() };
        frame.color = read(&self.gpu, &self.image.image, pixels)?;
        if settings.depth {
            let layers: Vec<[u32; 4]> = read(&self.gpu, &self.image.layers, pixels)?;
            frame.expected_depth = layers.iter().map(|v| f32::from_bits(v[0])).collect();
        }
        Ok((frame, status))
    }

    /// Carries a gradient of the last frame back and waits for it: ∂L/∂(r, g, b premultiplied,
    /// alpha) and, if there is one, ∂L/∂(expected depth), one entry per pixel.
    ///
    /// # Errors
    /// Those of [`backward`](Self::backward), and [`GpuError::Device`] when the device is lost.
    pub fn backward_and_wait(
        &mut self,
        parameters: &ParameterBuffers,
        by_color: &[[f32; 4]],
        by_expected_depth: Option<&[f32]>,
    ) -> Result<Splats, GpuError> {
        let color = self.gpu.storage_of("gradient by colour", by_color)?;
        let depth = match by_expected_depth {
            Some(values) => Some(self.gpu.storage_of("gradient by depth", values)?),
            None => None,
        };
        let by_image = ImageGradientBuffers { color: &color, expected_depth: depth.as_ref() };
        let mut gradients =
            ParameterBuffers::zeroed(&self.gpu, parameters.count, parameters.sh_degree)?;
        gradients.count = parameters.count;
        let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
        self.backward(&mut encoder, parameters, by_image, &gradients)?;
        self.gpu.queue().submit([encoder.finish()]);
        gradients.read(&self.gpu)
    }
}
