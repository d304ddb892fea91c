//! Stage 2 on the host: the camera in the form that the kernel reads, and the dispatches.

use glam::DVec3;
use trapeze_scene::{Camera, ColorSource, FrameSettings};

use crate::kernel::{part, whole};
use crate::layout::{Frame, Window};
use crate::scene_buffers::{SceneBuffers, color_source_number};
use crate::stage_pass::{Groups, dispatch};
use crate::{Gpu, GpuError};

/// How far outside the image, in half image widths at unit depth, the Jacobian still follows x/z.
const JACOBIAN_MARGIN: f64 = 0.3;

/// The frame's uniform block. `camera` is relative to the scene's origin.
pub(crate) fn frame_uniform(camera: &Camera, settings: &FrameSettings, heat_scale: f32) -> Frame {
    let centre = camera.centre();
    let rotation = camera.rotation();
    let row = |i: usize| narrow(rotation.row(i));
    let size = [f64::from(camera.width), f64::from(camera.height)];
    let focal = [camera.fx, camera.fy];
    let principal = [camera.cx, camera.cy];
    let margin: [f64; 2] = std::array::from_fn(|i| JACOBIAN_MARGIN * size[i] / (2.0 * focal[i]));
    let (depth_near, depth_slope) = match settings.color_source {
        ColorSource::Depth(range) => (range.near, range.slope()),
        _ => (0.0, 0.0),
    };
    Frame {
        rotation_x: row(0),
        rotation_y: row(1),
        rotation_z: row(2),
        centre_high: narrow(centre),
        centre_low: narrow_rest(centre),
        rotation_z_low: narrow_rest(rotation.row(2)),
        focal: focal.map(|v| v as f32),
        principal: principal.map(|v| v as f32),
        slope_min: std::array::from_fn(|i| -(principal[i] / focal[i] + margin[i]) as f32),
        slope_max: std::array::from_fn(|i| {
            ((size[i] - principal[i]) / focal[i] + margin[i]) as f32
        }),
        image: size.map(|v| v as f32),
        sh_degree: settings.max_sh_degree as u32,
        color_source: color_source_number(settings.color_source),
        heat_scale,
        zero: 0,
        depth_near,
        depth_slope,
    }
}

fn narrow(v: DVec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}

/// What `narrow` lost.
fn narrow_rest(v: DVec3) -> [f32; 4] {
    let high = v.as_vec3().as_dvec3();
    narrow(v - high)
}

/// The buffers that the projection writes: one entry per splat of the scene.
#[derive(Debug)]
pub(crate) struct ProjectedBuffers {
    pub centres: wgpu::Buffer,
    pub extents: wgpu::Buffer,
    pub colors: wgpu::Buffer,
}

impl ProjectedBuffers {
    pub(crate) fn new(gpu: &Gpu, splats: u32) -> Result<Self, GpuError> {
        let bytes = u64::from(splats) * 16;
        let have = gpu.max_binding();
        if bytes > have {
            let what = "projected splats in one binding";
            return Err(GpuError::OutOfMemory { what, need: bytes, have });
        }
        Ok(Self {
            centres: gpu.storage("projected centres", bytes)?,
            extents: gpu.storage("projected extents", bytes)?,
            colors: gpu.storage("projected colours", bytes)?,
        })
    }
}

/// The projection of one scene.
#[derive(Debug)]
pub(crate) struct ProjectStage {
    pipeline: wgpu::ComputePipeline,
    windows: Vec<BoundWindow>,
}

#[derive(Debug)]
struct BoundWindow {
    count: u32,
    bind_group: wgpu::BindGroup,
}

/// Splats of a window are a multiple of this: every offset is then a multiple of 256 bytes, the
/// largest alignment that a device may ask for, and whole groups of harmonics.
const WINDOW_STEP: u64 = 256;

impl ProjectStage {
    pub(crate) fn new(
        gpu: &Gpu,
        scene: &SceneBuffers,
        frame: &wgpu::Buffer,
        poses: &wgpu::Buffer,
        projected: &ProjectedBuffers,
        sort_keys: &wgpu::Buffer,
        sort_keys_low: &wgpu::Buffer,
    ) -> Self {
        let kernels = gpu.kernels();
        let bytes = scene.bytes_per_splat();
        let most = gpu.max_binding() / bytes.pose.max(bytes.harmonics);
        let step = (most / WINDOW_STEP * WINDOW_STEP).max(WINDOW_STEP);
        let windows: Vec<Window> = (0..u64::from(scene.count))
            .step_by(step as usize)
            .map(|first| Window {
                first: first as u32,
                count: step.min(u64::from(scene.count) - first) as u32,
                ..Window::default()
            })
            .collect();
        let mut blocks = vec![0; windows.len().max(1) * WINDOW_STEP as usize];
        for (block, window) in blocks.chunks_exact_mut(WINDOW_STEP as usize).zip(&windows) {
            block[..size_of::<Window>()].copy_from_slice(bytemuck::bytes_of(window));
        }
        let uniforms = gpu.uniform_of("windows", &blocks);
        let windows = windows
            .iter()
            .enumerate()
            .map(|(i, window)| {
                let first = u64::from(window.first);
                let count = u64::from(window.count);
                // Harmonics are stored in whole groups.
                let padded = count.next_multiple_of(32);
                let motion = if scene.has_motion {
                    part(&scene.motion, first * 4, count * 4)
                } else {
                    whole(&scene.motion)
                };
                let bind_group = kernels.project_interface.bind(
                    gpu,
                    &[
                        whole(frame),
                        part(&uniforms, i as u64 * WINDOW_STEP, size_of::<Window>() as u64),
                        part(poses, first * bytes.pose, count * bytes.pose),
                        part(&scene.harmonics, first * bytes.harmonics, padded * bytes.harmonics),
                        whole(&scene.clusters),
                        motion,
                        whole(&projected.centres),
                        whole(&projected.extents),
                        whole(&projected.colors),
                        whole(sort_keys),
                        whole(sort_keys_low),
                    ],
                );
                BoundWindow { count: window.count, bind_group }
            })
            .collect();
        Self { pipeline: kernels.project(gpu, scene.sh_degree, scene.harmonics_storage), windows }
    }

    pub(crate) fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        for window in &self.windows {
            pass.set_bind_group(0, &window.bind_group, &[]);
            dispatch(pass, Groups::Direct(window.count.div_ceil(256)));
        }
    }
}
