//! The mirror of the colour.

use trapeze_scene::ShDegree;

use crate::project::{C1, C2, C3};

/// Σ (∂L/∂Yₖ) ∂Yₖ/∂(x, y, z): what the bands 1…`degree` say about the direction, each of its
/// components taken as free. `by_basis` are the derivatives by the basis functions 1…15.
#[inline(always)]
pub(super) fn basis_backward(
    [x, y, z]: [f32; 3],
    degree: ShDegree,
    by_basis: &[f32; 16],
) -> [f32; 3] {
    if degree == ShDegree::Zero {
        return [0.0; 3];
    }
    let g = by_basis;
    let mut out = [-C1 * g[3], -C1 * g[1], C1 * g[2]];
    if degree == ShDegree::One {
        return out;
    }
    let (a, b, c, d, e) = (C2[0] * g[4], C2[1] * g[5], C2[2] * g[6], C2[3] * g[7], C2[4] * g[8]);
    out[0] += a * y - 2.0 * c * x + d * z + 2.0 * e * x;
    out[1] += a * x + b * z - 2.0 * c * y - 2.0 * e * y;
    out[2] += b * y + 4.0 * c * z + d * x;
    if degree == ShDegree::Two {
        return out;
    }
    let (xx, yy, zz, xy, yz, xz) = (x * x, y * y, z * z, x * y, y * z, x * z);
    let h: [f32; 7] = std::array::from_fn(|k| C3[k] * g[9 + k]);
    let difference = xx - yy;
    out[0] += 6.0 * h[0] * xy + h[1] * yz - 2.0 * h[2] * xy - 6.0 * h[3] * xz
        + h[4] * (4.0 * zz - 3.0 * xx - yy)
        + 2.0 * h[5] * xz
        + 3.0 * h[6] * difference;
    out[1] += 3.0 * h[0] * difference + h[1] * xz + h[2] * (4.0 * zz - xx - 3.0 * yy)
        - 6.0 * h[3] * yz
        - 2.0 * h[4] * xy
        - 2.0 * h[5] * yz
        - 6.0 * h[6] * xy;
    out[2] += h[1] * xy
        + 8.0 * h[2] * yz
        + h[3] * (6.0 * zz - 3.0 * (xx + yy))
        + 8.0 * h[4] * xz
        + h[5] * difference;
    out
}

#[cfg(test)]
mod tests {
    use trapeze_scene::sh_basis_gradient;

    use super::*;

    #[test]
    fn the_direction_gets_what_the_specification_says() {
        for degree in ShDegree::ALL {
            for i in 0..200 {
                let at = [0.3, 0.7, 1.1].map(|step| (f64::from(i) * step).sin());
                let by_basis: [f64; 16] =
                    std::array::from_fn(|k| ((i * 16) as f64 + k as f64).cos());
                let slopes = sh_basis_gradient(at);
                let found =
                    basis_backward(at.map(|v| v as f32), degree, &by_basis.map(|v| v as f32));
                for axis in 0..3 {
                    let exact: f64 =
                        (1..degree.coefficients()).map(|k| by_basis[k] * slopes[k][axis]).sum();
                    // About forty terms below 20, each rounded a few times.
                    assert!((f64::from(found[axis]) - exact).abs() < 5e-5, "{degree:?} {axis}");
                }
            }
        }
    }
}
