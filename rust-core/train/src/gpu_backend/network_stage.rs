//! The deformation network under training on the device: its parameters, moments and gradients stay
//! there, as those of the splats do.

use trapeze_gpu::compute::{Groups, dispatch, whole};
use trapeze_gpu::{
    DeformationTimes, DifferentiableDeformation, Gpu, GpuError, NetworkProducts, ParameterBuffers,
};
use trapeze_scene::DeformationNetwork;
use trapeze_scene::deformation::RestingSplats;

use super::kernels::TrainingKernels;
use super::layout::TrainingStep;
use super::look;
use crate::TrainedNetwork;
use crate::network::{network_parameters, set_network_parameters};
use crate::schedule::NetworkStep;

/// What the stage is made for, beside the network.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    /// Splats that there is room for.
    pub(super) capacity: u32,
    /// Bytes of the activations of a chunk of splats.
    pub(super) activation_budget: u64,
    /// How products are computed.
    pub(super) products: NetworkProducts,
    /// Counts of the frame, and the ring of reports.
    pub(super) counts: &'a wgpu::Buffer,
    pub(super) reports: &'a wgpu::Buffer,
}

/// A network, its moments and its update.
pub(super) struct NetworkStage {
    /// For all but its parameters.
    network: DeformationNetwork,
    deformation: DifferentiableDeformation,
    /// Which splats rest.
    resting: Option<RestingSplats>,
    first_moments: wgpu::Buffer,
    second_moments: wgpu::Buffer,
    /// The uniform block of its update.
    uniform: wgpu::Buffer,
    update: wgpu::BindGroup,
}

impl NetworkStage {
    /// Bytes that a network takes, whose activations fit into one binding of the device.
    pub(super) fn bytes(
        network: &DeformationNetwork,
        capacity: u32,
        activation_budget: u64,
    ) -> Result<u64, GpuError> {
        let moments = 2 * 4 * network.parameter_count() as u64;
        let moments = moments + look::bytes(capacity);
        Ok(moments + DifferentiableDeformation::bytes(network, capacity, activation_budget)?)
    }

    pub(super) fn upload(
        gpu: &Gpu,
        kernels: &TrainingKernels,
        trained: &TrainedNetwork,
        place: Place<'_>,
    ) -> Result<Self, GpuError> {
        let network = trained.network.clone();
        let parameters = network_parameters(&network);
        let Place { capacity, activation_budget, products, .. } = place;
        let deformation = DifferentiableDeformation::with_products(
            gpu,
            &network,
            &parameters,
            capacity,
            activation_budget,
            products,
        )?;
        let moments = |label, values: &[f32]| gpu.storage_of(label, &deformation.pack(values));
        let first_moments = moments("first moments of the network", &trained.first_moments)?;
        let second_moments = moments("second moments of the network", &trained.second_moments)?;
        let uniform = gpu.uniform_of("network step", &[0; size_of::<TrainingStep>()]);
        let update = kernels.adam_interface.bind(
            gpu,
            &[
                whole(&uniform),
                whole(deformation.parameters()),
                whole(deformation.gradients()),
                whole(&first_moments),
                whole(&second_moments),
                whole(place.reports),
                whole(place.counts),
            ],
        );
        let resting = None;
        Ok(Self { network, deformation, resting, first_moments, second_moments, uniform, update })
    }

    /// Replaces what is there, if it fits into the buffers that there are.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        trained: &TrainedNetwork,
        capacity: u32,
    ) -> Result<bool, GpuError> {
        if !self.deformation.fits(&trained.network, capacity) {
            return Ok(false);
        }
        self.network = trained.network.clone();
        self.deformation.write(&network_parameters(&trained.network))?;
        gpu.write(&self.first_moments, &self.deformation.pack(&trained.first_moments))?;
        gpu.write(&self.second_moments, &self.deformation.pack(&trained.second_moments))?;
        Ok(true)
    }

    /// Which splats rest from the next submission on.
    pub(super) fn rest(&mut self, resting: Option<RestingSplats>) -> Result<(), GpuError> {
        self.deformation.set_resting(resting.as_ref())?;
        self.resting = resting;
        Ok(())
    }

    pub(super) fn resting(&self) -> Option<&RestingSplats> {
        self.resting.as_ref()
    }

    /// Waits for the network as it is.
    pub(super) fn read(&self) -> Result<TrainedNetwork, GpuError> {
        let mut network = self.network.clone();
        set_network_parameters(&mut network, &self.deformation.read()?);
        Ok(TrainedNetwork {
            network,
            first_moments: self.deformation.read_packed(&self.first_moments)?,
            second_moments: self.deformation.read_packed(&self.second_moments)?,
        })
    }

    /// The network's form; its parameters are those of the start.
    pub(super) fn form(&self) -> &DeformationNetwork {
        &self.network
    }

    /// Writes the uniform block of a step, before the next submission; the report goes to `slot`.
    pub(super) fn write_step(&self, gpu: &Gpu, step: &NetworkStep, slot: u32) {
        let numbers = TrainingStep::of_network(step, self.deformation.parameter_count(), slot);
        gpu.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(&numbers));
    }

    /// Records deforming the splats to a time, and returns them.
    pub(super) fn record_forward(
        &mut self,
        pass: &mut wgpu::ComputePass<'_>,
        canonical: &ParameterBuffers,
        time: f32,
    ) -> Result<ParameterBuffers, GpuError> {
        self.deformation.forward(pass, canonical, time)?;
        Ok(self.deformation.deformed(canonical))
    }

    /// Records turning gradients by the deformed splats into those by the canonical ones and by the
    /// network's parameters.
    pub(super) fn record_backward(
        &mut self,
        pass: &mut wgpu::ComputePass<'_>,
        canonical: &ParameterBuffers,
        gradients: &ParameterBuffers,
    ) -> Result<(), GpuError> {
        self.deformation.backward(pass, canonical, gradients)
    }

    /// Deforms the splats to a time, waits, and returns what each kernel took and the splats.
    pub(super) fn timed_forward(
        &mut self,
        canonical: &ParameterBuffers,
        time: f32,
    ) -> Result<(Option<DeformationTimes>, ParameterBuffers), GpuError> {
        let times = self.deformation.timed_forward(canonical, time)?;
        Ok((times, self.deformation.deformed(canonical)))
    }

    /// [`record_backward`](Self::record_backward), waited for, and what each kernel took.
    pub(super) fn timed_backward(
        &mut self,
        canonical: &ParameterBuffers,
        gradients: &ParameterBuffers,
    ) -> Result<Option<DeformationTimes>, GpuError> {
        self.deformation.timed_backward(canonical, gradients)
    }

    /// Records the update of the network's parameters.
    pub(super) fn record_update(
        &self,
        kernels: &TrainingKernels,
        pass: &mut wgpu::ComputePass<'_>,
    ) {
        pass.set_pipeline(&kernels.network_adam);
        pass.set_bind_group(0, &self.update, &[]);
        dispatch(pass, Groups::Direct(self.deformation.parameter_count().div_ceil(256)));
    }
}
