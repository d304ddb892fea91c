//! What both passes do before their dispatches: check, make buffers and bindings fit, write the
//! uniform blocks.

use trapeze_scene::{Camera, FrameSettings, SceneError};

use super::backward::BackwardBindings;
use super::buffers::{Prepared, SplatBuffers};
use super::forward::{ForwardBindings, FrameBuffers};
use super::{DifferentiableRenderer, ForwardSettings, ImageGradientBuffers, LastFrame};
use crate::layout::SplatCount;
use crate::project::frame_uniform;
use crate::timing::Timer;
use crate::{GpuError, ParameterBuffers};

impl DifferentiableRenderer {
    pub(super) fn record_forward(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        parameters: &ParameterBuffers,
        camera: &Camera,
        settings: ForwardSettings,
        timed: bool,
    ) -> Result<(), GpuError> {
        self.last = None;
        camera.validate()?;
        self.prepare(parameters, camera, settings)?;
        self.write_uniforms(parameters, camera, settings);
        let own = self.gpu.kernels().differentiable(&self.gpu);
        let frame = FrameBuffers {
            uniforms: &self.uniforms,
            splats: &self.splats,
            slots: &self.slots,
            image: &self.image,
        };
        let make = || ForwardBindings::new(&self.gpu, own, parameters, frame);
        let bindings = self.forward.get_or_insert_with(make);
        bindings.parameters.count = parameters.count;
        let timestamps = self.timer.as_ref().filter(|_| timed).map(Timer::queries);
        bindings.record(self.gpu.kernels(), own, frame, settings.depth, encoder, timestamps);
        self.last = Some(LastFrame {
            count: parameters.count,
            sh_degree: parameters.sh_degree,
            depth: settings.depth,
        });
        Ok(())
    }

    pub(super) fn record_backward(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        parameters: &ParameterBuffers,
        by_image: ImageGradientBuffers<'_>,
        gradients: &ParameterBuffers,
        timed: bool,
    ) -> Result<(), GpuError> {
        self.check_backward(parameters, by_image, gradients)?;
        if self.backward.as_ref().is_some_and(|bound| !bound.are_of(by_image, gradients)) {
            self.backward = None;
        }
        let own = self.gpu.kernels().differentiable(&self.gpu);
        let frame = FrameBuffers {
            uniforms: &self.uniforms,
            splats: &self.splats,
            slots: &self.slots,
            image: &self.image,
        };
        let make = || BackwardBindings::new(&self.gpu, own, parameters, frame, by_image, gradients);
        let bindings = self.backward.get_or_insert_with(make);
        let timestamps = self.timer.as_ref().filter(|_| timed).map(Timer::queries);
        bindings.record(own, parameters.count, frame, encoder, timestamps);
        Ok(())
    }

    /// Makes buffers and bindings fit a frame.
    fn prepare(
        &mut self,
        parameters: &ParameterBuffers,
        camera: &Camera,
        settings: ForwardSettings,
    ) -> Result<(), GpuError> {
        let size = [camera.width, camera.height];
        if parameters.capacity > self.splats.capacity {
            self.unbind();
            self.splats = SplatBuffers::new(&self.gpu, &self.counts, parameters.capacity)?;
        }
        let capacity = self.slots.capacity();
        let prepared = self.image.prepare(&self.gpu, size, settings.depth, capacity)?;
        let sorted = self.slots.entries.sort(self.image.tile_count()).len() % 2;
        let fits = self.forward.as_ref().is_some_and(|bound| {
            bound.sorted == sorted && bound.parameters.shares_buffers_with(parameters)
        });
        if prepared == Prepared::Replaced || !fits {
            self.unbind();
        }
        Ok(())
    }

    fn unbind(&mut self) {
        self.forward = None;
        self.backward = None;
    }

    fn write_uniforms(
        &self,
        parameters: &ParameterBuffers,
        camera: &Camera,
        settings: ForwardSettings,
    ) {
        let degree = parameters.sh_degree.min(settings.max_sh_degree);
        let frame_settings = FrameSettings { max_sh_degree: degree, ..FrameSettings::default() };
        let frame = frame_uniform(camera, &frame_settings, 1.0);
        let splats = SplatCount {
            count: parameters.count,
            capacity: self.splats.capacity,
            stored_degree: parameters.sh_degree as u32,
            degree: degree as u32,
        };
        let queue = self.gpu.queue();
        queue.write_buffer(&self.uniforms.frame, 0, bytemuck::bytes_of(&frame));
        queue.write_buffer(&self.uniforms.splats, 0, bytemuck::bytes_of(&splats));
    }

    /// Whether the buffers belong to the last frame.
    fn check_backward(
        &self,
        parameters: &ParameterBuffers,
        by_image: ImageGradientBuffers<'_>,
        gradients: &ParameterBuffers,
    ) -> Result<(), GpuError> {
        let length = |field, expected: u64, found: u64| {
            let (expected, found) = (expected as usize, found as usize);
            GpuError::Scene(SceneError::Length { field, expected, found })
        };
        let last = self.last.ok_or(length("rendered frames", 1, 0))?;
        let same = self
            .forward
            .as_ref()
            .is_some_and(|bound| bound.parameters.shares_buffers_with(parameters));
        if !same || parameters.count != last.count {
            let (expected, found) = (u64::from(last.count), u64::from(parameters.count));
            return Err(length("splats of the rendered parameters", expected, found));
        }
        if gradients.sh_degree != last.sh_degree || gradients.capacity < last.count {
            let (expected, found) = (u64::from(last.count), u64::from(gradients.capacity));
            return Err(length("splats of the gradients, of the same degree", expected, found));
        }
        let pixels = u64::from(self.image.pixel_count());
        if by_image.color.size() < pixels * 16 {
            return Err(length("pixels of the color gradient", pixels, by_image.color.size() / 16));
        }
        if let Some(by_depth) = by_image.expected_depth {
            let found = if last.depth { by_depth.size() / 4 } else { 0 };
            if found < pixels {
                return Err(length("pixels of the depth gradient", pixels, found));
            }
        }
        Ok(())
    }
}
