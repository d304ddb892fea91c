//! Colours of splats.

use trapeze_scene::{
    ColorSource, SH_C0, SH_C1, SH_C2, SH_C3, Scene, ShDegree, depth_grey, motion_heat,
};

/// Largest value of a colour channel: that of a half float. HDR-bright harmonics stay bright and a
/// sum over a pixel cannot overflow; infinite coefficients end here, NaN ones at 0.
pub const MAX_CHANNEL: f32 = 65_504.0;

/// Shown for clusters where the scene has none.
const NO_CLUSTER_COLOR: [f32; 3] = [0.5; 3];

/// Percentile of the motion values that is white in the heat map: the few fastest splats would
/// otherwise leave the rest black.
const HEAT_PERCENTILE: f32 = 99.0;

/// The motion value that is drawn white; 1 for a scene in which nothing moves.
#[must_use]
pub fn motion_reference(scene: &Scene) -> f32 {
    let value = scene.motion.as_ref().map_or(0.0, |m| m.threshold_at_percentile(HEAT_PERCENTILE));
    if value > 0.0 && value.is_finite() { value } else { 1.0 }
}

/// Colour of splat `i`, whose depth is `depth`, where it does not depend on the direction: cluster
/// colour, motion heat, or depth.
#[must_use]
pub fn flat_color(
    scene: &Scene,
    source: ColorSource,
    i: usize,
    motion_reference: f32,
    depth: f32,
) -> [f32; 3] {
    match source {
        ColorSource::Depth(range) => [depth_grey(depth, range); 3],
        ColorSource::Motion => {
            let value = scene.motion.as_ref().map_or(0.0, |motion| motion.values[i]);
            motion_heat(value / motion_reference)
        }
        ColorSource::Clusters | ColorSource::SphericalHarmonics => scene
            .clusters
            .as_ref()
            .map_or(NO_CLUSTER_COLOR, |c| c.table[c.labels[i] as usize].color.map(limit_channel)),
    }
}

/// max(0, x) limited to [`MAX_CHANNEL`]; NaN gives 0.
#[must_use]
pub fn limit_channel(x: f32) -> f32 {
    x.max(0.0).min(MAX_CHANNEL)
}

/// The SH constants in single precision.
const C0: f32 = SH_C0 as f32;
pub(crate) const C1: f32 = SH_C1 as f32;
pub(crate) const C2: [f32; 5] = narrowed(SH_C2);
pub(crate) const C3: [f32; 7] = narrowed(SH_C3);

const fn narrowed<const N: usize>(values: [f64; N]) -> [f32; N] {
    let mut out = [0.0; N];
    let mut i = 0;
    while i < N {
        out[i] = values[i] as f32;
        i += 1;
    }
    out
}

/// The SH basis of bands 0…degree at a unit direction, in single precision; entries above the
/// degree are zero.
#[must_use]
#[inline(always)]
pub fn sh_basis_f32([x, y, z]: [f32; 3], degree: ShDegree) -> [f32; 16] {
    let mut basis = [0.0; 16];
    basis[0] = C0;
    if degree == ShDegree::Zero {
        return basis;
    }
    basis[1] = -C1 * y;
    basis[2] = C1 * z;
    basis[3] = -C1 * x;
    if degree == ShDegree::One {
        return basis;
    }
    let (xx, yy, zz) = (x * x, y * y, z * z);
    basis[4] = C2[0] * x * y;
    basis[5] = C2[1] * y * z;
    basis[6] = C2[2] * (2.0 * zz - xx - yy);
    basis[7] = C2[3] * x * z;
    basis[8] = C2[4] * (xx - yy);
    if degree == ShDegree::Two {
        return basis;
    }
    basis[9] = C3[0] * y * (3.0 * xx - yy);
    basis[10] = C3[1] * x * y * z;
    basis[11] = C3[2] * y * (4.0 * zz - xx - yy);
    basis[12] = C3[3] * z * (2.0 * zz - 3.0 * xx - 3.0 * yy);
    basis[13] = C3[4] * x * (4.0 * zz - xx - yy);
    basis[14] = C3[5] * z * (xx - yy);
    basis[15] = C3[6] * x * (xx - 3.0 * yy);
    basis
}

/// 0.5 + Σ cₖ Yₖ over the bands of `basis` that `rest` has, before the clamp.
#[must_use]
#[inline(always)]
pub fn sh_color(basis: &[f32; 16], dc: [f32; 3], rest: &[f32]) -> [f32; 3] {
    let mut color = dc.map(|c| 0.5 + basis[0] * c);
    for (coefficients, &b) in rest.chunks_exact(3).zip(&basis[1..]) {
        for channel in 0..3 {
            color[channel] += b * coefficients[channel];
        }
    }
    color
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_single_precision_basis_follows_the_specification() {
        for i in 0..1000 {
            let (theta, phi) = (f64::from(i) * 0.7, f64::from(i) * 1.3);
            let d = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
            let exact = trapeze_scene::sh_basis(d);
            let ours = sh_basis_f32(d.map(|v| v as f32), ShDegree::Three);
            // Cubic polynomials of values ≤ 1 with coefficients ≤ 2.9: a few rounding steps each.
            for (a, b) in ours.iter().zip(exact) {
                assert!((f64::from(*a) - b).abs() < 2e-6, "{a} {b}");
            }
        }
    }

    #[test]
    fn a_limited_degree_leaves_out_higher_bands_only() {
        let d = [0.36, 0.48, 0.8];
        let full = sh_basis_f32(d, ShDegree::Three);
        for degree in ShDegree::ALL {
            let basis = sh_basis_f32(d, degree);
            let (kept, cut) = basis.split_at(degree.coefficients());
            assert_eq!(kept, &full[..kept.len()]);
            assert!(cut.iter().all(|&b| b == 0.0));
        }
    }

    #[test]
    fn channels_are_limited_whatever_the_coefficients() {
        assert_eq!(limit_channel(f32::NAN), 0.0);
        assert_eq!(limit_channel(f32::NEG_INFINITY), 0.0);
        assert_eq!(limit_channel(f32::INFINITY), MAX_CHANNEL);
        assert_eq!(limit_channel(3.5), 3.5);
    }
}
