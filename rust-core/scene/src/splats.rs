//! Splats as a structure of arrays, in the parameters in which they are stored and trained.

use crate::{SceneError, ShDegree};

/// Gaussian splats, one entry per splat in every array.
///
/// The values are the *file* parameters (Kerbl et al. 2023, "3D Gaussian Splatting"): logarithms,
/// logits and unnormalised quaternions. Activations are applied once, by the stage that needs them.
///
/// | field | shape | unit |
/// |---|---|---|
/// | `positions` | n × 3 | world units, relative to [`Scene::origin`](crate::Scene::origin) |
/// | `log_scales` | n × 3 | natural log of the standard deviation along each local axis |
/// | `rotations` | n × 4 | quaternion (w, x, y, z), any length |
/// | `opacity_logits` | n | logit of the opacity |
/// | `sh_dc` | n × 3 | SH coefficient of band 0, r g b |
/// | `sh_rest` | n × (k − 1) × 3 | SH bands 1…degree, per splat: coefficient-major, r g b innermost |
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Splats {
    /// Centres, relative to the scene's origin.
    pub positions: Vec<[f32; 3]>,
    /// Natural logarithms of the standard deviations.
    pub log_scales: Vec<[f32; 3]>,
    /// Quaternions (w, x, y, z), not necessarily of unit length.
    pub rotations: Vec<[f32; 4]>,
    /// Opacities before the logistic function.
    pub opacity_logits: Vec<f32>,
    /// Band 0 of the spherical harmonics, r g b.
    pub sh_dc: Vec<[f32; 3]>,
    /// Bands 1…degree: `sh_rest[(i * (k - 1) + j) * 3 + channel]` is coefficient `j + 1` of splat `i`.
    pub sh_rest: Vec<f32>,
    /// SH degree of `sh_rest`.
    pub sh_degree: ShDegree,
}

impl Splats {
    /// Number of splats.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no splats.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Floats of `sh_rest` per splat: 0, 9, 24 or 45.
    #[must_use]
    pub fn sh_rest_stride(&self) -> usize {
        self.sh_degree.rest_coefficients() * 3
    }

    /// The higher SH bands of splat `i`, coefficient-major, r g b innermost.
    #[must_use]
    pub fn sh_rest_of(&self, i: usize) -> &[f32] {
        let stride = self.sh_rest_stride();
        &self.sh_rest[i * stride..(i + 1) * stride]
    }

    /// Checks that all arrays describe the same number of splats.
    ///
    /// # Errors
    /// [`SceneError::Length`] names the first array whose length does not match `positions`.
    pub fn validate(&self) -> Result<(), SceneError> {
        let n = self.len();
        let lengths = [
            ("log_scales", self.log_scales.len(), n),
            ("rotations", self.rotations.len(), n),
            ("opacity_logits", self.opacity_logits.len(), n),
            ("sh_dc", self.sh_dc.len(), n),
            ("sh_rest", self.sh_rest.len(), n * self.sh_rest_stride()),
        ];
        for (field, found, expected) in lengths {
            if found != expected {
                return Err(SceneError::Length { field, expected, found });
            }
        }
        if n > u32::MAX as usize {
            return Err(SceneError::TooManySplats { found: n });
        }
        Ok(())
    }

    /// A copy of the splats at `indices`, in that order.
    ///
    /// # Panics
    /// When an index is out of range.
    #[must_use]
    pub fn gather(&self, indices: &[u32]) -> Self {
        let stride = self.sh_rest_stride();
        let mut sh_rest = Vec::with_capacity(indices.len() * stride);
        for &i in indices {
            sh_rest.extend_from_slice(self.sh_rest_of(i as usize));
        }
        Self {
            positions: gather(&self.positions, indices),
            log_scales: gather(&self.log_scales, indices),
            rotations: gather(&self.rotations, indices),
            opacity_logits: gather(&self.opacity_logits, indices),
            sh_dc: gather(&self.sh_dc, indices),
            sh_rest,
            sh_degree: self.sh_degree,
        }
    }

    /// The splats that can be drawn, ascending: α is at most the opacity, and below 1/255 it is skipped in
    /// every pixel. What rounding could lift to 1/255 is among them: renderers compare log₂ of the opacity
    /// in single precision, whose last place at 8 is 7e-7 of the opacity.
    #[must_use]
    pub fn drawable(&self) -> Vec<u32> {
        const LEAST_OPACITY: f64 = (1.0 - 1e-5) / 255.0;
        let logits = (0..).zip(&self.opacity_logits);
        logits
            .filter(|&(_, &logit)| sigmoid(f64::from(logit)) >= LEAST_OPACITY)
            .map(|(i, _)| i)
            .collect()
    }

    /// The smallest degree that holds every non-zero coefficient: bands that are all zero cost
    /// memory and time in every frame and show nothing.
    #[must_use]
    pub fn used_sh_degree(&self) -> ShDegree {
        let stride = self.sh_rest_stride();
        if stride == 0 {
            return ShDegree::Zero;
        }
        let mut used = 0;
        for rest in self.sh_rest.chunks_exact(stride) {
            // `!=` keeps NaN coefficients: they are present, and the renderer has to face them.
            if let Some(last) = rest.iter().rposition(|&c| c != 0.0) {
                used = used.max(last / 3 + 1);
            }
            if used == stride / 3 {
                break;
            }
        }
        ShDegree::ALL.into_iter().find(|d| d.rest_coefficients() >= used).unwrap_or(self.sh_degree)
    }

    /// Changes the degree: higher bands are cut off, missing ones become zero.
    #[must_use]
    pub fn with_sh_degree(mut self, degree: ShDegree) -> Self {
        if degree == self.sh_degree {
            return self;
        }
        let (from, to) = (self.sh_rest_stride(), degree.rest_coefficients() * 3);
        let kept = from.min(to);
        let mut sh_rest = vec![0.0; self.len() * to];
        for i in 0..self.len() {
            sh_rest[i * to..i * to + kept]
                .copy_from_slice(&self.sh_rest[i * from..i * from + kept]);
        }
        self.sh_rest = sh_rest;
        self.sh_degree = degree;
        self
    }
}

/// Copies the elements at `indices`.
pub(crate) fn gather<T: Copy>(source: &[T], indices: &[u32]) -> Vec<T> {
    indices.iter().map(|&i| source[i as usize]).collect()
}

/// The logistic function 1 / (1 + e⁻ˣ) without overflow; NaN gives 0, an invisible splat.
#[must_use]
pub fn sigmoid(logit: f64) -> f64 {
    if logit.is_nan() {
        0.0
    } else if logit >= 0.0 {
        1.0 / (1.0 + (-logit).exp())
    } else {
        let e = logit.exp();
        e / (1.0 + e)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_splats(degree: ShDegree) -> Splats {
        let k = degree.rest_coefficients() * 3;
        Splats {
            positions: vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
            log_scales: vec![[0.0; 3]; 2],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; 2],
            opacity_logits: vec![0.5, -0.5],
            sh_dc: vec![[0.1; 3], [0.2; 3]],
            sh_rest: (0..2 * k).map(|i| i as f32 + 1.0).collect(),
            sh_degree: degree,
        }
    }

    #[test]
    fn what_no_pixel_shows_is_not_drawable() {
        let logit = |opacity: f64| (opacity / (1.0 - opacity)).ln() as f32;
        let logits = [0.0, logit(0.9 / 255.0), logit(1.0 / 255.0), f32::NAN, f32::NEG_INFINITY];
        let splats = Splats { opacity_logits: logits.to_vec(), ..Splats::default() };
        assert_eq!(splats.drawable(), [0, 2]);
    }

    #[test]
    fn gather_keeps_every_attribute_of_a_splat_together() {
        let splats = two_splats(ShDegree::Two);
        let picked = splats.gather(&[1, 0, 1]);
        assert!(picked.validate().is_ok());
        assert_eq!(picked.positions[0], splats.positions[1]);
        assert_eq!(picked.sh_rest_of(2), splats.sh_rest_of(1));
        assert_eq!(picked.opacity_logits, [-0.5, 0.5, -0.5]);
    }

    #[test]
    fn a_short_array_is_refused_by_name() {
        let mut splats = two_splats(ShDegree::One);
        splats.sh_rest.pop();
        let error = splats.validate().unwrap_err();
        assert!(error.to_string().contains("sh_rest"), "{error}");
    }

    #[test]
    fn used_degree_ignores_bands_that_are_zero() {
        let mut splats = two_splats(ShDegree::Three);
        splats.sh_rest.fill(0.0);
        assert_eq!(splats.used_sh_degree(), ShDegree::Zero);
        splats.sh_rest[45 + 8 * 3 - 1] = 1e-9;
        assert_eq!(splats.used_sh_degree(), ShDegree::Two);
    }

    #[test]
    fn changing_the_degree_keeps_the_lower_bands() {
        let splats = two_splats(ShDegree::One);
        let raised = splats.clone().with_sh_degree(ShDegree::Three);
        assert_eq!(&raised.sh_rest_of(1)[..9], splats.sh_rest_of(1));
        assert_eq!(raised.with_sh_degree(ShDegree::One), splats);
    }

    #[test]
    fn sigmoid_has_limits_where_the_naive_form_overflows() {
        assert_eq!(sigmoid(1e4), 1.0);
        assert_eq!(sigmoid(-1e4), 0.0);
        assert_eq!(sigmoid(f64::INFINITY), 1.0);
        assert_eq!(sigmoid(f64::NEG_INFINITY), 0.0);
        assert_eq!(sigmoid(f64::NAN), 0.0);
        assert!((sigmoid(0.3) + sigmoid(-0.3) - 1.0).abs() < 1e-15);
    }
}
