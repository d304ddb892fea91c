// Scales of the factors of deform_layer_backward.wgsl, for products of halves.
//
// Needs: common/half_scale, and deform_layer_backward.wgsl.

/// Weights, and ∂L/∂y at the tile's columns.
fn factor_scales(first: u32, end: u32, thread: u32) -> vec2<f32> {
    return vec2<f32>(WEIGHT_SCALE, gradient_scale(first_column / 4u, TILE_VECTORS, thread));
}

/// A gradient that overflows has to be seen.
fn limited_right(gradients: vec4<f32>) -> vec4<f32> {
    return gradients;
}
