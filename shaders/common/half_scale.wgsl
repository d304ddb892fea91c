// Powers of two that bring the factors of the network's products into the range of halves, 6e-8 … 65 504.
//
// Needs: common/network, common/matrix_block, common/matrix_tile_split; of the stage: `layer`,
// `activations`.

/// Weights lie in the middle of the range; Adam's steps cannot take one beyond 1023 before a run ends.
const WEIGHT_SCALE: f32 = 64.0;
/// Features are of the size of one, of which a 2²¹st is lost; those of a splat that has gone astray may
/// be a million times as large.
const FEATURE_SCALE: f32 = 0.0625;
/// Largest feature that fits: larger ones, which only splats far outside the scene have, are this.
const MOST_FEATURE: f32 = 1048064.0;
/// Rows of the gradient by the network's outputs.
const HEAD_OUTPUTS: u32 = 12u;

/// Features within the range. What is no number may become one: it is also in the sums that it came
/// from.
fn limited_features(features: vec4<f32>) -> vec4<f32> {
    return clamp(features, vec4<f32>(-MOST_FEATURE), vec4<f32>(MOST_FEATURE));
}

/// The largest of sixteen that wait in `sums`.
fn largest_of_sixteen(first: u32, stride: u32) -> f32 {
    var largest = 0.0;
    for (var i = 0u; i < 16u; i++) {
        largest = max(largest, sums[first + i * stride].x);
    }
    return largest;
}

/// For gradients, which are as small as the share of one pixel in the loss, in `vectors` vectors of four
/// columns: brings the largest gradient by an output of the network there to 2⁴ … 2⁵. The layers may make
/// it two thousand times as large; what is a 2⁻²⁹th of it is lost. Where they make it larger still, the
/// sums are no numbers, as where a gradient overflows in single precision.
fn gradient_scale(first_vector: u32, vectors: u32, thread: u32) -> f32 {
    var largest = vec4<f32>(0.0);
    for (var i = thread; i < HEAD_OUTPUTS * vectors; i += 256u) {
        let at = (layer.head_row + i / vectors) * layer.row_vectors + first_vector + i % vectors;
        largest = max(largest, abs(activations[at]));
    }
    // Not by an atomic: with one in the workgroup memory of a kernel, cooperative products gave zeros
    // on an H100 (Vulkan).
    workgroupBarrier();
    sums[thread].x = max(max(largest.x, largest.y), max(largest.z, largest.w));
    workgroupBarrier();
    // Every thread the largest of sixteen, then of these.
    let sixteen = largest_of_sixteen(thread / 16u * 16u, 1u);
    workgroupBarrier();
    sums[thread].x = sixteen;
    workgroupBarrier();
    let exponent = bitcast<u32>(largest_of_sixteen(0u, 16u)) >> 23u;
    // 2^(4 − (exponent − 127)) by its bits; at most 2¹⁰⁰, so that its inverse is a normal number.
    return bitcast<f32>(clamp(258u - exponent, 3u, 227u) << 23u);
}
