//! The network in half precision: when it may be used, and whether it tells the truth.

use super::weights::PackedWeights;
use crate::Gpu;
use crate::layout::Pose;

/// Splats per workgroup of deform_matrix.wgsl.
pub(super) const MATRIX_SPLATS: u32 = 64;
/// Width of the hidden layers that it is written for.
const MATRIX_WIDTH: usize = 256;
/// Columns that it has for γ(xyz).
const MATRIX_INPUTS: usize = 256;

/// Whether device and network suit the kernel on cooperative matrices.
pub(super) fn fits(gpu: &Gpu, packed: &PackedWeights) -> bool {
    gpu.has_matrices() && packed.width == MATRIX_WIDTH && packed.input_rows <= MATRIX_INPUTS
}

/// Whether kernels may use 16-bit floats.
pub(super) fn has_halves(gpu: &Gpu) -> bool {
    gpu.features().contains(wgpu::Features::SHADER_F16)
}

/// Weights in half precision; those that a half cannot hold are refused.
pub(super) fn half_weights(packed: &PackedWeights) -> Option<Vec<u16>> {
    let halves: Vec<::half::f16> =
        packed.weights.iter().map(|&weight| ::half::f16::from_f32(weight)).collect();
    halves
        .iter()
        .all(|weight| weight.is_finite())
        .then(|| halves.iter().map(|weight| weight.to_bits()).collect())
}

/// Largest share of the motion itself by which the half-precision network may miss it (root mean
/// square over the splats). Rounding to 11 bits gives about 10⁻³; a wrong layout of a matrix gives
/// about 1.
const MAX_RELATIVE_ERROR: f64 = 0.02;

/// Whether the poses of a half-precision kernel are those of the plain kernel, up to rounding.
pub(super) fn agrees(canonical: &[Pose], plain: &[Pose], matrix: &[Pose]) -> bool {
    let mut motion = 0.0;
    let mut error = 0.0;
    for ((canonical, plain), matrix) in canonical.iter().zip(plain).zip(matrix) {
        for c in 0..3 {
            let square = |a: f32, b: f32| (f64::from(a) - f64::from(b)).powi(2);
            motion += square(plain.position[c], canonical.position[c])
                + square(plain.scale[c], canonical.scale[c])
                + square(plain.rotation[c], canonical.rotation[c]);
            error += square(plain.position[c], matrix.position[c])
                + square(plain.scale[c], matrix.scale[c])
                + square(plain.rotation[c], matrix.rotation[c]);
        }
    }
    // False for NaN.
    error <= MAX_RELATIVE_ERROR * MAX_RELATIVE_ERROR * motion
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(x: f32) -> Pose {
        Pose { position: [x, 0.0, 0.0], scale: [1.0; 3], ..Pose::default() }
    }

    #[test]
    fn rounding_passes_and_nonsense_does_not() {
        let canonical = vec![pose(0.0); 100];
        let plain = vec![pose(0.5); 100];
        assert!(agrees(&canonical, &plain, &vec![pose(0.5005); 100]));
        assert!(!agrees(&canonical, &plain, &vec![pose(0.4); 100]));
        assert!(!agrees(&canonical, &plain, &vec![pose(f32::NAN); 100]));
    }
}
