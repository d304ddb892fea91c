// exp, ln and the logistic function to a few ulp, as the CPU's trainer computes them.
//
// A device's own exp is good to about 3 + 2|x| ulp and its log to 2⁻²¹ absolute; learning rates are
// smaller than that. What is not a number comes out as some number: callers look at the bits of
// what goes in.

const LOG2_E: f32 = 1.442695;
/// ln 2 in two parts; the first has 9 bits, so its product with an exponent is exact.
const LN_2_HIGH: f32 = 0.693359375;
const LN_2_LOW: f32 = -2.1219444e-4;
const LN_2: f32 = 0.6931472;

/// eˣ within 2 ulp for |x| ≤ 87, saturating beyond (Cody and Waite 1980; Taylor to r⁷).
fn exponential(x: f32) -> f32 {
    let limited = clamp(x, -87.0, 88.0);
    let n = round(limited * LOG2_E);
    // `fma` is one operation, which a compiler that reorders sums cannot take apart.
    let r = fma(n, -LN_2_LOW, fma(n, -LN_2_HIGH, limited));
    let series = 1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r / 5040.0)));
    let mantissa = 1.0 + (r + r * r * (0.5 + r * series));
    return mantissa * bitcast<f32>(u32(i32(n) + 127) << 23u);
}

/// 1 / (1 + e⁻ˣ) to a few ulp of itself.
fn logistic(x: f32) -> f32 {
    let e = exponential(-abs(x));
    return select(1.0, e, x < 0.0) / (1.0 + e);
}

/// ln x for positive normal x: exponent bits, and atanh's series on the mantissa in [√½, √2).
fn natural_log(x: f32) -> f32 {
    let bits = bitcast<i32>(x);
    let exponent = (bits - 0x3f3504f3) >> 23u;
    let mantissa = bitcast<f32>(bits - (exponent << 23u));
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    let series =
        2.0 + s2 * (2.0 / 3.0 + s2 * (2.0 / 5.0 + s2 * (2.0 / 7.0 + s2 * (2.0 / 9.0))));
    return f32(exponent) * LN_2 + s * series;
}
