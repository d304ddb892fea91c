// How many splats there are, in kernels over trainable parameters; `rust-core/gpu/src/layout.rs` has
// the same struct.

struct SplatCount {
    /// Splats that are there.
    count: u32,
    /// Splats that there is room for.
    capacity: u32,
    /// SH degree of the stored coefficients.
    stored_degree: u32,
    /// SH degree that the frame evaluates.
    degree: u32,
}

/// Floats of the bands 1…`degree` of one splat.
fn rest_floats(degree: u32) -> u32 {
    return 3u * ((degree + 1u) * (degree + 1u) - 1u);
}
