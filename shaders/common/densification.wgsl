// The uniform block of a change of the set of splats; `rust-core/train/src/gpu_backend/layout.rs` has
// the same struct.

struct Densification {
    /// Splats that there are, and that there will be.
    splats: u32,
    count: u32,
    /// Seed of the run, low and high word.
    seed: vec2<u32>,
    /// Steps taken, and what is drawn: relocation or growth.
    step: u32,
    purpose: u32,
    /// Opacities weigh their units of 2⁻²³ shifted right by this.
    shift: u32,
    /// Weight of every splat where none weighs anything and the set has to grow all the same; 0
    /// where nothing happens then.
    even_weight: u32,
    /// At most this logit is dead.
    dead_logit: f32,
    /// Lowest logit that a copy gets.
    lowest_logit: f32,
    padding_1: u32,
    padding_2: u32,
}

/// In the list of hosts: no splat, and the mark of a dead one that has none yet.
const NO_HOST: u32 = 0xffffffffu;
const DEAD: u32 = 0xfffffffeu;
