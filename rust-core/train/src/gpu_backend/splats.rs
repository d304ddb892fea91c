//! The trained splats on the GPU: parameters, moments and gradients, which never leave it but for
//! checkpoints.

use trapeze_gpu::compute::{Groups, dispatch, whole};
use trapeze_gpu::{Gpu, GpuError, ParameterBuffers};
use trapeze_scene::ShDegree;

use super::kernels::TrainingKernels;
use super::layout::{Strides, widths};
use crate::TrainingState;

/// Parameters, moments and gradients of the same splats.
pub(super) struct ResidentSplats {
    pub(super) parameters: ParameterBuffers,
    pub(super) first_moments: ParameterBuffers,
    pub(super) second_moments: ParameterBuffers,
    pub(super) gradients: ParameterBuffers,
}

impl ResidentSplats {
    /// Bytes for `capacity` splats.
    pub(super) fn bytes(capacity: u32, degree: ShDegree) -> u64 {
        4 * ParameterBuffers::bytes(capacity, degree)
    }

    pub(super) fn upload(
        gpu: &Gpu,
        state: &TrainingState,
        capacity: u32,
    ) -> Result<Self, GpuError> {
        let upload = |splats| ParameterBuffers::from_splats(gpu, splats, capacity);
        let parameters = upload(&state.splats)?;
        let degree = state.splats.sh_degree;
        let mut gradients = ParameterBuffers::zeroed(gpu, parameters.capacity, degree)?;
        gradients.count = parameters.count;
        Ok(Self {
            first_moments: upload(&state.first_moments)?,
            second_moments: upload(&state.second_moments)?,
            parameters,
            gradients,
        })
    }

    /// Replaces what is there, if it fits into the buffers that there are.
    pub(super) fn write(&mut self, gpu: &Gpu, state: &TrainingState) -> Result<bool, GpuError> {
        let fits = state.splats.sh_degree == self.parameters.sh_degree
            && state.splats.len() as u64 <= u64::from(self.parameters.capacity);
        if fits {
            self.parameters.write(gpu, &state.splats)?;
            self.first_moments.write(gpu, &state.first_moments)?;
            self.second_moments.write(gpu, &state.second_moments)?;
            self.set_count(state.splats.len() as u32);
        }
        Ok(fits)
    }

    /// Waits for the splats of the state after `step` steps.
    pub(super) fn read(&self, gpu: &Gpu, step: u32) -> Result<TrainingState, GpuError> {
        Ok(TrainingState {
            step,
            splats: self.parameters.read(gpu)?,
            first_moments: self.first_moments.read(gpu)?,
            second_moments: self.second_moments.read(gpu)?,
            network: None,
            resting: None,
        })
    }

    pub(super) fn count(&self) -> u32 {
        self.parameters.count
    }

    pub(super) fn set_count(&mut self, count: u32) {
        for part in self.parts_mut() {
            part.count = count;
        }
    }

    pub(super) fn degree(&self) -> ShDegree {
        self.parameters.sh_degree
    }

    fn parts_mut(&mut self) -> [&mut ParameterBuffers; 4] {
        [
            &mut self.parameters,
            &mut self.first_moments,
            &mut self.second_moments,
            &mut self.gradients,
        ]
    }

    /// Adds SH bands up to `degree`, zero and at rest: three times in a run at most, so new buffers
    /// may be made. Records the moves of the bands that are there.
    pub(super) fn raise_degree(
        &mut self,
        gpu: &Gpu,
        kernels: &TrainingKernels,
        degree: ShDegree,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), GpuError> {
        let (before, after) = (widths(self.degree())[5], widths(degree)[5]);
        let capacity = self.parameters.capacity;
        let strides =
            Strides { before, after, total: self.count().saturating_mul(after), padding: 0 };
        let uniform = gpu.uniform_of("strides", bytemuck::bytes_of(&strides));
        let (need, have) = (u64::from(capacity) * u64::from(after) * 4, gpu.max_binding());
        if need > have {
            return Err(GpuError::OutOfMemory { what: "sh_rest", need, have });
        }
        for part in self.parts_mut() {
            let spread = gpu.storage("sh_rest", need)?;
            let buffers = [whole(&uniform), whole(&part.sh_rest), whole(&spread)];
            let bind_group = kernels.restride_interface.bind(gpu, &buffers);
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&kernels.restride);
            pass.set_bind_group(0, &bind_group, &[]);
            dispatch(&mut pass, Groups::Direct(strides.total.div_ceil(256)));
            drop(pass);
            part.sh_rest = spread;
            part.sh_degree = degree;
        }
        Ok(())
    }
}
