//! Looks at the splats at some times, on their way back to the host in one piece.

use trapeze_gpu::compute::read;
use trapeze_gpu::{GpuError, ParameterBuffers};

use super::device::{DeviceSide, Run};
use crate::rest::{DeformedGeometry, Look, MOST_MOMENTS};

/// Floats of the geometry of a splat: centre, log-scales, rotation.
const FLOATS: u64 = 10;

/// Bytes that a look takes for a while.
pub(super) fn bytes(splats: u32) -> u64 {
    // On the device, and where the host maps it.
    2 * (MOST_MOMENTS as u64 + 1) * 4 * FLOATS * u64::from(splats)
}

/// Waits for the splats as they are stored and at each of `times`.
pub(super) fn look(
    device: &mut DeviceSide,
    run: &mut Run,
    times: &[f32],
) -> Result<Look, GpuError> {
    let splats = u64::from(run.splats.count());
    let moments = times.len() as u64 + 1;
    let all = device.gpu.storage("moments", (moments * splats * FLOATS * 4).max(4))?;
    // The network's uniform blocks are of one evaluation: each has a submission of its own.
    for (place, time) in (0..).zip([None].into_iter().chain(times.iter().map(Some))) {
        let mut encoder = device.gpu.device().create_command_encoder(&Default::default());
        let shown = match time {
            None => run.splats.parameters.clone(),
            Some(&time) => run.record_pose(&mut encoder, time)?,
        };
        record_copies(&mut encoder, &shown, &all, place * splats * FLOATS * 4);
        device.submit(encoder);
    }
    let floats: Vec<f32> = read(&device.gpu, &all, moments * splats * FLOATS)?;
    let mut geometries = floats.chunks_exact((splats * FLOATS).max(1) as usize).map(Arrays::of);
    let Some(stored) = geometries.next() else { return Ok(Look::default()) };
    let positions = stored.positions.to_vec();
    Ok(Look {
        stored: DeformedGeometry::of_stored(positions, stored.log_scales, stored.rotations),
        moments: geometries.map(|arrays| arrays.to_geometry()).collect(),
    })
}

fn record_copies(
    encoder: &mut wgpu::CommandEncoder,
    from: &ParameterBuffers,
    to: &wgpu::Buffer,
    mut offset: u64,
) {
    let splats = u64::from(from.count);
    for (buffer, floats) in [(&from.positions, 3), (&from.log_scales, 3), (&from.rotations, 4)] {
        let bytes = 4 * floats * splats;
        if bytes > 0 {
            encoder.copy_buffer_to_buffer(buffer, 0, to, offset, bytes);
        }
        offset += bytes;
    }
}

/// The geometry of one moment, as it was copied.
struct Arrays<'a> {
    positions: &'a [[f32; 3]],
    log_scales: &'a [[f32; 3]],
    rotations: &'a [[f32; 4]],
}

impl<'a> Arrays<'a> {
    fn of(floats: &'a [f32]) -> Self {
        let splats = floats.len() / FLOATS as usize;
        let (positions, rest) = floats.split_at(3 * splats);
        let (log_scales, rotations) = rest.split_at(3 * splats);
        Self {
            positions: positions.as_chunks().0,
            log_scales: log_scales.as_chunks().0,
            rotations: rotations.as_chunks().0,
        }
    }

    fn to_geometry(&self) -> DeformedGeometry {
        DeformedGeometry {
            positions: self.positions.to_vec(),
            rotations: self.rotations.to_vec(),
            scales: self.log_scales.iter().map(|scale| scale.map(f32::exp)).collect(),
        }
    }
}
