//! Frames that need larger buffers than there are.

use trapeze_scene::{Camera, FrameSettings};

use super::{COUNTED_FRAMES, Output, Renderer};
use crate::GpuError;
use crate::late_reader::Words;
use crate::layout::counter;
use crate::readback::Counts;
use crate::tiles::{EntryBuffers, max_capacity, tile_count};

impl Renderer {
    /// Submits a frame, waits for it, and returns its counts.
    fn submit_and_wait(&mut self, mut encoder: wgpu::CommandEncoder) -> Result<Counts, GpuError> {
        if self.counts.under_way() == COUNTED_FRAMES {
            self.gpu.wait()?;
            self.last_counts_under_way()?;
        }
        let words = Words { buffer: &self.order.counts, first: 0, count: counter::COUNT as u32 };
        self.counts.record(&mut encoder, 0, &[words]);
        self.gpu.queue().submit([encoder.finish()]);
        self.counts.submitted();
        self.gpu.wait()?;
        self.last_counts_under_way()
    }

    /// Takes all counts under way, after the GPU has come to them, and returns the last.
    fn last_counts_under_way(&mut self) -> Result<Counts, GpuError> {
        let mut last = self.last_counts;
        while self.counts.under_way() > 0 {
            match self.counts.take()? {
                Some((_, words)) => last = Counts::from_words(&words),
                // Another thread that polls the device may be the one that runs the callback.
                None => {
                    std::thread::yield_now();
                    self.gpu.poll()?;
                }
            }
        }
        Ok(last)
    }

    /// Counts that have arrived since the last call: those of the most demanding frame.
    pub(super) fn arrived_counts(&mut self) -> Result<Option<Counts>, GpuError> {
        let mut most: Option<Counts> = None;
        while let Some((_, words)) = self.counts.take()? {
            let counts = Counts::from_words(&words);
            if most.is_none_or(|m| counts.most_entries >= m.most_entries) {
                most = Some(counts);
            }
        }
        Ok(most)
    }

    /// Draws until the frame has fitted into the buffers.
    pub(super) fn draw_until_complete(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
        layers: bool,
        output: Output,
    ) -> Result<(), GpuError> {
        loop {
            let encoder = self.encode(camera, settings, layers, output, true)?;
            let counts = self.submit_and_wait(encoder)?;
            self.last_counts = counts;
            let tiles = match output {
                Output::Image => tile_count([camera.width, camera.height]),
                Output::Tile(_) => 1,
            };
            if !self.make_room(counts, tiles)? {
                return Ok(());
            }
        }
    }

    /// Makes room for the entries that a frame needed; `false` when there was enough.
    pub(super) fn make_room(&mut self, counts: Counts, tiles: u32) -> Result<bool, GpuError> {
        let need = counts.most_entries;
        let capacity = self.entries.pairs.capacity;
        if need <= capacity {
            return Ok(false);
        }
        let most = max_capacity(&self.gpu).min(self.options.max_entries.unwrap_or(u32::MAX));
        if need > most {
            // Regions of the image, one after the other.
            let times = need.div_ceil(most).max(2);
            if self.pieces >= tiles {
                return Err(GpuError::OutOfMemory {
                    what: "splats in one tile",
                    need: u64::from(need) * 16,
                    have: u64::from(most) * 16,
                });
            }
            self.pieces = self.pieces.saturating_mul(times).min(tiles);
        }
        let wanted = (u64::from(need) * 5 / 4).min(u64::from(most)) as u32;
        if wanted > capacity {
            // The old buffers go first: both together might not fit.
            self.main.unbind();
            self.pick.target.unbind();
            let kernels = &self.gpu.kernels().sort;
            self.entries = EntryBuffers::new(&self.gpu, kernels, &self.order.counts, 1)?;
            self.entries = EntryBuffers::new(&self.gpu, kernels, &self.order.counts, wanted)?;
        }
        Ok(true)
    }
}
