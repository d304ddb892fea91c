//! Small results from the GPU without waiting for it.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::{Gpu, GpuError};

const PENDING: u8 = 0;
const READY: u8 = 1;
const FAILED: u8 = 2;

/// Reads a few words per submission, later: [`record`](Self::record) copies them into a small buffer
/// of its own, [`submitted`](Self::submitted) asks for them, and [`take`](Self::take) hands them out
/// in the order in which they were recorded, once the GPU has come to them. Nothing here waits;
/// someone has to call [`Gpu::poll`] now and then.
#[derive(Debug)]
pub struct LateReader {
    words: u32,
    free: Vec<wgpu::Buffer>,
    recorded: Vec<(u64, wgpu::Buffer)>,
    pending: VecDeque<Pending>,
}

#[derive(Debug)]
struct Pending {
    tag: u64,
    buffer: wgpu::Buffer,
    state: Arc<AtomicU8>,
}

/// A run of words in a buffer.
#[derive(Clone, Copy, Debug)]
pub struct Words<'a> {
    /// The buffer; needs the usage `COPY_SRC`.
    pub buffer: &'a wgpu::Buffer,
    /// Index of the first word.
    pub first: u32,
    /// Number of words.
    pub count: u32,
}

impl LateReader {
    /// Room for `slots` reads under way, of `words` 32-bit words each.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu, words: u32, slots: usize) -> Result<Self, GpuError> {
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let make = |_| gpu.buffer("late reads", u64::from(words) * 4, usage);
        let free = (0..slots).map(make).collect::<Result<_, _>>()?;
        Ok(Self { words, free, recorded: Vec::new(), pending: VecDeque::new() })
    }

    /// Records copying `parts`, one after the other, at the place in the work that `encoder` has
    /// come to. `tag` comes back with them. `false`, and nothing is recorded, when every slot is
    /// under way.
    ///
    /// # Panics
    /// When the parts have more words than a slot.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        tag: u64,
        parts: &[Words<'_>],
    ) -> bool {
        let words: u32 = parts.iter().map(|part| part.count).sum();
        assert!(words <= self.words, "{words} words in a slot of {}", self.words);
        let Some(slot) = self.free.pop() else { return false };
        let mut at = 0;
        for part in parts {
            let bytes = u64::from(part.count) * 4;
            encoder.copy_buffer_to_buffer(part.buffer, u64::from(part.first) * 4, &slot, at, bytes);
            at += bytes;
        }
        self.recorded.push((tag, slot));
        true
    }

    /// To be called after what was recorded has been submitted.
    pub fn submitted(&mut self) {
        for (tag, buffer) in self.recorded.drain(..) {
            let state = Arc::new(AtomicU8::new(PENDING));
            let told = state.clone();
            buffer.slice(..u64::from(self.words) * 4).map_async(wgpu::MapMode::Read, move |r| {
                told.store(if r.is_ok() { READY } else { FAILED }, Ordering::Release);
            });
            self.pending.push_back(Pending { tag, buffer, state });
        }
    }

    /// The oldest read, with its tag, if it has arrived. Words beyond those recorded are
    /// unspecified.
    ///
    /// # Errors
    /// [`GpuError::Device`] when it could not be read: the device is lost.
    pub fn take(&mut self) -> Result<Option<(u64, Vec<u32>)>, GpuError> {
        match self.pending.front().map(|oldest| oldest.state.load(Ordering::Acquire)) {
            None | Some(PENDING) => return Ok(None),
            _ => {}
        }
        let Some(oldest) = self.pending.pop_front() else { return Ok(None) };
        if oldest.state.load(Ordering::Acquire) == FAILED {
            return Err(GpuError::Device("a buffer could not be mapped".into()));
        }
        let words = {
            let slice = oldest.buffer.slice(..u64::from(self.words) * 4);
            let view = slice.get_mapped_range().map_err(|e| GpuError::Device(e.to_string()))?;
            bytemuck::pod_collect_to_vec(&view)
        };
        oldest.buffer.unmap();
        self.free.push(oldest.buffer);
        Ok(Some((oldest.tag, words)))
    }

    /// Reads that have been asked for and not taken.
    #[must_use]
    pub fn under_way(&self) -> usize {
        self.pending.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel_tests::device;

    #[test]
    fn words_arrive_in_order_without_a_wait() {
        let Some(gpu) = device() else { return };
        let buffer = gpu.storage_of("words", &[1u32, 2, 3, 4]).unwrap();
        let mut reader = LateReader::new(&gpu, 3, 2).unwrap();
        let waits = gpu.created().waits;
        let part = |first, count| Words { buffer: &buffer, first, count };
        for tag in [7, 8] {
            gpu.queue().write_buffer(&buffer, 0, bytemuck::bytes_of(&(tag as u32)));
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            assert!(reader.record(&mut encoder, tag, &[part(3, 1), part(0, 2)]));
            gpu.queue().submit([encoder.finish()]);
            reader.submitted();
        }
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        assert!(!reader.record(&mut encoder, 9, &[part(0, 1)]), "both slots are under way");
        let mut found = Vec::new();
        while found.len() < 2 {
            gpu.poll().unwrap();
            found.extend(reader.take().unwrap());
        }
        assert_eq!(found, [(7, vec![4, 7, 2]), (8, vec![4, 8, 2])]);
        assert_eq!((reader.under_way(), gpu.created().waits), (0, waits));
        assert!(reader.record(&mut encoder, 9, &[part(0, 1)]), "a slot is free again");
    }
}
