// Scales of the factors of deform_layer.wgsl, for products of halves.
//
// Needs: common/half_scale.

/// Weights, and the input.
fn factor_scales(first: u32, end: u32, thread: u32) -> vec2<f32> {
    return vec2<f32>(WEIGHT_SCALE, FEATURE_SCALE);
}

fn limited_right(features: vec4<f32>) -> vec4<f32> {
    return limited_features(features);
}
