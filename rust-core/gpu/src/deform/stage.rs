//! One frame's poses.

use std::f64::consts::TAU;

use glam::DVec3;
use trapeze_scene::deformation::{PositionHead, RotationRule};
use trapeze_scene::{DeformationNetwork, Scene};

use super::weights::PackedWeights;
use crate::kernel::whole;
use crate::kernels::NetworkShape;
use crate::layout::{self, Pose, argument, counter};
use crate::scene_buffers::SceneBuffers;
use crate::stage_pass::{Groups, dispatch};
use crate::{Gpu, GpuError};

/// Splats per workgroup where the device has 32 KiB of workgroup memory, and where it has less.
const SPLATS_LARGE: u32 = 32;
const SPLATS_SMALL: u32 = 16;

/// Poses the splats of a scene with a network.
#[derive(Debug)]
pub(crate) struct DeformStage {
    packed: PackedWeights,
    /// Splats per workgroup of the network.
    pub splats_per_group: u32,
    count: u32,
    has_motion: bool,
    /// The state of the last frame.
    pub poses: wgpu::Buffer,
    uniform: wgpu::Buffer,
    block: layout::Deformation,
    biases: wgpu::Buffer,
    counts: wgpu::Buffer,
    network: wgpu::ComputePipeline,
    network_group: wgpu::BindGroup,
    mask: wgpu::ComputePipeline,
    mask_group: Option<wgpu::BindGroup>,
    /// The moment that `poses` shows.
    shown: Option<Moment>,
}

/// A time, and the threshold below which splats rest.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moment {
    time: f32,
    threshold: Option<f32>,
}

/// What a frame has to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DeformWork {
    /// The poses are those of the last frame.
    Nothing,
    /// All splats move.
    All,
    /// Splats above the threshold move; the list of them is there already.
    Listed,
    /// Splats above the threshold move; the list has to be made, and the others put to rest.
    Masked,
}

impl DeformStage {
    pub(crate) fn new(
        gpu: &Gpu,
        scene: &Scene,
        network: &DeformationNetwork,
        buffers: &SceneBuffers,
        counts: &wgpu::Buffer,
    ) -> Result<Self, GpuError> {
        let packed = PackedWeights::new(network)?;
        let shape = network_shape(gpu, &packed);
        let bytes = u64::from(buffers.count) * size_of::<Pose>() as u64;
        if bytes > gpu.max_binding() {
            return Err(GpuError::OutOfMemory {
                what: "moving splats in one binding",
                need: bytes,
                have: gpu.max_binding(),
            });
        }
        let poses = gpu.storage("poses", bytes)?;
        let dynamic = gpu.storage("dynamic splats", u64::from(buffers.count) * 4)?;
        let weights = gpu.storage_of("weights", &packed.weights)?;
        let biases = gpu.storage_of("biases", &packed.biases)?;
        let block = uniform_block(scene, network, &packed);
        let uniform = gpu.uniform_of("deformation", bytemuck::bytes_of(&block));
        let kernels = gpu.kernels();
        let network_group = kernels.deform_interface.bind(
            gpu,
            &[
                whole(&uniform),
                whole(&buffers.canonical_poses),
                whole(&poses),
                whole(&dynamic),
                whole(counts),
                whole(&weights),
                whole(&biases),
            ],
        );
        let mut stage = Self {
            splats_per_group: shape.splats,
            count: buffers.count,
            has_motion: buffers.has_motion,
            network: kernels.deform(gpu, shape),
            mask: kernels.mask.clone(),
            mask_group: None,
            packed,
            poses,
            uniform,
            block,
            biases,
            counts: counts.clone(),
            network_group,
            shown: None,
        };
        if stage.has_motion {
            let initial = stage.initial_poses(gpu, bytes)?;
            stage.mask_group = Some(kernels.mask_interface.bind(
                gpu,
                &[
                    whole(&stage.uniform),
                    whole(&buffers.motion),
                    whole(&initial),
                    whole(&stage.poses),
                    whole(&dynamic),
                    whole(counts),
                ],
            ));
        }
        Ok(stage)
    }

    /// Evaluates all splats at t = 0 and keeps a copy.
    fn initial_poses(&mut self, gpu: &Gpu, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
        let initial = gpu.storage("poses at t = 0", bytes)?;
        let work = self.prepare(gpu, 0.0, None);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            self.record_network(work, &mut pass, Groups::Direct(0));
        }
        if self.count > 0 {
            encoder.copy_buffer_to_buffer(&self.poses, 0, &initial, 0, bytes);
        }
        gpu.queue().submit([encoder.finish()]);
        Ok(initial)
    }

    /// Decides what a frame has to do, and writes its uniforms. Time NaN or infinite is 0.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, time: f32, threshold: Option<f32>) -> DeformWork {
        let time = if time.is_finite() { time } else { 0.0 };
        let threshold = threshold.filter(|_| self.has_motion);
        let wanted = Moment { time, threshold };
        let before = self.shown.replace(wanted);
        // NaN thresholds compare unequal to themselves, and are then evaluated anew each time.
        if before == Some(wanted) {
            return DeformWork::Nothing;
        }
        self.block.masked = u32::from(threshold.is_some());
        self.block.threshold = threshold.unwrap_or(0.0);
        gpu.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(&self.block));
        let width = self.packed.width as u64 * 4;
        let [first, skip] = self.packed.time_biases(f64::from(time));
        let at = [0, self.packed.skip_layer as u64 * width];
        for (offset, biases) in at.into_iter().zip([first, skip]) {
            gpu.queue().write_buffer(&self.biases, offset, bytemuck::cast_slice(&biases));
        }
        match threshold {
            None => DeformWork::All,
            Some(_) if before.is_some_and(|b| b.threshold == threshold) => DeformWork::Listed,
            Some(_) => DeformWork::Masked,
        }
    }

    /// Forgets what the poses show, after a frame that was not submitted.
    pub(crate) fn invalidate(&mut self) {
        self.shown = None;
    }

    /// Records making the list of moving splats.
    pub(crate) fn clear_list(&self, work: DeformWork, encoder: &mut wgpu::CommandEncoder) {
        if work == DeformWork::Masked {
            encoder.clear_buffer(&self.counts, 4 * counter::DYNAMIC as u64, Some(4));
        }
    }

    /// Records making the list of moving splats, and putting the others to rest.
    pub(crate) fn record_mask(&self, work: DeformWork, pass: &mut wgpu::ComputePass<'_>) {
        let Some(group) = self.mask_group.as_ref().filter(|_| work == DeformWork::Masked) else {
            return;
        };
        pass.set_pipeline(&self.mask);
        pass.set_bind_group(0, group, &[]);
        dispatch(pass, Groups::Direct(self.count.div_ceil(256)));
    }

    /// Records the network; `listed` is the size of the dispatch for listed splats.
    pub(crate) fn record_network(
        &self,
        work: DeformWork,
        pass: &mut wgpu::ComputePass<'_>,
        listed: Groups<'_>,
    ) {
        let groups = match work {
            DeformWork::Nothing => return,
            DeformWork::All => Groups::Direct(self.count.div_ceil(self.splats_per_group)),
            DeformWork::Listed | DeformWork::Masked => listed,
        };
        if self.count == 0 {
            return;
        }
        pass.set_pipeline(&self.network);
        pass.set_bind_group(0, &self.network_group, &[]);
        dispatch(pass, groups);
    }
}

/// Byte offset of the network's dispatch in the argument buffer.
pub(crate) const NETWORK_ARGUMENTS: u64 = argument::NETWORK * argument::STRIDE;

/// The largest group of splats whose hidden vectors fit into workgroup memory.
fn network_shape(gpu: &Gpu, packed: &PackedWeights) -> NetworkShape {
    let shape = |splats| NetworkShape {
        width: packed.width as u32,
        input_rows: packed.input_rows as u32,
        splats,
    };
    let fits =
        shape(SPLATS_LARGE).workgroup_bytes() <= gpu.limits().max_compute_workgroup_storage_size;
    shape(if fits { SPLATS_LARGE } else { SPLATS_SMALL })
}

fn uniform_block(
    scene: &Scene,
    network: &DeformationNetwork,
    packed: &PackedWeights,
) -> layout::Deformation {
    let flag = |condition: bool| u32::from(condition);
    layout::Deformation {
        origin: narrow(scene.origin),
        origin_turns: std::array::from_fn(|octave| {
            // Reduced in double precision: what is left is less than half a turn.
            let turns = scene.origin / TAU * (1u64 << octave) as f64;
            narrow(turns - turns.round())
        }),
        splats: scene.len() as u32,
        octaves: network.position_encoding.octaves as u32,
        depth: packed.depth as u32,
        skip_layer: packed.skip_layer as u32,
        input_rows: packed.input_rows as u32,
        screw: flag(matches!(network.position_head, PositionHead::Screw { .. })),
        as_trained: flag(network.rotation_rule == RotationRule::AsTrained),
        ..layout::Deformation::default()
    }
}

fn narrow(v: DVec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}
