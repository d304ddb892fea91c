//! From the GPU to the host.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use bytemuck::AnyBitPattern;

use crate::layout::counter;
use crate::{Gpu, GpuError};

const PENDING: u8 = 0;
const READY: u8 = 1;
const FAILED: u8 = 2;

/// Most bytes that are read in one piece.
const PIECE: u64 = 64 << 20;

/// Copies the first `count` elements of a buffer to the host, and waits for them.
///
/// # Errors
/// [`GpuError::Device`] when the device is lost, [`GpuError::OutOfMemory`] when there is no room for
/// a staging buffer.
pub fn read<T: AnyBitPattern>(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    count: u64,
) -> Result<Vec<T>, GpuError> {
    let size = size_of::<T>() as u64;
    let total = count * size;
    let piece_bytes = total.min(PIECE - PIECE % size).max(size);
    let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
    let staging = gpu.buffer("readback", piece_bytes, usage)?;
    let mut out = Vec::with_capacity(count as usize);
    let mut from = 0;
    while from < total {
        let bytes = piece_bytes.min(total - from);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, from, &staging, 0, bytes);
        gpu.queue().submit([encoder.finish()]);
        read_mapped(gpu, &staging, bytes, |data| {
            out.extend_from_slice(bytemuck::cast_slice(data));
        })?;
        from += bytes;
    }
    Ok(out)
}

/// Maps the start of a buffer, waits, and hands its bytes over.
fn read_mapped(
    gpu: &Gpu,
    staging: &wgpu::Buffer,
    bytes: u64,
    read: impl FnOnce(&[u8]),
) -> Result<(), GpuError> {
    let slice = staging.slice(..bytes);
    let mapped = Arc::new(AtomicU8::new(PENDING));
    let state = mapped.clone();
    slice.map_async(wgpu::MapMode::Read, move |result| {
        state.store(if result.is_ok() { READY } else { FAILED }, Ordering::Release);
    });
    gpu.wait()?;
    // Another thread that polls the device may be the one that runs the callback.
    while mapped.load(Ordering::Acquire) == PENDING {
        std::thread::yield_now();
        gpu.poll()?;
    }
    if mapped.load(Ordering::Acquire) != READY {
        return Err(GpuError::Device("a buffer could not be mapped".into()));
    }
    {
        let view = slice.get_mapped_range().map_err(|e| GpuError::Device(e.to_string()))?;
        read(&view);
    }
    staging.unmap();
    Ok(())
}

/// What the GPU counted in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    /// Splats drawn.
    pub visible: u32,
    /// Entries of the most crowded region.
    pub most_entries: u32,
}

impl Counts {
    pub(crate) fn from_words(words: &[u32]) -> Self {
        Self { visible: words[counter::VISIBLE], most_entries: words[counter::MOST_ENTRIES] }
    }
}
