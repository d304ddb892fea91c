//! The trained parameters by group, as flat arrays.

use trapeze_scene::Splats;

/// A group of parameters that shares a learning rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterGroup {
    /// Centres, world units.
    Positions,
    /// Natural logarithms of the standard deviations.
    LogScales,
    /// Quaternions.
    Rotations,
    /// Opacity logits.
    OpacityLogits,
    /// SH band 0.
    ShDc,
    /// SH bands 1 and up.
    ShRest,
}

impl ParameterGroup {
    /// All groups, in the order of the arrays in checkpoints.
    pub const ALL: [Self; 6] = [
        Self::Positions,
        Self::LogScales,
        Self::Rotations,
        Self::OpacityLogits,
        Self::ShDc,
        Self::ShRest,
    ];

    /// Name of the array in [`Splats`].
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Positions => "positions",
            Self::LogScales => "log_scales",
            Self::Rotations => "rotations",
            Self::OpacityLogits => "opacity_logits",
            Self::ShDc => "sh_dc",
            Self::ShRest => "sh_rest",
        }
    }

    /// The group's numbers, splat by splat.
    #[must_use]
    pub fn of(self, splats: &Splats) -> &[f32] {
        match self {
            Self::Positions => splats.positions.as_flattened(),
            Self::LogScales => splats.log_scales.as_flattened(),
            Self::Rotations => splats.rotations.as_flattened(),
            Self::OpacityLogits => &splats.opacity_logits,
            Self::ShDc => splats.sh_dc.as_flattened(),
            Self::ShRest => &splats.sh_rest,
        }
    }

    /// The group's numbers, to be changed.
    pub fn of_mut(self, splats: &mut Splats) -> &mut [f32] {
        match self {
            Self::Positions => splats.positions.as_flattened_mut(),
            Self::LogScales => splats.log_scales.as_flattened_mut(),
            Self::Rotations => splats.rotations.as_flattened_mut(),
            Self::OpacityLogits => &mut splats.opacity_logits,
            Self::ShDc => splats.sh_dc.as_flattened_mut(),
            Self::ShRest => &mut splats.sh_rest,
        }
    }
}

/// Splats whose every parameter is zero: gradients and moments have the shape of what they belong
/// to, and so the same gathers, degree changes and length checks apply.
#[must_use]
pub fn zeros_like(splats: &Splats) -> Splats {
    let n = splats.len();
    Splats {
        positions: vec![[0.0; 3]; n],
        log_scales: vec![[0.0; 3]; n],
        rotations: vec![[0.0; 4]; n],
        opacity_logits: vec![0.0; n],
        sh_dc: vec![[0.0; 3]; n],
        sh_rest: vec![0.0; splats.sh_rest.len()],
        sh_degree: splats.sh_degree,
    }
}

/// Appends a copy of splat `i` at the end.
pub(crate) fn push_copy(splats: &mut Splats, i: usize) {
    splats.positions.push(splats.positions[i]);
    splats.log_scales.push(splats.log_scales[i]);
    splats.rotations.push(splats.rotations[i]);
    splats.opacity_logits.push(splats.opacity_logits[i]);
    splats.sh_dc.push(splats.sh_dc[i]);
    let stride = splats.sh_rest_stride();
    splats.sh_rest.extend_from_within(i * stride..(i + 1) * stride);
}

/// Overwrites splat `to` with splat `from`.
pub(crate) fn copy_within(splats: &mut Splats, from: usize, to: usize) {
    splats.positions[to] = splats.positions[from];
    splats.log_scales[to] = splats.log_scales[from];
    splats.rotations[to] = splats.rotations[from];
    splats.opacity_logits[to] = splats.opacity_logits[from];
    splats.sh_dc[to] = splats.sh_dc[from];
    let stride = splats.sh_rest_stride();
    splats.sh_rest.copy_within(from * stride..(from + 1) * stride, to * stride);
}

/// Sets every parameter of splat `i` to zero.
pub(crate) fn clear(splats: &mut Splats, i: usize) {
    splats.positions[i] = [0.0; 3];
    splats.log_scales[i] = [0.0; 3];
    splats.rotations[i] = [0.0; 4];
    splats.opacity_logits[i] = 0.0;
    splats.sh_dc[i] = [0.0; 3];
    let stride = splats.sh_rest_stride();
    splats.sh_rest[i * stride..(i + 1) * stride].fill(0.0);
}

/// Appends a splat whose every parameter is zero.
pub(crate) fn push_zero(splats: &mut Splats) {
    splats.positions.push([0.0; 3]);
    splats.log_scales.push([0.0; 3]);
    splats.rotations.push([0.0; 4]);
    splats.opacity_logits.push(0.0);
    splats.sh_dc.push([0.0; 3]);
    let stride = splats.sh_rest_stride();
    splats.sh_rest.resize(splats.sh_rest.len() + stride, 0.0);
}

#[cfg(test)]
pub(crate) mod tests {
    use trapeze_scene::ShDegree;

    use super::*;
    use crate::random::{Purpose, Stream, uniform};

    /// Splats with all parameters different: positions in a cube of side 2, scales from 0.05 to
    /// 0.14, opacities from 0.02 to 0.98.
    pub(crate) fn random_splats(seed: u64, n: usize, sh_degree: ShDegree) -> Splats {
        let draw = |i: usize, part: u32| {
            Stream::new(seed, Purpose::Initialisation, 0)
                .more_words(i as u32, part)
                .map(|word| 2.0 * uniform(word) - 1.0)
        };
        let three = |part: u32| {
            move |i: usize| {
                let [a, b, c, _] = draw(i, part);
                [a, b, c]
            }
        };
        let stride = sh_degree.rest_coefficients() * 3;
        Splats {
            positions: (0..n).map(three(0)).collect(),
            log_scales: (0..n).map(|i| three(1)(i).map(|s| 0.5 * s - 2.5)).collect(),
            rotations: (0..n).map(|i| draw(i, 2)).collect(),
            opacity_logits: (0..n).map(|i| 4.0 * draw(i, 3)[0]).collect(),
            sh_dc: (0..n).map(three(4)).collect(),
            sh_rest: (0..n * stride).map(|i| draw(i, 5)[0]).collect(),
            sh_degree,
        }
    }

    #[test]
    fn the_groups_hold_every_parameter_once() {
        let mut splats = random_splats(1, 5, ShDegree::Two);
        let total: usize = ParameterGroup::ALL.iter().map(|group| group.of(&splats).len()).sum();
        assert_eq!(total, 5 * (14 + 24));
        for group in ParameterGroup::ALL {
            group.of_mut(&mut splats).fill(0.0);
        }
        assert_eq!(splats, zeros_like(&splats));
    }

    #[test]
    fn splats_are_copied_with_all_their_parameters() {
        let mut splats = random_splats(2, 4, ShDegree::One);
        let before = splats.clone();
        push_copy(&mut splats, 2);
        copy_within(&mut splats, 1, 0);
        push_zero(&mut splats);
        clear(&mut splats, 3);
        splats.validate().unwrap();
        assert_eq!(splats.gather(&[4, 0, 1, 2]), before.gather(&[2, 1, 1, 2]));
        assert_eq!(splats.gather(&[5, 3]), zeros_like(&before.gather(&[0, 0])));
    }
}
