//! From the sums over pixels to the factor M = J W R S of the projected covariance.

use std::f32::consts::LN_2;

use crate::project::ProjectedSplat;
use crate::rasterize_backward::SplatSums;

/// ∂L/∂ what [`ProjectedSplat::from_factor`] is given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct EllipseGradient {
    /// By the centre, 1/px.
    pub centre: [f32; 2],
    /// By the rows of M, 1/px.
    pub mx: [f32; 3],
    /// See `mx`.
    pub my: [f32; 3],
}

/// The mirror of [`ProjectedSplat::from_factor`].
///
/// With c = Σ'yy, σ = Σ'xy / c, D = |Σ'| / c the factor is u22 = k/√c, u11 = k/√D, u12 = −σ u11,
/// k² = log₂e / 2, so 1/c = 2 ln2 u22² and 1/D = 2 ln2 u11². By Σ' = M Mᵀ + 0.3 I,
///
/// D = |mx − σ my|² + 0.3 (1 + σ²) and ∂D/∂mx = 2 (mx − σ my) = 2 r, ∂D/∂my = −2σ r,
/// ∂σ/∂mx = my / c, ∂σ/∂my = (r − σ my) / c, ∂c/∂my = 2 my.
///
/// r is a difference that cancels for needles, but only down to the low-pass: its error relative
/// to √D is ε·|mx| / √0.3.
#[inline(always)]
pub(super) fn ellipse_backward(
    splat: &ProjectedSplat,
    mx: [f32; 3],
    my: [f32; 3],
    sums: &SplatSums,
) -> EllipseGradient {
    let &ProjectedSplat { u11, u12, u22, .. } = splat;
    let slope = -u12 / u11;
    let (u11_squared, u22_squared) = (u11 * u11, u22 * u22);
    // ∂α/∂exponent = ln 2 · α; the exponent is log₂ o − v₁² − v₂².
    let by_d = 2.0 * LN_2 * LN_2 * u11_squared * sums.q_v_v;
    // ∂L/∂σ · 1/c.
    let by_slope = 4.0 * LN_2 * LN_2 * (u11 * sums.q_v_dy) * u22_squared;
    let by_c = 2.0 * LN_2 * LN_2 * u22_squared * (u22_squared * sums.q_dy_dy);
    let r: [f32; 3] = std::array::from_fn(|i| mx[i] - slope * my[i]);
    EllipseGradient {
        centre: [
            2.0 * LN_2 * u11 * sums.q_v,
            2.0 * LN_2 * (u12 * sums.q_v + u22_squared * sums.q_dy),
        ],
        mx: std::array::from_fn(|i| 2.0 * by_d * r[i] + by_slope * my[i]),
        my: std::array::from_fn(|i| {
            by_slope * (r[i] - slope * my[i]) - 2.0 * slope * by_d * r[i] + 2.0 * by_c * my[i]
        }),
    }
}
