//! Forward and backward over trainable parameters, on the GPU and without waiting.
//!
//! [`DifferentiableRenderer`] is the twin of `trapeze_cpu::DifferentiableRenderer`: `forward` draws
//! and keeps, `backward` is the vector–Jacobian product for any gradient of the image. Both only
//! record commands, so that a training step (forward, loss, backward, update) is one submission.
//!
//! # When the tile entries do not fit
//!
//! How many (splat, tile) pairs a frame has is known on the GPU only, while the buffers for them
//! were made by the host, which is not to wait. So a frame that does not fit *halts* the run, on the
//! GPU: it is not drawn, its gradients are zero, and [`counter::HALTED`](crate::compute::counter)
//! stays 1, with which every later frame is not drawn either and every kernel that changes what
//! outlives a step (the optimiser's) has to do nothing. The host learns of it late
//! ([`FrameStatus`]), and knows from `drawn_frames` which step it was: it makes room, resumes, and
//! gives the orders of that step and those after it again. The run then has the same bits as with
//! buffers that were large enough from the start, however late the host was. To make that rare,
//! [`FrameStatus::wants_room`] says when there is little left, and the host grows the buffers ahead.

mod backward;
mod buffers;
mod forward;
mod host;
mod kernels;
mod record;
mod times;

pub(crate) use kernels::DifferentiableKernels;
pub use times::PassTimes;

use trapeze_scene::{Camera, ShDegree};

use crate::compute::{Words, counter};
use crate::timing::Timer;
use crate::{Gpu, GpuError, ParameterBuffers};
use backward::BackwardBindings;
use buffers::{FrameUniforms, ImageBuffers, SlotBuffers, SplatBuffers, max_entries};
use forward::ForwardBindings;
use times::TIMED_STAGES;

/// What a forward pass is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ForwardSettings {
    /// Highest SH band to evaluate; the others get no gradient.
    pub max_sh_degree: ShDegree,
    /// Whether expected depth is wanted, for a gradient by it.
    pub depth: bool,
}

impl Default for ForwardSettings {
    fn default() -> Self {
        Self { max_sh_degree: ShDegree::Three, depth: false }
    }
}

/// ∂L/∂image on the GPU, for any loss L of the image.
#[derive(Clone, Copy, Debug)]
pub struct ImageGradientBuffers<'a> {
    /// ∂L/∂(r, g, b premultiplied over black, alpha), four `f32` per pixel, rows top to bottom.
    ///
    /// A loss on the image over a background b, rgb + (1 − alpha)·b, has −Σ b·∂L/∂rgb as its part
    /// of the derivative by alpha.
    pub color: &'a wgpu::Buffer,
    /// ∂L/∂(expected depth), one `f32` per pixel. Pixels where nothing was hit have no depth;
    /// their entry is not used.
    pub expected_depth: Option<&'a wgpu::Buffer>,
}

/// What the GPU says about the frames of a run, read late.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameStatus {
    /// Splats that the last frame drew, after culling.
    pub visible: u32,
    /// Most tile entries of any frame since [`record_resume`](DifferentiableRenderer::record_resume).
    pub most_entries: u32,
    /// Whether a frame did not fit; nothing has been drawn since.
    pub halted: bool,
    /// Frames drawn since [`record_resume`](DifferentiableRenderer::record_resume).
    pub drawn_frames: u32,
}

impl FrameStatus {
    /// From the words of [`status_words`](DifferentiableRenderer::status_words).
    ///
    /// # Panics
    /// When there are fewer words than those.
    #[must_use]
    pub fn from_words(words: &[u32]) -> Self {
        Self {
            visible: words[counter::VISIBLE],
            most_entries: words[counter::MOST_ENTRIES],
            halted: words[counter::HALTED] != 0,
            drawn_frames: words[counter::DRAWN_FRAMES],
        }
    }

    /// Whether a frame came so near to `capacity` entries that there should be more room: views
    /// differ, and splats grow.
    #[must_use]
    pub fn wants_room(&self, capacity: u32) -> bool {
        self.halted || u64::from(self.most_entries) * 4 > u64::from(capacity) * 3
    }
}

/// Draws frames of trainable parameters and carries gradients of the image back to them.
///
/// In the steady state (same buffers, sizes that have been seen) recording a step creates nothing.
/// The uniform blocks of a frame are written when it is recorded, before the next submission: one
/// submission holds one forward pass of a renderer.
#[derive(Debug)]
pub struct DifferentiableRenderer {
    gpu: Gpu,
    uniforms: FrameUniforms,
    counts: wgpu::Buffer,
    splats: SplatBuffers,
    slots: SlotBuffers,
    image: ImageBuffers,
    forward: Option<ForwardBindings>,
    backward: Option<BackwardBindings>,
    /// What the frame that was recorded last was recorded with.
    last: Option<LastFrame>,
    timer: Option<Timer>,
}

#[derive(Clone, Copy, Debug)]
struct LastFrame {
    count: u32,
    sh_degree: ShDegree,
    depth: bool,
}

impl DifferentiableRenderer {
    /// A renderer with room for `splats` splats and `entries` tile entries; both grow.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] when that does not fit into the device, [`GpuError::TooWeak`] when
    /// the device cannot run the kernels.
    pub fn new(gpu: &Gpu, splats: u32, entries: u32) -> Result<Self, GpuError> {
        let have = gpu.limits().max_storage_buffers_per_shader_stage;
        if have < kernels::STORAGE_BUFFERS {
            return Err(GpuError::TooWeak {
                adapter: gpu.adapter_info().name,
                what: "storage buffers per stage",
                need: u64::from(kernels::STORAGE_BUFFERS),
                have: u64::from(have),
            });
        }
        let counts = gpu.storage("counts", 4 * counter::COUNT as u64)?;
        Ok(Self {
            uniforms: FrameUniforms::new(gpu),
            splats: SplatBuffers::new(gpu, &counts, splats)?,
            slots: SlotBuffers::new(gpu, &counts, entries.clamp(1, max_entries(gpu)))?,
            image: ImageBuffers::new(gpu)?,
            forward: None,
            backward: None,
            last: None,
            timer: Timer::of_stages(gpu, TIMED_STAGES)?,
            counts,
            gpu: gpu.clone(),
        })
    }

    /// The image of the last frame once it has run: r g b premultiplied over black, alpha = 1 − T;
    /// four `f32` per pixel, rows top to bottom. Another buffer after a larger image.
    #[must_use]
    pub fn image(&self) -> &wgpu::Buffer {
        &self.image.image
    }

    /// Bits of the expected depth (first of four words per pixel; NaN where nothing was hit), when
    /// the last frame was asked for it.
    #[must_use]
    pub fn depth_layers(&self) -> &wgpu::Buffer {
        &self.image.layers
    }

    /// Counts of the last frame, by [`counter`]; kernels of the step bind it to see whether the run
    /// has halted.
    #[must_use]
    pub fn counts(&self) -> &wgpu::Buffer {
        &self.counts
    }

    /// The words to read for a [`FrameStatus`].
    #[must_use]
    pub fn status_words(&self) -> Words<'_> {
        Words { buffer: &self.counts, first: 0, count: counter::COUNT as u32 }
    }

    /// One `u32` per splat: 1 where the last frame drew it, else 0. Another buffer after a larger
    /// number of splats.
    #[must_use]
    pub fn visible(&self) -> &wgpu::Buffer {
        &self.splats.visible
    }

    /// Tile entries that there is room for.
    #[must_use]
    pub fn entry_capacity(&self) -> u32 {
        self.slots.capacity()
    }

    /// Makes room for `entries` tile entries and a quarter more. Frames recorded from now on have
    /// it.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] when there is none.
    pub fn make_room(&mut self, entries: u32) -> Result<(), GpuError> {
        let most = max_entries(&self.gpu);
        if entries > most {
            let bytes = |entries| u64::from(entries) * 40;
            let (need, have) = (bytes(entries), bytes(most));
            return Err(GpuError::OutOfMemory { what: "tile entries", need, have });
        }
        let wanted = (u64::from(entries) * 5 / 4).min(u64::from(most)) as u32;
        if wanted > self.slots.capacity() {
            // The old buffers go first: both together might not fit.
            self.forward = None;
            self.backward = None;
            self.slots = SlotBuffers::new(&self.gpu, &self.counts, wanted)?;
        }
        Ok(())
    }

    /// Records the end of a halt, and sets the count of drawn frames to zero.
    pub fn record_resume(&self, encoder: &mut wgpu::CommandEncoder) {
        for word in [counter::MOST_ENTRIES, counter::HALTED, counter::DRAWN_FRAMES] {
            encoder.clear_buffer(&self.counts, 4 * word as u64, Some(4));
        }
    }

    /// Records drawing one frame, whose state [`backward`](Self::backward) needs. `camera` is
    /// relative to the origin of the splats.
    ///
    /// # Errors
    /// [`GpuError::Scene`] when the camera cannot project, [`GpuError::OutOfMemory`] when the
    /// splats or the image do not fit into the device.
    pub fn forward(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        parameters: &ParameterBuffers,
        camera: &Camera,
        settings: ForwardSettings,
    ) -> Result<(), GpuError> {
        self.record_forward(encoder, parameters, camera, settings, false)
    }

    /// Records the vector–Jacobian product of the last [`forward`](Self::forward): ∂L/∂(stored
    /// parameters) from ∂L/∂image. `parameters` must be those that were drawn, unchanged.
    ///
    /// Every entry of the first `parameters.count` splats of `gradients` is written; splats that no
    /// pixel saw, and all splats while the run is halted, get zeros. The derivative is that of the
    /// image away from its cut-offs (α = 1/255, T = 10⁻⁴, the order of splats), which are taken as
    /// constant; at a clamp (α = 0.99, a colour of 0) it is zero. Nothing is added in an order that
    /// depends on timing: the same frame has the same bits.
    ///
    /// # Errors
    /// [`GpuError::Scene`] when the buffers do not belong to the last frame, or depth is asked for
    /// that it did not have.
    pub fn backward(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        parameters: &ParameterBuffers,
        by_image: ImageGradientBuffers<'_>,
        gradients: &ParameterBuffers,
    ) -> Result<(), GpuError> {
        self.record_backward(encoder, parameters, by_image, gradients, false)
    }

    /// Runs both passes, waits for them, and returns the time that each stage took; `None` where the
    /// device cannot tell.
    ///
    /// # Errors
    /// Those of [`forward`](Self::forward) and [`backward`](Self::backward), and
    /// [`GpuError::Device`] when the device is lost.
    pub fn timed_passes(
        &mut self,
        parameters: &ParameterBuffers,
        camera: &Camera,
        settings: ForwardSettings,
        by_image: ImageGradientBuffers<'_>,
        gradients: &ParameterBuffers,
    ) -> Result<Option<PassTimes>, GpuError> {
        let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
        self.record_forward(&mut encoder, parameters, camera, settings, true)?;
        self.record_backward(&mut encoder, parameters, by_image, gradients, true)?;
        if let Some(timer) = &self.timer {
            timer.resolve(&mut encoder);
        }
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.wait()?;
        let Some(timer) = &self.timer else { return Ok(None) };
        Ok(timer.read_stages(&self.gpu)?.map(|times| PassTimes::of_stages(&times)))
    }
}
