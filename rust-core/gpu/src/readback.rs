//! From the GPU to the host.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use bytemuck::AnyBitPattern;

use crate::layout::counter;
use crate::{Gpu, GpuError};

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
    fn from_words(words: &[u32]) -> Self {
        Self { visible: words[counter::VISIBLE], most_entries: words[counter::MOST_ENTRIES] }
    }
}

/// Reads the counts of the last frame, and waits for them.
pub(crate) fn counts(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Counts, GpuError> {
    Ok(Counts::from_words(&read::<u32>(gpu, buffer, counter::COUNT as u64)?))
}

const FREE: u8 = 0;
const PENDING: u8 = 1;
const READY: u8 = 2;
const FAILED: u8 = 3;

/// Reads counts without waiting: a few small buffers in turn, each mapped when the GPU has come to
/// it. A frame for which none is free is not counted; the next one is.
#[derive(Debug)]
pub(crate) struct CountReader {
    slots: [CountSlot; 3],
    recorded: Option<usize>,
}

#[derive(Debug)]
struct CountSlot {
    buffer: wgpu::Buffer,
    state: Arc<AtomicU8>,
}

impl CountReader {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let slot = || -> Result<CountSlot, GpuError> {
            let buffer = gpu.buffer("counts readback", 4 * counter::COUNT as u64, usage)?;
            Ok(CountSlot { buffer, state: Arc::new(AtomicU8::new(FREE)) })
        };
        Ok(Self { slots: [slot()?, slot()?, slot()?], recorded: None })
    }

    /// Counts that have arrived since the last call; those of the most demanding frame.
    pub(crate) fn latest(&mut self) -> Option<Counts> {
        let mut latest: Option<Counts> = None;
        for slot in &self.slots {
            match slot.state.load(Ordering::Acquire) {
                READY => {}
                FAILED => {
                    slot.state.store(FREE, Ordering::Release);
                    continue;
                }
                _ => continue,
            }
            if let Ok(view) = slot.buffer.slice(..4 * counter::COUNT as u64).get_mapped_range() {
                let words: Vec<u32> = bytemuck::pod_collect_to_vec(&view);
                let counts = Counts::from_words(&words);
                if latest.is_none_or(|l| counts.most_entries >= l.most_entries) {
                    latest = Some(counts);
                }
            }
            slot.buffer.unmap();
            slot.state.store(FREE, Ordering::Release);
        }
        latest
    }

    /// Records copying the counts of the frame at hand.
    pub(crate) fn record(&mut self, encoder: &mut wgpu::CommandEncoder, counts: &wgpu::Buffer) {
        self.recorded =
            self.slots.iter().position(|slot| slot.state.load(Ordering::Acquire) == FREE);
        if let Some(i) = self.recorded {
            let bytes = 4 * counter::COUNT as u64;
            encoder.copy_buffer_to_buffer(counts, 0, &self.slots[i].buffer, 0, bytes);
        }
    }

    /// Asks for the counts that were recorded, after the frame has been submitted.
    pub(crate) fn map(&mut self) {
        let Some(i) = self.recorded.take() else { return };
        let slot = &self.slots[i];
        slot.state.store(PENDING, Ordering::Release);
        let state = slot.state.clone();
        slot.buffer.slice(..4 * counter::COUNT as u64).map_async(wgpu::MapMode::Read, move |r| {
            state.store(if r.is_ok() { READY } else { FAILED }, Ordering::Release);
        });
    }
}
