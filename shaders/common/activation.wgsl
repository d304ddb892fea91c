// From stored parameters to what they stand for, in single precision. The rules for degenerate
// values are those of the f64 reference; `activate.rs` has their twins for scenes that stay as
// they are.
//
// Needs: common/numbers.

const LOG2_E: f32 = 1.44269504;
/// Largest linear scale, world units.
const MAX_SCALE: f32 = 1e12;

/// eˣ, also where a device's own is good to a few digits only (Cephes' expf, Moshier). Ends at
/// e⁸⁷ above, at 0 below e⁻⁸⁷; not for NaN.
fn natural_exp(x: f32) -> f32 {
    let limited = clamp(x, -87.0, 87.0);
    let n = round(limited * LOG2_E);
    let r = fma(-n, -2.12194440e-4, fma(-n, 0.693359375, limited));
    let r2 = r * r;
    var p = 1.9875691500e-4;
    p = fma(p, r, 1.3981999507e-3);
    p = fma(p, r, 8.3334519073e-3);
    p = fma(p, r, 4.1665795894e-2);
    p = fma(p, r, 1.6666665459e-1);
    p = fma(p, r, 5.0000001201e-1);
    let power = (fma(p, r2, r) + 1.0) * bitcast<f32>(u32(i32(n) + 127) << 23u);
    return select(power, 0.0, x < -87.0);
}

/// Standard deviation, at most MAX_SCALE; negative for what is not a number, which is not drawn.
fn linear_scale(log_scale: f32) -> f32 {
    if (is_nan(log_scale)) {
        return -1.0;
    }
    return min(natural_exp(log_scale), MAX_SCALE);
}

/// log₂ σ(x); far below −log₂ 255 where x is not a number.
fn log2_opacity_of(logit: f32) -> f32 {
    if (is_nan(logit)) {
        return -1e3;
    }
    let tail = natural_exp(-abs(logit));
    return clamp(min(logit, 0.0), -1e3, 0.0) * LOG2_E - log2(1.0 + tail);
}

/// 1 − σ(x).
fn transparency_of(logit: f32) -> f32 {
    let tail = natural_exp(-abs(logit));
    return select(1.0, tail, logit > 0.0) / (1.0 + tail);
}
