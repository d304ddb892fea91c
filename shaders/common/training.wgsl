// What the kernels of a training step share: its uniform block, and the words of its report.
// `rust-core/train/src/gpu_backend/layout.rs` has the same struct, and a test compares them.

struct TrainingStep {
    /// Splats.
    splats: u32,
    /// Number of the step, from 0.
    step: u32,
    /// Seed of the run, low and high word.
    seed: vec2<u32>,
    /// Colour behind the splats and behind a transparent target.
    background: vec4<f32>,
    /// Width and height of the view, pixels.
    image: vec2<u32>,
    /// Tiles across and down.
    tiles: vec2<u32>,
    /// (1 − λ) / (3·W·H) and λ / (3·W·H).
    l1_scale: f32,
    ssim_scale: f32,
    /// Whether the target has a weight for each pixel.
    weighted: u32,
    /// Slot of the ring that the report goes to.
    slot: u32,
    /// Learning rate of each group, in the order of the arrays, with Adam's first correction.
    rates: array<vec4<f32>, 2>,
    /// Adam's constants (`AdamStep` on the host).
    beta1: f32,
    one_minus_beta1: f32,
    beta2: f32,
    one_minus_beta2: f32,
    second_correction: f32,
    epsilon: f32,
    /// λₒ/n and λₛ/3n of the regularisers.
    opacity_pressure: f32,
    scale_pressure: f32,
    /// Noise of the positions: rate times scale, steepness and opacity of the gate.
    noise_amplitude: f32,
    gate_steepness: f32,
    gate_opacity: f32,
    /// 0, which no compiler knows (see numbers.wgsl).
    zero: u32,
}

// The reports of a run are a ring of slots, an array of u32.

/// Words of a slot.
const REPORT_WORDS: u32 = 8u;
/// Σ|x − y| and Σ(1 − SSIM) over pixels and channels, bits of floats.
const REPORT_DIFFERENCE: u32 = 0u;
const REPORT_DISSIMILARITY: u32 = 1u;
/// Values of the image that are not finite.
const REPORT_IMAGE_NOT_FINITE: u32 = 2u;
/// Parameters that kept their value because something was not finite.
const REPORT_NOT_FINITE: u32 = 3u;
/// Splats drawn.
const REPORT_VISIBLE: u32 = 4u;
/// Most tile entries that a view has needed since the host last asked.
const REPORT_ENTRIES: u32 = 5u;
/// Whether the step was not taken, because it or one before it could not be drawn.
const REPORT_HALTED: u32 = 6u;
/// Number of the step.
const REPORT_STEP: u32 = 7u;

fn report_word(slot: u32, word: u32) -> u32 {
    return slot * REPORT_WORDS + word;
}
