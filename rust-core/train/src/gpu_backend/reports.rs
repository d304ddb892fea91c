//! What steps found, read back late.

use std::collections::VecDeque;

use trapeze_gpu::compute::{LateReader, Words};
use trapeze_gpu::{Gpu, GpuError};

use super::layout::report;
use crate::loss::LossValue;

/// Slots of the ring: enough for the steps that may be on their way, several times over.
pub(super) const SLOTS: u32 = 64;
/// Steps whose reports are read together: a read-back costs as much as a small step.
const BATCH: u32 = 8;

/// Slots on the GPU, and their way to the host.
pub(super) struct ReportRing {
    pub(super) buffer: wgpu::Buffer,
    reader: LateReader,
    next_slot: u32,
    /// Steps since the last copy.
    open: u32,
    /// Whether the encoder at hand has a copy.
    recorded: bool,
    /// Submissions with a copy that has not been taken.
    under_way: VecDeque<wgpu::SubmissionIndex>,
}

impl ReportRing {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let bytes = u64::from(SLOTS * report::WORDS) * 4;
        Ok(Self {
            buffer: gpu.storage("reports", bytes)?,
            reader: LateReader::new(gpu, BATCH * report::WORDS, (SLOTS / BATCH) as usize)?,
            next_slot: 0,
            open: 0,
            recorded: false,
            under_way: VecDeque::new(),
        })
    }

    /// Whether the next copy has no place to go before one was taken.
    pub(super) fn is_full(&self) -> bool {
        self.reader.under_way() as u32 == SLOTS / BATCH
    }

    /// Whether steps wait for a copy.
    pub(super) fn has_open(&self) -> bool {
        self.open > 0
    }

    /// Whether copies are on their way.
    pub(super) fn is_waited_for(&self) -> bool {
        !self.under_way.is_empty()
    }

    /// The slot of the next step.
    pub(super) fn take_slot(&mut self) -> u32 {
        let slot = self.next_slot;
        self.next_slot = (slot + 1) % SLOTS;
        self.open += 1;
        slot
    }

    /// Records copying the open slots when they make a batch, or at once.
    pub(super) fn record(&mut self, encoder: &mut wgpu::CommandEncoder, at_once: bool) {
        if self.open == 0 || !(at_once || self.next_slot.is_multiple_of(BATCH)) {
            return;
        }
        let first = (self.next_slot + SLOTS - self.open) % SLOTS;
        let words = Words {
            buffer: &self.buffer,
            first: first * report::WORDS,
            count: self.open * report::WORDS,
        };
        self.recorded = self.reader.record(encoder, u64::from(self.open), &[words]);
        if self.recorded {
            self.open = 0;
        }
    }

    /// To be called after every submission.
    pub(super) fn submitted(&mut self, index: wgpu::SubmissionIndex) {
        if std::mem::take(&mut self.recorded) {
            self.reader.submitted();
            self.under_way.push_back(index);
        }
    }

    /// The oldest reports, if they have arrived.
    pub(super) fn take(&mut self) -> Result<Option<Vec<RawReport>>, GpuError> {
        let Some((count, words)) = self.reader.take()? else { return Ok(None) };
        self.under_way.pop_front();
        let slots = words.chunks_exact(report::WORDS as usize).take(count as usize);
        Ok(Some(slots.map(RawReport::from_words).collect()))
    }

    /// Waits until the GPU has come to the oldest copy, and no further.
    pub(super) fn wait_for_oldest(&self, gpu: &Gpu) -> Result<(), GpuError> {
        let poll = wgpu::PollType::Wait {
            submission_index: self.under_way.front().cloned(),
            timeout: None,
        };
        gpu.device().poll(poll).map_err(|error| GpuError::Device(error.to_string()))?;
        gpu.check()
    }

    /// Drops what was not taken; the GPU must have come to it.
    pub(super) fn discard(&mut self) -> Result<(), GpuError> {
        while self.take()?.is_some() {}
        self.open = 0;
        Ok(())
    }
}

/// A slot of the ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RawReport {
    pub(super) step: u32,
    /// Σ|x − y| and Σ(1 − SSIM) over pixels and channels.
    difference: f32,
    dissimilarity: f32,
    image_not_finite: u32,
    pub(super) not_finite: u32,
    pub(super) visible: u32,
    /// Tile entries that the view needed.
    pub(super) entries: u32,
    /// Whether the step was not taken.
    pub(super) halted: bool,
}

impl RawReport {
    pub(super) fn from_words(words: &[u32]) -> Self {
        Self {
            step: words[report::STEP],
            difference: f32::from_bits(words[report::DIFFERENCE]),
            dissimilarity: f32::from_bits(words[report::DISSIMILARITY]),
            image_not_finite: words[report::IMAGE_NOT_FINITE],
            not_finite: words[report::NOT_FINITE],
            visible: words[report::VISIBLE],
            entries: words[report::ENTRIES],
            halted: words[report::HALTED] != 0,
        }
    }

    /// The loss of a view of `pixels` pixels; not a number where the image is not.
    pub(super) fn loss(&self, pixels: usize, ssim_weight: f32) -> LossValue {
        if self.image_not_finite > 0 {
            return LossValue { l1: f64::NAN, ssim: f64::NAN, total: f64::NAN };
        }
        let values = 3.0 * pixels as f64;
        let lambda = f64::from(ssim_weight);
        let l1 = f64::from(self.difference) / values;
        let dissimilarity = f64::from(self.dissimilarity) / values;
        LossValue {
            l1,
            ssim: 1.0 - dissimilarity,
            total: (1.0 - lambda) * l1 + lambda * dissimilarity,
        }
    }
}
