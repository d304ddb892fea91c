// The uniform block of the deformation stage; `rust-core/gpu/src/layout.rs` has the same struct.

struct Deformation {
    /// World position of the scene's coordinate zero, rounded.
    origin: vec4<f32>,
    /// Turns (1/2π) of 2ᵏ · origin, less whole turns, for each octave k.
    origin_turns: array<vec4<f32>, 24>,
    /// Splats to evaluate when not masked.
    splats: u32,
    /// Whether only the splats listed in `dynamic_splats` are evaluated.
    masked: u32,
    /// Splats whose motion value is at most this are static.
    threshold: f32,
    /// Octaves of the encoded position.
    octaves: u32,
    /// Hidden layers.
    depth: u32,
    /// Layer whose input is [γ(xyz), h].
    skip_layer: u32,
    /// Rows of weights that take γ(xyz): its width, rounded up to a multiple of 16.
    input_rows: u32,
    /// Whether the first six outputs are a screw axis.
    screw: u32,
    /// Whether the sum of rotations stays unnormalised.
    as_trained: u32,
    /// 0, which no compiler knows.
    zero: u32,
    padding_1: u32,
    padding_2: u32,
}
