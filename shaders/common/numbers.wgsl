// Arithmetic that has to survive compilers which assume finite numbers or reorder sums.
//
// Metal compiles with fast math, and Mesa simplifies x − (x + y) where nothing forbids it. So what
// is not a number is found by its bits, and the terms of two-float arithmetic pass through an
// exclusive or with a zero that the compiler cannot see.

fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

fn is_nan(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u;
}

/// `x`, in a form about which the compiler knows nothing. `zero` is a uniform that holds 0.
fn opaque(x: f32, zero: u32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ zero);
}

/// The upper 12 bits of the significand: products of two such numbers are exact.
fn upper_half(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
}

/// a + b as (rounded sum, what rounding took from it) (Knuth's TwoSum).
fn two_sum(a: f32, b: f32, zero: u32) -> vec2<f32> {
    let sum = opaque(a + b, zero);
    let b_part = opaque(sum - a, zero);
    let a_part = opaque(sum - b_part, zero);
    return vec2<f32>(sum, (a - a_part) + (b - b_part));
}

/// a · b as (rounded product, what rounding took from it) (Dekker's product, without relying on a
/// fused multiply-add, which WGSL does not promise).
fn two_product(a: f32, b: f32, zero: u32) -> vec2<f32> {
    let product = opaque(a * b, zero);
    let a_high = upper_half(a);
    let b_high = upper_half(b);
    let a_low = a - a_high;
    let b_low = b - b_high;
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    return vec2<f32>(product, error);
}

/// The sum of two two-float numbers.
fn add_two_floats(a: vec2<f32>, b: vec2<f32>, zero: u32) -> vec2<f32> {
    let sum = two_sum(a.x, b.x, zero);
    return two_sum(sum.x, sum.y + (a.y + b.y), zero);
}
