// What outputs of the network do to the stored parameters of a splat, and the mirror of it.
//
// Needs: common/numbers, common/rotation, common/exponential, common/deformed_parameters.

/// A sum of rotations shorter than this has no direction: the rounding noise of a canonical rotation
/// that its delta cancels.
const MIN_ROTATION_NORM: f32 = 1e-6;

/// ln(eˡ + d), within its limits.
fn deformed_log_scale(log_scale: f32, d: f32) -> f32 {
    // −∞ is a scale of 0; the other bits that are not finite are not drawn.
    if (is_nan(log_scale) || is_nan(d)) {
        return bitcast<f32>(0x7fc00000u);
    }
    let scale = exponential(log_scale) + d;
    if (!(scale > MIN_DEFORMED_SCALE)) {
        return LOWEST_LOG_SCALE;
    }
    if (scale >= MAX_SCALE) {
        return HIGHEST_LOG_SCALE;
    }
    return natural_log(scale);
}

/// normalise(q) + d, which the projection normalises; nothing, the identity without a gradient,
/// where that has no direction.
fn deformed_rotation(rotation: vec4<f32>, d: vec4<f32>) -> vec4<f32> {
    let sum = unit_rotation(rotation).rotation + d;
    return select(vec4<f32>(0.0), sum, unit_rotation(sum).length >= MIN_ROTATION_NORM);
}

/// ∂L/∂(eˡ + d) from ∂L/∂ln(eˡ + d); zero at the limits.
fn by_scale(gradient: f32, deformed: f32) -> f32 {
    if (!(deformed > LOWEST_LOG_SCALE && deformed < HIGHEST_LOG_SCALE)) {
        return 0.0;
    }
    return gradient * exponential(-deformed);
}
