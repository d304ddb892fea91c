// Scales of the factors of deform_weights_backward.wgsl, for products of halves.
//
// Needs: common/half_scale.

/// ∂L/∂y at the columns of the part, and x.
fn factor_scales(first: u32, end: u32, thread: u32) -> vec2<f32> {
    let vectors_of_step = STEP / 4u;
    let scale = gradient_scale(first * vectors_of_step, (end - first) * vectors_of_step, thread);
    return vec2<f32>(scale, FEATURE_SCALE);
}

fn limited_right(features: vec4<f32>) -> vec4<f32> {
    return limited_features(features);
}
