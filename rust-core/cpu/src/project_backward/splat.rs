//! The backward pass of one splat's projection.

use trapeze_scene::{Camera, ShDegree};

use super::color::basis_backward;
use super::ellipse::{EllipseGradient, ellipse_backward};
use crate::deform::SplatPose;
use crate::project::{
    MAX_CHANNEL, ProjectedSplat, View, direction, multiply, rotation_matrix, sh_basis_f32, sh_color,
};
use crate::rasterize_backward::SplatSums;

/// The camera as the forward pass saw it, and how colours came about.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BackwardView {
    view: View,
    /// Degree that was evaluated; `None` when colours did not come from harmonics.
    degree: Option<ShDegree>,
}

impl BackwardView {
    /// `camera` is relative to the scene's origin.
    pub(crate) fn new(camera: &Camera, degree: Option<ShDegree>) -> Self {
        Self { view: View::new(camera), degree }
    }
}

/// What the forward pass was given of one splat.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SplatInput<'a> {
    pub pose: SplatPose,
    pub sh_dc: [f32; 3],
    pub sh_rest: &'a [f32],
}

/// ∂L/∂ what the forward pass was given of one splat; SH bands above 0 go to a slice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct VisibleGradient {
    pub position: [f32; 3],
    pub rotation: [f32; 4],
    pub scale: [f32; 3],
    /// By log₂ of the opacity.
    pub log2_opacity: f32,
    pub sh_dc: [f32; 3],
}

/// Gradient of a splat that was drawn. `sh_rest` gets its higher bands, and is left alone where
/// they were not evaluated.
///
/// The plain twin of this function is `Projection::project_backward` of the f64 reference.
#[inline(always)]
pub(crate) fn project_backward(
    view: &BackwardView,
    input: &SplatInput<'_>,
    projected: &ProjectedSplat,
    sums: &SplatSums,
    sh_rest: &mut [f32],
) -> VisibleGradient {
    let offset = view.view.offset(input.pose.position);
    let mut gradient = geometry_backward(&view.view, &input.pose, offset, projected, sums);
    gradient.log2_opacity = std::f32::consts::LN_2 * sums.q;
    if let Some(degree) = view.degree {
        let (sh_dc, by_offset) = color_backward(degree, input, offset, sums.color, sh_rest);
        gradient.sh_dc = sh_dc;
        for (position, by_offset) in gradient.position.iter_mut().zip(by_offset) {
            *position += by_offset;
        }
    }
    gradient
}

#[inline(always)]
fn geometry_backward(
    view: &View,
    pose: &SplatPose,
    offset: [f32; 3],
    projected: &ProjectedSplat,
    sums: &SplatSums,
) -> VisibleGradient {
    let w = &view.rotation;
    let p = multiply(w, offset);
    let inverse_z = 1.0 / p[2];
    let slope = [p[0] * inverse_z, p[1] * inverse_z];
    let rotation = rotation_matrix(pose.rotation);
    // t: the rows of J W; M = t R S.
    let limited: [f32; 2] = std::array::from_fn(|axis| view.limited_slope(axis, slope[axis]));
    let t: [[f32; 3]; 2] =
        std::array::from_fn(|axis| view.jacobian_row(axis, limited[axis], inverse_z));
    let t_local = t.map(|t| transposed_multiply(&rotation, t));
    let m = t_local.map(|t| std::array::from_fn(|c| t[c] * pose.scale[c]));
    let EllipseGradient { centre, mx, my } = ellipse_backward(projected, m[0], m[1], sums);
    let by_m = [mx, my];

    // By S, and by R S where S is taken into the rows of M.
    let scale = std::array::from_fn(|c| by_m[0][c] * t_local[0][c] + by_m[1][c] * t_local[1][c]);
    let scaled = by_m.map(|by_m| std::array::from_fn(|c| by_m[c] * pose.scale[c]));
    let by_rotation: [[f32; 3]; 3] = std::array::from_fn(|r| {
        std::array::from_fn(|c| t[0][r] * scaled[0][c] + t[1][r] * scaled[1][c])
    });

    let mut by_p = [0.0; 3];
    let mut by_z = sums.depth;
    for axis in 0..2 {
        // t = f/z (w_axis − limited·w_z).
        let by_t = multiply(&rotation, scaled[axis]);
        let gain = view.focal[axis] * inverse_z;
        let by_limited = -gain * dot(by_t, w[2]);
        let is_free = slope[axis] > view.slope_min[axis] && slope[axis] < view.slope_max[axis];
        let by_slope = view.focal[axis] * centre[axis] + if is_free { by_limited } else { 0.0 };
        by_p[axis] = by_slope * inverse_z;
        by_z -= (dot(by_t, t[axis]) + by_slope * slope[axis]) * inverse_z;
    }
    by_p[2] = by_z;
    VisibleGradient {
        position: transposed_multiply(w, by_p),
        rotation: rotation_matrix_backward(pose.rotation, &by_rotation),
        scale,
        ..VisibleGradient::default()
    }
}

/// By the coefficients of band 0 and the vector from the eye; higher bands go to `sh_rest`.
#[inline(always)]
fn color_backward(
    degree: ShDegree,
    input: &SplatInput<'_>,
    offset: [f32; 3],
    by_color: [f32; 3],
    sh_rest: &mut [f32],
) -> ([f32; 3], [f32; 3]) {
    let unit = direction(offset);
    let basis = sh_basis_f32(unit, degree);
    let evaluated = degree.rest_coefficients() * 3;
    let coefficients = &input.sh_rest[..evaluated];
    // Channels at their limits do not move. One that is free has finite coefficients, the others'
    // may be anything.
    let free =
        sh_color(&basis, input.sh_dc, coefficients).map(|value| value > 0.0 && value < MAX_CHANNEL);
    let mut by_basis = [0.0; 16];
    let rest = sh_rest[..evaluated].chunks_exact_mut(3).zip(coefficients.chunks_exact(3));
    for (k, (out, coefficients)) in (1..).zip(rest) {
        for c in (0..3).filter(|&c| free[c]) {
            out[c] = by_color[c] * basis[k];
            by_basis[k] += by_color[c] * coefficients[c];
        }
    }
    let by_unit = basis_backward(unit, degree, &by_basis);
    let along = dot(unit, by_unit);
    let length = dot(offset, unit);
    let by_offset = if length > 0.0 && length.is_finite() {
        std::array::from_fn(|c| (by_unit[c] - along * unit[c]) / length)
    } else {
        [0.0; 3]
    };
    (std::array::from_fn(|c| if free[c] { by_color[c] * basis[0] } else { 0.0 }), by_offset)
}

/// ∂L/∂(w, x, y, z) from ∂L/∂(row-major entries of the rotation matrix).
#[inline(always)]
fn rotation_matrix_backward([w, x, y, z]: [f32; 4], g: &[[f32; 3]; 3]) -> [f32; 4] {
    let turn = [g[2][1] - g[1][2], g[0][2] - g[2][0], g[1][0] - g[0][1]];
    let shear = [g[2][1] + g[1][2], g[0][2] + g[2][0], g[1][0] + g[0][1]];
    [
        2.0 * (x * turn[0] + y * turn[1] + z * turn[2]),
        2.0 * (y * shear[2] + z * shear[1] + w * turn[0] - 2.0 * x * (g[1][1] + g[2][2])),
        2.0 * (x * shear[2] + z * shear[0] + w * turn[1] - 2.0 * y * (g[0][0] + g[2][2])),
        2.0 * (x * shear[1] + y * shear[0] + w * turn[2] - 2.0 * z * (g[0][0] + g[1][1])),
    ]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// mᵀ v.
#[inline(always)]
fn transposed_multiply(m: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|c| m[0][c] * v[0] + m[1][c] * v[1] + m[2][c] * v[2])
}
