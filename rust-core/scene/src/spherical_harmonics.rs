//! Real spherical harmonics up to degree 3, in the sign and order convention of the INRIA files.

use crate::SceneError;

/// Highest band of view-dependent colour that a set of splats stores.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ShDegree {
    /// Constant colour: 1 coefficient.
    #[default]
    Zero = 0,
    /// 4 coefficients.
    One = 1,
    /// 9 coefficients.
    Two = 2,
    /// 16 coefficients.
    Three = 3,
}

impl ShDegree {
    /// All degrees, lowest first.
    pub const ALL: [Self; 4] = [Self::Zero, Self::One, Self::Two, Self::Three];

    /// Coefficients per channel, band 0 included: (degree + 1)².
    #[must_use]
    pub const fn coefficients(self) -> usize {
        let bands = self as usize + 1;
        bands * bands
    }

    /// Coefficients per channel without band 0.
    #[must_use]
    pub const fn rest_coefficients(self) -> usize {
        self.coefficients() - 1
    }

    /// The degree whose bands above 0 hold `count` coefficients per channel.
    #[must_use]
    pub fn from_rest_coefficients(count: usize) -> Option<Self> {
        Self::ALL.into_iter().find(|d| d.rest_coefficients() == count)
    }
}

impl TryFrom<u32> for ShDegree {
    type Error = SceneError;

    fn try_from(degree: u32) -> Result<Self, SceneError> {
        Self::ALL.get(degree as usize).copied().ok_or(SceneError::ShDegree { found: degree })
    }
}

/// Band 0: 1 / (2√π).
pub const SH_C0: f64 = 0.282_094_791_773_878_14;
/// Band 1: √3 / (2√π).
pub const SH_C1: f64 = 0.488_602_511_902_919_9;
/// Band 2 in file order: xy, yz, 2z²−x²−y², xz, x²−y².
pub const SH_C2: [f64; 5] = [
    1.092_548_430_592_079_2,
    -1.092_548_430_592_079_2,
    0.315_391_565_252_520_05,
    -1.092_548_430_592_079_2,
    0.546_274_215_296_039_6,
];
/// Band 3 in file order.
pub const SH_C3: [f64; 7] = [
    -0.590_043_589_926_643_5,
    2.890_611_442_640_554,
    -0.457_045_799_464_465_8,
    0.373_176_332_590_115_4,
    -0.457_045_799_464_465_8,
    1.445_305_721_320_277,
    -0.590_043_589_926_643_5,
];

/// The 16 basis functions at the unit direction (x, y, z), in file order.
///
/// Source: Kerbl et al. 2023, reference implementation; the polynomial form of the real spherical
/// harmonics with the Condon–Shortley phase.
#[must_use]
pub fn sh_basis([x, y, z]: [f64; 3]) -> [f64; 16] {
    let (xx, yy, zz) = (x * x, y * y, z * z);
    [
        SH_C0,
        -SH_C1 * y,
        SH_C1 * z,
        -SH_C1 * x,
        SH_C2[0] * x * y,
        SH_C2[1] * y * z,
        SH_C2[2] * (2.0 * zz - xx - yy),
        SH_C2[3] * x * z,
        SH_C2[4] * (xx - yy),
        SH_C3[0] * y * (3.0 * xx - yy),
        SH_C3[1] * x * y * z,
        SH_C3[2] * y * (4.0 * zz - xx - yy),
        SH_C3[3] * z * (2.0 * zz - 3.0 * xx - 3.0 * yy),
        SH_C3[4] * x * (4.0 * zz - xx - yy),
        SH_C3[5] * z * (xx - yy),
        SH_C3[6] * x * (xx - 3.0 * yy),
    ]
}

/// ∂(basis function) / ∂(x, y, z) of [`sh_basis`], each component of the direction taken as free.
#[must_use]
pub fn sh_basis_gradient([x, y, z]: [f64; 3]) -> [[f64; 3]; 16] {
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let scaled = |factor: f64, gradient: [f64; 3]| gradient.map(|g| factor * g);
    [
        [0.0; 3],
        [0.0, -SH_C1, 0.0],
        [0.0, 0.0, SH_C1],
        [-SH_C1, 0.0, 0.0],
        scaled(SH_C2[0], [y, x, 0.0]),
        scaled(SH_C2[1], [0.0, z, y]),
        scaled(SH_C2[2], [-2.0 * x, -2.0 * y, 4.0 * z]),
        scaled(SH_C2[3], [z, 0.0, x]),
        scaled(SH_C2[4], [2.0 * x, -2.0 * y, 0.0]),
        scaled(SH_C3[0], [6.0 * x * y, 3.0 * (xx - yy), 0.0]),
        scaled(SH_C3[1], [y * z, x * z, x * y]),
        scaled(SH_C3[2], [-2.0 * x * y, 4.0 * zz - xx - 3.0 * yy, 8.0 * y * z]),
        scaled(SH_C3[3], [-6.0 * x * z, -6.0 * y * z, 6.0 * zz - 3.0 * (xx + yy)]),
        scaled(SH_C3[4], [4.0 * zz - 3.0 * xx - yy, -2.0 * x * y, 8.0 * x * z]),
        scaled(SH_C3[5], [2.0 * x * z, -2.0 * y * z, xx - yy]),
        scaled(SH_C3[6], [3.0 * (xx - yy), -6.0 * x * y, 0.0]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_basis_is_orthonormal_over_the_sphere() {
        // Gauss–Legendre in z (16 nodes are exact to degree 31) and a uniform rule in azimuth
        // integrate products of two degree-3 functions exactly, so only rounding is left.
        let nodes = gauss_legendre(16);
        let azimuths = 16;
        let mut gram = [[0.0; 16]; 16];
        for (z, weight) in nodes {
            for k in 0..azimuths {
                let phi = std::f64::consts::TAU * f64::from(k) / f64::from(azimuths);
                let r = (1.0 - z * z).sqrt();
                let b = sh_basis([r * phi.cos(), r * phi.sin(), z]);
                let w = weight * std::f64::consts::TAU / f64::from(azimuths);
                for i in 0..16 {
                    for j in 0..16 {
                        gram[i][j] += w * b[i] * b[j];
                    }
                }
            }
        }
        for (i, row) in gram.iter().enumerate() {
            for (j, &g) in row.iter().enumerate() {
                let expected = f64::from(u8::from(i == j));
                assert!((g - expected).abs() < 1e-12, "<{i}|{j}> = {g}");
            }
        }
    }

    fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
        (0..n)
            .map(|i| {
                let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
                let mut derivative = 1.0;
                for _ in 0..50 {
                    let (mut p0, mut p1) = (1.0, x);
                    for k in 2..=n {
                        let k = k as f64;
                        (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
                    }
                    derivative = n as f64 * (x * p1 - p0) / (x * x - 1.0);
                    x -= p1 / derivative;
                }
                (x, 2.0 / ((1.0 - x * x) * derivative * derivative))
            })
            .collect()
    }

    #[test]
    fn the_gradient_is_the_difference_quotient_of_the_basis() {
        // Cubics: the central difference is off by h²/6 of a third derivative ≤ 18, and rounding.
        let h = 1e-5;
        for i in 0..50 {
            let at = [0.3, 0.7, 1.1].map(|step| (f64::from(i) * step).sin());
            let gradient = sh_basis_gradient(at);
            for axis in 0..3 {
                let moved = |by: f64| {
                    let mut at = at;
                    at[axis] += by;
                    sh_basis(at)
                };
                let (above, below) = (moved(h), moved(-h));
                for k in 0..16 {
                    let quotient = (above[k] - below[k]) / (2.0 * h);
                    assert!((quotient - gradient[k][axis]).abs() < 1e-8, "{k} {axis}");
                }
            }
        }
    }
}
