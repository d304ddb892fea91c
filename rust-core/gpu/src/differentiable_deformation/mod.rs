//! The deformation network under training, on the GPU: forward and backward, layer by layer, as
//! products of matrices.
//!
//! [`DifferentiableDeformation`] stands in front of a
//! [`DifferentiableRenderer`](crate::DifferentiableRenderer): from stored parameters it makes those of
//! the deformed splats, which the renderer draws as it draws any others; and it carries the gradients
//! that the renderer found for them back to the stored parameters and to the weights.
//!
//! Inference ([`Renderer`](crate::Renderer)) keeps the hidden vectors of 16 splats in workgroup
//! memory from the first layer to the last. Training needs them again on the way back, and sums over
//! all splats for the weights: so here every layer is a dispatch, and the hidden vectors are in
//! memory, feature by feature, for a chunk of splats. What fits a byte budget is a chunk; with more
//! than one, the backward pass evaluates the network again, chunk by chunk.
//!
//! The network's inputs are taken as constants: no gradient goes through γ (Deformable 3D Gaussians
//! stops it there). Sums over splats are made in parts, added up in a fixed order: the same step has
//! the same bits.
//!
//! # Floor
//!
//! The standard network has 504 320 weights. A splat costs 1.01 MFLOP forward, as much again for the
//! weights' gradients, and 0.92 for those of the layers' inputs: 2.94 in all, 118 GFLOP for 40 000
//! splats. In single precision on an H100 (67 TFLOP/s) that is 1.8 ms; the fused kernel of inference
//! reaches 32 TFLOP/s there, which would be 3.7 ms. Memory is not the limit: a hidden layer moves 7 KiB
//! a splat (2 forward, 2 for the weights, 3 for its input), 40 000 splats × 8 layers 2.3 GB, 0.7 ms at
//! 3.3 TB/s if nothing stays in caches. 37 dispatches behind each other cost about 0.1 ms. Prediction: 4
//! to 5 ms.
//!
//! Products on cooperative matrices ([`NetworkProducts::Split`]) have three times the products at sixteen
//! times the speed: 0.35 ms for 118 GFLOP. Predicted was a third of the network's time; what came is nine
//! tenths (docs/negative-results.md): splitting and laying out the factors takes longer than multiplying.

mod bindings;
mod buffers;
mod chunk;
mod dispatches;
mod kernels;
mod network_layout;
mod products;
mod resting;
#[cfg(test)]
mod tests;
mod times;

pub(crate) use kernels::DeformationKernels;
pub use products::NetworkProducts;
pub use times::DeformationTimes;

use std::time::Duration;

use trapeze_scene::{DeformationNetwork, SceneError};

use crate::layout::NetworkChunk;
use crate::stage_pass::begin_pass;
use crate::timing::Timer;
use crate::{Gpu, GpuError, ParameterBuffers, readback};
use bindings::{BackwardBindings, ForwardBindings, LayerBindings};
use buffers::{HELD_BYTES, NetworkBuffers};
use chunk::{Chunk, columns_within};
use dispatches::{Dispatch, Layers};
use kernels::STAGES;
use network_layout::NetworkLayout;

/// Bytes between two uniform blocks: the largest alignment that a device may ask for.
const BLOCK_STRIDE: u32 = 256;

/// A deformation network on the device, with the gradients of its parameters.
///
/// The uniform blocks of an evaluation are written when it is recorded: one submission holds one
/// [`forward`](Self::forward), and at most one [`backward`](Self::backward) after it. In the steady
/// state recording creates nothing.
#[derive(Debug)]
pub struct DifferentiableDeformation {
    gpu: Gpu,
    products: NetworkProducts,
    layout: NetworkLayout,
    /// Splats that there is room for.
    capacity: u32,
    /// Columns of the activations: the most splats of a chunk.
    columns: u32,
    buffers: NetworkBuffers,
    layers: Vec<LayerBindings>,
    forward: Option<ForwardBindings>,
    backward: Option<BackwardBindings>,
    /// Splats that move, where others rest.
    moving: Option<u32>,
    /// Splats of the evaluation that was recorded last.
    evaluated: Option<u32>,
}

impl DifferentiableDeformation {
    /// Room for `capacity` splats, with activations of at most `activation_budget` bytes (those of
    /// 128 splats at least), and single products. The parameters are those of `network`, the gradients
    /// zero.
    ///
    /// # Errors
    /// [`GpuError::Untrainable`] names what the kernels do not train (time networks, screw motions,
    /// rotations that stay unnormalised, widths that are no multiple of four);
    /// [`GpuError::OutOfMemory`] when the device has no room.
    pub fn new(
        gpu: &Gpu,
        network: &DeformationNetwork,
        parameters: &[f32],
        capacity: u32,
        activation_budget: u64,
    ) -> Result<Self, GpuError> {
        let products = NetworkProducts::Single;
        Self::with_products(gpu, network, parameters, capacity, activation_budget, products)
    }

    /// The same with products of this kind; single ones where the device has no other.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn with_products(
        gpu: &Gpu,
        network: &DeformationNetwork,
        parameters: &[f32],
        capacity: u32,
        activation_budget: u64,
        products: NetworkProducts,
    ) -> Result<Self, GpuError> {
        let products = if gpu.has_matrices() { products } else { NetworkProducts::Single };
        let mut layout = NetworkLayout::new(network)?;
        let columns = columns_within(&layout, capacity, activation_budget.min(gpu.max_binding()));
        layout.layers.iter_mut().for_each(|layer| layer.row_vectors = columns / 4);
        let buffers = NetworkBuffers::new(gpu, &layout, capacity, columns)?;
        let kernels = gpu.kernels().deformation(gpu, products);
        let bind = |i| LayerBindings::new(gpu, kernels, &buffers, i as u32);
        let layers = (0..layout.layers.len()).map(bind).collect();
        let this = Self {
            gpu: gpu.clone(),
            products,
            capacity,
            columns,
            layers,
            forward: None,
            backward: None,
            moving: None,
            evaluated: None,
            buffers,
            layout,
        };
        this.write(parameters)?;
        Ok(this)
    }

    /// Bytes that it takes on a device whose bindings are large enough.
    ///
    /// # Errors
    /// [`GpuError::Untrainable`] as for [`new`](Self::new).
    pub fn bytes(
        network: &DeformationNetwork,
        capacity: u32,
        activation_budget: u64,
    ) -> Result<u64, GpuError> {
        let layout = NetworkLayout::new(network)?;
        let columns = u64::from(columns_within(&layout, capacity, activation_budget));
        let deformed = u64::from(capacity) * (DEFORMED_BYTES + HELD_BYTES + 4);
        let parameters = 2 * 4 * layout.parameters as u64;
        Ok(columns * layout.column_bytes() + layout.parts_bytes() + deformed + parameters)
    }

    /// Whether it can take the parameters of this network, for so many splats.
    #[must_use]
    pub fn fits(&self, network: &DeformationNetwork, capacity: u32) -> bool {
        let mut layout = self.layout.clone();
        layout.layers.iter_mut().for_each(|layer| layer.row_vectors = 0);
        capacity <= self.capacity && layout.fits(network)
    }

    /// How its products are computed.
    #[must_use]
    pub fn products(&self) -> NetworkProducts {
        self.products
    }

    /// The weights and biases: [`parameter_count`](Self::parameter_count) floats, in an order of its
    /// own (see [`pack`](Self::pack)).
    #[must_use]
    pub fn parameters(&self) -> &wgpu::Buffer {
        &self.buffers.parameters
    }

    /// ∂L/∂ each of the [`parameters`](Self::parameters), after [`backward`](Self::backward).
    #[must_use]
    pub fn gradients(&self) -> &wgpu::Buffer {
        &self.buffers.gradients
    }

    /// Floats of the parameters on the device; a few of them are padding, and stay zero.
    #[must_use]
    pub fn parameter_count(&self) -> u32 {
        self.layout.parameters as u32
    }

    /// Brings one number per parameter, in the order of `weights.bin`, into the order on the device.
    #[must_use]
    pub fn pack(&self, parameters: &[f32]) -> Vec<f32> {
        self.layout.pack(parameters)
    }

    /// The inverse of [`pack`](Self::pack).
    #[must_use]
    pub fn unpack(&self, packed: &[f32]) -> Vec<f32> {
        self.layout.unpack(packed)
    }

    /// Replaces the parameters, given in the order of `weights.bin`.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn write(&self, parameters: &[f32]) -> Result<(), GpuError> {
        self.gpu.write(&self.buffers.parameters, &self.pack(parameters))
    }

    /// The parameters in the order of `weights.bin`, and waits for them.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read(&self) -> Result<Vec<f32>, GpuError> {
        self.read_packed(&self.buffers.parameters)
    }

    /// Any buffer with one float per parameter, in the order of `weights.bin`, and waits for it.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_packed(&self, buffer: &wgpu::Buffer) -> Result<Vec<f32>, GpuError> {
        let packed = readback::read(&self.gpu, buffer, u64::from(self.parameter_count()))?;
        Ok(self.unpack(&packed))
    }

    /// The deformed splats, after [`forward`](Self::forward): centres, log-scales and rotations of
    /// its own, opacities and colours shared with the canonical ones.
    #[must_use]
    pub fn deformed(&self, canonical: &ParameterBuffers) -> ParameterBuffers {
        ParameterBuffers {
            positions: self.buffers.deformed_positions.clone(),
            log_scales: self.buffers.deformed_log_scales.clone(),
            rotations: self.buffers.deformed_rotations.clone(),
            ..canonical.clone()
        }
    }

    /// Records deforming the splats to a time. Time NaN or infinite is 0.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] when there are more splats than it has room for.
    pub fn forward(
        &mut self,
        pass: &mut wgpu::ComputePass<'_>,
        canonical: &ParameterBuffers,
        time: f32,
    ) -> Result<(), GpuError> {
        let gpu = self.gpu.clone();
        let kernels = gpu.kernels().deformation(&gpu, self.products);
        let list = self.forward_dispatches(canonical, time)?;
        list.iter().for_each(|dispatch| dispatch.record(kernels, pass));
        Ok(())
    }

    /// Records the vector–Jacobian product of the last [`forward`](Self::forward): turns `gradients`,
    /// which are by the deformed parameters, into those by the canonical ones, in place, and writes
    /// those by the network's parameters.
    ///
    /// # Errors
    /// [`GpuError::Scene`] when the splats are not those of the last forward pass.
    pub fn backward(
        &mut self,
        pass: &mut wgpu::ComputePass<'_>,
        canonical: &ParameterBuffers,
        gradients: &ParameterBuffers,
    ) -> Result<(), GpuError> {
        let gpu = self.gpu.clone();
        let kernels = gpu.kernels().deformation(&gpu, self.products);
        let list = self.backward_dispatches(canonical, gradients)?;
        list.iter().for_each(|dispatch| dispatch.record(kernels, pass));
        Ok(())
    }

    /// Runs [`forward`](Self::forward), waits, and returns what each kernel took; `None` where the
    /// device cannot tell.
    ///
    /// # Errors
    /// Those of [`forward`](Self::forward), and [`GpuError::Device`] when the device is lost.
    pub fn timed_forward(
        &mut self,
        canonical: &ParameterBuffers,
        time: f32,
    ) -> Result<Option<DeformationTimes>, GpuError> {
        let gpu = self.gpu.clone();
        let kernels = gpu.kernels().deformation(&gpu, self.products);
        timed(&gpu, kernels, &self.forward_dispatches(canonical, time)?)
    }

    /// Runs [`backward`](Self::backward), waits, and returns what each kernel took; `None` where the
    /// device cannot tell.
    ///
    /// # Errors
    /// Those of [`backward`](Self::backward), and [`GpuError::Device`] when the device is lost.
    pub fn timed_backward(
        &mut self,
        canonical: &ParameterBuffers,
        gradients: &ParameterBuffers,
    ) -> Result<Option<DeformationTimes>, GpuError> {
        let gpu = self.gpu.clone();
        let kernels = gpu.kernels().deformation(&gpu, self.products);
        timed(&gpu, kernels, &self.backward_dispatches(canonical, gradients)?)
    }

    /// Makes bindings fit, and writes the uniform blocks.
    fn forward_dispatches(
        &mut self,
        canonical: &ParameterBuffers,
        time: f32,
    ) -> Result<Vec<Dispatch<'_>>, GpuError> {
        self.evaluated = None;
        self.check_room(canonical.capacity)?;
        let (chunks, resting) = self.chunks(canonical.count);
        self.write_chunks(&chunks, resting, time);
        self.evaluated = Some(canonical.count);
        let bound = self.forward.take().filter(|bound| bound.are_of(canonical));
        let kernels = self.gpu.kernels().deformation(&self.gpu, self.products);
        let make = || ForwardBindings::new(&self.gpu, kernels, &self.buffers, canonical);
        let bound = self.forward.insert(bound.unwrap_or_else(make));
        let layers = Layers { layers: &self.layout.layers, bindings: &self.layers };
        Ok(dispatches::forward(layers, bound, &chunks, resting))
    }

    fn backward_dispatches(
        &mut self,
        canonical: &ParameterBuffers,
        gradients: &ParameterBuffers,
    ) -> Result<Vec<Dispatch<'_>>, GpuError> {
        let evaluated = self.evaluated.take();
        let forward = self.forward.as_ref().filter(|bound| bound.are_of(canonical));
        let (Some(forward), true) = (forward, evaluated == Some(canonical.count)) else {
            return Err(GpuError::Scene(SceneError::Length {
                field: "splats that were deformed",
                expected: evaluated.unwrap_or(0) as usize,
                found: canonical.count as usize,
            }));
        };
        let (chunks, resting) = self.chunks(canonical.count);
        let bound = self.backward.take().filter(|bound| bound.are_of(canonical, gradients));
        let kernels = self.gpu.kernels().deformation(&self.gpu, self.products);
        let make =
            || BackwardBindings::new(&self.gpu, kernels, &self.buffers, canonical, gradients);
        let bound = self.backward.insert(bound.unwrap_or_else(make));
        let layers = Layers { layers: &self.layout.layers, bindings: &self.layers };
        Ok(dispatches::backward(layers, forward, bound, &chunks, resting))
    }

    /// Writes the uniform blocks of an evaluation.
    fn write_chunks(&self, chunks: &[Chunk], resting: Chunk, time: f32) {
        let base = self.layout.chunk_at(time);
        let mut blocks = vec![0; (chunks.len() + 1) * BLOCK_STRIDE as usize];
        let slots = blocks.chunks_exact_mut(BLOCK_STRIDE as usize);
        for (slot, chunk) in slots.zip(chunks.iter().chain([&resting])) {
            let block = NetworkChunk {
                first: chunk.first,
                splats: chunk.splats,
                steps: chunk.steps(),
                // The last chunk is the first on the way back.
                starts_sum: u32::from(chunk.index as usize + 1 == chunks.len()),
                row_vectors: self.columns / 4,
                ..base
            };
            slot[..size_of::<NetworkChunk>()].copy_from_slice(bytemuck::bytes_of(&block));
        }
        self.gpu.queue().write_buffer(&self.buffers.chunks, 0, &blocks);
    }
}

/// Bytes of the deformed parameters of one splat.
const DEFORMED_BYTES: u64 = 40;

/// Runs dispatches, each in a pass of its own, waits for them, and adds up the times of each stage.
fn timed(
    gpu: &Gpu,
    kernels: &DeformationKernels,
    list: &[Dispatch<'_>],
) -> Result<Option<DeformationTimes>, GpuError> {
    if 2 * list.len() > wgpu::QUERY_SET_MAX_QUERIES as usize {
        return Ok(None);
    }
    let Some(timer) = Timer::of_stages(gpu, list.len() as u32)? else { return Ok(None) };
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    for (i, dispatch) in (0..).zip(list) {
        let mut pass = begin_pass(&mut encoder, "deform", i, Some(timer.queries()));
        dispatch.record(kernels, &mut pass);
    }
    timer.resolve(&mut encoder);
    gpu.queue().submit([encoder.finish()]);
    gpu.wait()?;
    let Some(times) = timer.read_stages(gpu)? else { return Ok(None) };
    let mut sums = [Duration::ZERO; STAGES];
    for (dispatch, time) in list.iter().zip(times) {
        sums[dispatch.stage as usize] += time;
    }
    Ok(Some(DeformationTimes::of_stages(sums)))
}
