// The deformation network under training, layer by layer: its uniform blocks, and where things are.
// `rust-core/gpu/src/layout.rs` has the same structs.
//
// Splats are evaluated a chunk at a time. The *activations* of a chunk are one matrix, a row per
// feature and a column per splat:
//
//   h₀ … hₖ₋₁ | γ | hₖ … | outputs          (k: the layer that the input is put in front of)
//
// so what a layer reads is a run of rows, [γ, hₖ] for the layer after k included, and so is what it
// writes. In the backward pass each row is overwritten by ∂L/∂(that row before its ReLU) once nobody
// needs it any more.

/// Splats of which the activations are at hand.
struct NetworkChunk {
    /// The first of them, and how many they are.
    first: u32,
    splats: u32,
    /// Columns that are computed, in steps of 16: `splats` rounded up to a multiple of 128. The
    /// columns without a splat have γ = 0 and no gradient.
    steps: u32,
    /// Whether gradients of the weights are those of this chunk alone, or added to what is there.
    starts_sum: u32,
    /// Octaves of the encoded position, and features of the time.
    octaves: u32,
    time_features: u32,
    /// Row of the activations where γ starts, and vectors of four columns in a row.
    encoding_row: u32,
    row_vectors: u32,
    /// γ(t), computed on the host in double precision.
    time: array<vec4<f32>, 13>,
}

/// One layer: y = W x + b. The heads are stacked to one layer, with outputs of zeros at its end.
/// Inputs and outputs are multiples of four.
struct NetworkLayer {
    inputs: u32,
    outputs: u32,
    /// Rows of the activations where x and y start.
    input_row: u32,
    output_row: u32,
    /// Where W (row-major, outputs × inputs) starts among the parameters, in vectors of four; b
    /// follows.
    weights: u32,
    /// Inputs in front that are no hidden features, and get no gradient.
    encoded_inputs: u32,
    /// Vectors of four columns in a row of the activations.
    row_vectors: u32,
    /// Most parts that the sum over splats is cut into.
    most_parts: u32,
    /// Row of the activations where the outputs of the heads start.
    head_row: u32,
}

/// Parts that the sum over the splats of a chunk is cut into: at least four steps each.
fn sum_parts(steps: u32, most_parts: u32) -> u32 {
    return clamp(steps / 4u, 1u, most_parts);
}
