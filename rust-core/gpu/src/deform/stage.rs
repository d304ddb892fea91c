//! One frame's poses.

use std::f64::consts::TAU;

use glam::DVec3;
use trapeze_scene::deformation::{PositionHead, RotationRule};
use trapeze_scene::{DeformationNetwork, Scene};

use super::half;
use super::weights::PackedWeights;
use crate::kernel::{Interface, whole};
use crate::kernels::NetworkShape;
use crate::layout::{self, Pose, counter};
use crate::scene_buffers::SceneBuffers;
use crate::stage_pass::{Groups, dispatch};
use crate::{Gpu, GpuError, readback};

/// Splats per workgroup: their hidden vectors are 16 KiB at width 256, which every device has. With
/// twice as many, fewer workgroups share a core, and an H100 is 10 % slower.
const SPLATS_PER_GROUP: u32 = 16;

/// Arithmetic of the deformation network. Positions are encoded in 32 bits in either.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NetworkPrecision {
    /// 32-bit weights and hidden vectors.
    #[default]
    Single,
    /// 16-bit weights and hidden vectors, summed in 32 bits: on cooperative matrices where the device
    /// has them, else with its 16-bit floats. Each kernel is used only once it has been found to
    /// agree with the 32-bit one on the device and the network at hand; without any, as `Single`.
    Half,
}

/// A kernel of the network.
#[derive(Debug)]
struct NetworkKernel {
    name: &'static str,
    pipeline: wgpu::ComputePipeline,
    bind_group: wgpu::BindGroup,
    /// Splats per workgroup.
    splats: u32,
}

/// Poses the splats of a scene with a network.
#[derive(Debug)]
pub(crate) struct DeformStage {
    packed: PackedWeights,
    count: u32,
    has_motion: bool,
    /// The state of the last frame.
    pub poses: wgpu::Buffer,
    uniform: wgpu::Buffer,
    block: layout::Deformation,
    biases: wgpu::Buffer,
    counts: wgpu::Buffer,
    plain: NetworkKernel,
    /// The half-precision kernel that agrees with the plain one, if any was asked for.
    half: Option<NetworkKernel>,
    /// Which of the two is in use.
    precision: NetworkPrecision,
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
        precision: NetworkPrecision,
    ) -> Result<Self, GpuError> {
        let packed = PackedWeights::new(network)?;
        let shape = NetworkShape {
            width: packed.width as u32,
            input_rows: packed.input_rows as u32,
            splats: SPLATS_PER_GROUP,
            precision: NetworkPrecision::Single,
        };
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
        let biases = gpu.storage_of("biases", &packed.biases)?;
        let block = uniform_block(scene, network, &packed);
        let uniform = gpu.uniform_of("deformation", bytemuck::bytes_of(&block));
        let kernels = gpu.kernels();
        let bind = |interface: &Interface, weights: &wgpu::Buffer| {
            interface.bind(
                gpu,
                &[
                    whole(&uniform),
                    whole(&buffers.canonical_poses),
                    whole(&poses),
                    whole(&dynamic),
                    whole(counts),
                    whole(weights),
                    whole(&biases),
                ],
            )
        };
        let plain = NetworkKernel {
            name: "f32",
            pipeline: kernels.deform(gpu, shape),
            bind_group: bind(
                kernels.deform_interface(gpu, NetworkPrecision::Single),
                &gpu.storage_of("weights", &packed.weights)?,
            ),
            splats: shape.splats,
        };
        let half_weights = match precision {
            NetworkPrecision::Half if half::has_halves(gpu) => half::half_weights(&packed),
            _ => None,
        };
        let mut faster = Vec::new();
        if let Some(weights) = half_weights {
            let weights = gpu.storage_of("half weights", &weights)?;
            if half::fits(gpu, &packed) {
                let (interface, pipeline) = kernels.deform_matrix(gpu);
                faster.push(NetworkKernel {
                    name: "f16 matrices",
                    pipeline: pipeline.clone(),
                    bind_group: bind(interface, &weights),
                    splats: half::MATRIX_SPLATS,
                });
            }
            let shape = NetworkShape { precision: NetworkPrecision::Half, ..shape };
            faster.push(NetworkKernel {
                name: "f16",
                pipeline: kernels.deform(gpu, shape),
                bind_group: bind(kernels.deform_interface(gpu, shape.precision), &weights),
                splats: shape.splats,
            });
        }
        let mut stage = Self {
            count: buffers.count,
            has_motion: buffers.has_motion,
            plain,
            half: None,
            precision: NetworkPrecision::Single,
            mask: kernels.mask.clone(),
            mask_group: None,
            packed,
            poses,
            uniform,
            block,
            biases,
            counts: counts.clone(),
            shown: None,
        };
        // Before another kernel is in use: splats at rest are posed in single precision.
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
        for kernel in faster {
            if stage.use_if_it_agrees(gpu, kernel, &buffers.canonical_poses)? {
                break;
            }
        }
        Ok(stage)
    }

    /// Uses a half-precision kernel, when it poses the first splats as the plain one does; `false`
    /// when it does not.
    fn use_if_it_agrees(
        &mut self,
        gpu: &Gpu,
        candidate: NetworkKernel,
        canonical: &wgpu::Buffer,
    ) -> Result<bool, GpuError> {
        const CHECKED: u32 = 4096;
        const CHECK_TIME: f32 = 0.37;
        let checked = u64::from(self.count.min(CHECKED));
        let canonical: Vec<Pose> = readback::read(gpu, canonical, checked)?;
        let plain = self.evaluate_at(gpu, CHECK_TIME, checked)?;
        let name = candidate.name;
        self.half = Some(candidate);
        self.set_precision(NetworkPrecision::Half);
        let ours = self.evaluate_at(gpu, CHECK_TIME, checked)?;
        self.invalidate();
        let agrees = half::agrees(&canonical, &plain, &ours);
        if !agrees {
            tracing::warn!("the {name} network differs from the plain one on this device");
            self.set_precision(NetworkPrecision::Single);
            self.half = None;
        }
        Ok(agrees)
    }

    /// Uses the kernel of this precision from the next frame on; the plain one where there is no
    /// other.
    pub(crate) fn set_precision(&mut self, precision: NetworkPrecision) {
        if self.precision != precision && self.half.is_some() {
            self.precision = precision;
            self.invalidate();
        }
    }

    /// The kernel in use.
    fn network(&self) -> &NetworkKernel {
        match (self.precision, &self.half) {
            (NetworkPrecision::Half, Some(half)) => half,
            _ => &self.plain,
        }
    }

    /// Poses of the first `count` splats at a time.
    fn evaluate_at(&mut self, gpu: &Gpu, time: f32, count: u64) -> Result<Vec<Pose>, GpuError> {
        let work = self.prepare(gpu, time, None);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        self.record_network(work, &mut pass, Groups::Direct(0));
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        readback::read(gpu, &self.poses, count)
    }

    /// Name of the kernel that evaluates the network.
    pub(crate) fn kernel_name(&self) -> &'static str {
        self.network().name
    }

    /// Splats per workgroup of the network.
    pub(crate) fn splats_per_group(&self) -> u32 {
        self.network().splats
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
            DeformWork::All => Groups::Direct(self.count.div_ceil(self.network().splats)),
            DeformWork::Listed | DeformWork::Masked => listed,
        };
        if self.count == 0 {
            return;
        }
        pass.set_pipeline(&self.network().pipeline);
        pass.set_bind_group(0, &self.network().bind_group, &[]);
        dispatch(pass, groups);
    }
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
