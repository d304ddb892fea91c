//! What the host writes for the kernels of training, and the words that they write for it. A test
//! compares the structs with the WGSL.

use bytemuck::{Pod, Zeroable};
use trapeze_scene::ShDegree;

use crate::densify::{dead_logit, lowest_logit, weight_bits, weight_shift};
use crate::parameters::ParameterGroup;
use crate::random::{Purpose, Stream};
use crate::schedule::{DensifyPlan, NetworkStep, StepPlan};

/// Width and height of a tile of the loss, pixels.
pub(super) const LOSS_TILE: u32 = 16;

/// `TrainingStep` of common/training.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct TrainingStep {
    pub(super) splats: u32,
    pub(super) step: u32,
    pub(super) seed: [u32; 2],
    pub(super) background: [f32; 4],
    pub(super) image: [u32; 2],
    pub(super) tiles: [u32; 2],
    pub(super) l1_scale: f32,
    pub(super) ssim_scale: f32,
    pub(super) weighted: u32,
    pub(super) slot: u32,
    pub(super) rates: [[f32; 4]; 2],
    pub(super) beta1: f32,
    pub(super) one_minus_beta1: f32,
    pub(super) beta2: f32,
    pub(super) one_minus_beta2: f32,
    pub(super) second_correction: f32,
    pub(super) epsilon: f32,
    pub(super) opacity_pressure: f32,
    pub(super) scale_pressure: f32,
    pub(super) noise_amplitude: f32,
    pub(super) gate_steepness: f32,
    pub(super) gate_opacity: f32,
    pub(super) zero: u32,
}

impl TrainingStep {
    /// The numbers of a plan for `splats` splats and a view of `image` pixels; the report goes to
    /// `slot`.
    pub(super) fn new(
        plan: &StepPlan,
        splats: u32,
        image: [u32; 2],
        weighted: bool,
        slot: u32,
    ) -> Self {
        let [r, g, b] = plan.background;
        let values = 3.0 * f64::from(image[0]) * f64::from(image[1]);
        let lambda = f64::from(plan.ssim_weight);
        let mut rates = [[0.0; 4]; 2];
        for (i, group) in ParameterGroup::ALL.into_iter().enumerate() {
            rates[i / 4][i % 4] = (plan.rates.of(group) * plan.adam.first_correction) as f32;
        }
        let n = f64::from(splats.max(1));
        let noise = plan.noise;
        Self {
            splats,
            step: plan.step,
            seed: Stream::new(plan.seed, Purpose::PositionNoise, plan.step).key(),
            background: [r, g, b, 0.0],
            image,
            tiles: image.map(|size| size.div_ceil(LOSS_TILE)),
            l1_scale: ((1.0 - lambda) / values) as f32,
            ssim_scale: (lambda / values) as f32,
            weighted: u32::from(weighted),
            slot,
            rates,
            beta1: plan.adam.beta1,
            one_minus_beta1: plan.adam.one_minus_beta1,
            beta2: plan.adam.beta2,
            one_minus_beta2: plan.adam.one_minus_beta2,
            second_correction: plan.adam.second_correction,
            epsilon: plan.adam.epsilon,
            opacity_pressure: (plan.regularisers.opacity / n) as f32,
            scale_pressure: (plan.regularisers.scale / (3.0 * n)) as f32,
            noise_amplitude: noise.map_or(0.0, |n| (plan.rates.positions * n.scale) as f32),
            gate_steepness: noise.map_or(0.0, |n| n.gate_steepness as f32),
            gate_opacity: noise.map_or(0.0, |n| n.gate_opacity as f32),
            zero: 0,
        }
    }
}

/// The place of the network's rate among those of the groups: behind them.
pub(super) const NETWORK_GROUP: usize = ParameterGroup::ALL.len();

impl TrainingStep {
    /// What the update of a network needs, whose `parameters` are one number per splat to it; what it
    /// cannot use is counted in the report of `slot`.
    pub(super) fn of_network(step: &NetworkStep, parameters: u32, slot: u32) -> Self {
        let mut rates = [[0.0; 4]; 2];
        rates[NETWORK_GROUP / 4][NETWORK_GROUP % 4] =
            (step.rate * step.adam.first_correction) as f32;
        Self {
            splats: parameters,
            slot,
            rates,
            beta1: step.adam.beta1,
            one_minus_beta1: step.adam.one_minus_beta1,
            beta2: step.adam.beta2,
            one_minus_beta2: step.adam.one_minus_beta2,
            second_correction: step.adam.second_correction,
            epsilon: step.adam.epsilon,
            ..Self::default()
        }
    }
}

/// `Densification` of common/densification.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct Densification {
    pub(super) splats: u32,
    pub(super) count: u32,
    pub(super) seed: [u32; 2],
    pub(super) step: u32,
    pub(super) purpose: u32,
    pub(super) shift: u32,
    pub(super) even_weight: u32,
    pub(super) dead_logit: f32,
    pub(super) lowest_logit: f32,
    pub(super) padding_1: u32,
    pub(super) padding_2: u32,
}

impl Densification {
    /// The dead of `splats` splats move, after `step` steps.
    pub(super) fn relocation(plan: &DensifyPlan, splats: u32, step: u32) -> Self {
        let base = Self::new(plan, Purpose::Relocation, splats, step);
        Self { dead_logit: dead_logit(plan.dead_opacity), ..base }
    }

    /// `splats` splats become the plan's count, after `step` steps.
    pub(super) fn growth(plan: &DensifyPlan, splats: u32, step: u32) -> Self {
        let base = Self::new(plan, Purpose::Growth, splats, step);
        let even_weight = 1 << weight_bits(splats);
        Self { count: plan.count, even_weight, dead_logit: f32::MIN, ..base }
    }

    fn new(plan: &DensifyPlan, purpose: Purpose, splats: u32, step: u32) -> Self {
        Self {
            splats,
            count: splats,
            seed: Stream::new(plan.seed, purpose, step).key(),
            step,
            purpose: purpose as u32,
            shift: weight_shift(splats),
            lowest_logit: lowest_logit(plan.dead_opacity),
            ..Self::default()
        }
    }
}

/// `Strides` of restride.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct Strides {
    pub(super) before: u32,
    pub(super) after: u32,
    pub(super) total: u32,
    pub(super) padding: u32,
}

/// Numbers per splat of each group, in their order.
pub(super) fn widths(degree: ShDegree) -> [u32; 6] {
    [3, 3, 4, 1, 3, 3 * degree.rest_coefficients() as u32]
}

/// Words of the reports; see common/training.wgsl.
pub(super) mod report {
    pub(in super::super) const WORDS: u32 = 8;
    pub(in super::super) const DIFFERENCE: usize = 0;
    pub(in super::super) const DISSIMILARITY: usize = 1;
    pub(in super::super) const IMAGE_NOT_FINITE: usize = 2;
    pub(in super::super) const NOT_FINITE: usize = 3;
    pub(in super::super) const VISIBLE: usize = 4;
    pub(in super::super) const ENTRIES: usize = 5;
    pub(in super::super) const HALTED: usize = 6;
    pub(in super::super) const STEP: usize = 7;
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;
    use std::mem::offset_of;

    use trapeze_gpu::shaders::{Shader, training as shaders};

    use super::*;

    fn module(shader: Shader) -> naga::Module {
        naga::front::wgsl::parse_str(&shader.source()).unwrap()
    }

    /// Size of a struct, and the name and offset of each of its members.
    fn wgsl_layout(shader: Shader, name: &str) -> (usize, Vec<(String, usize)>) {
        let module = module(shader);
        let (_, ty) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap();
        let naga::TypeInner::Struct { members, span } = &ty.inner else { panic!("{name}") };
        let member =
            |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset as usize);
        (*span as usize, members.iter().map(member).collect())
    }

    macro_rules! assert_same_layout {
        ($shader:expr, $name:ident, $($field:ident),+ $(,)?) => {
            let ours = vec![$((stringify!($field).to_owned(), offset_of!($name, $field))),+];
            assert_eq!(wgsl_layout($shader, stringify!($name)), (size_of::<$name>(), ours));
        };
    }

    #[test]
    fn uniform_blocks_are_laid_out_as_the_kernels_read_them() {
        assert_same_layout!(
            shaders::ADAM,
            TrainingStep,
            splats,
            step,
            seed,
            background,
            image,
            tiles,
            l1_scale,
            ssim_scale,
            weighted,
            slot,
            rates,
            beta1,
            one_minus_beta1,
            beta2,
            one_minus_beta2,
            second_correction,
            epsilon,
            opacity_pressure,
            scale_pressure,
            noise_amplitude,
            gate_steepness,
            gate_opacity,
            zero,
        );
        assert_same_layout!(
            shaders::RELOCATE,
            Densification,
            splats,
            count,
            seed,
            step,
            purpose,
            shift,
            even_weight,
            dead_logit,
            lowest_logit,
            padding_1,
            padding_2,
        );
        assert_same_layout!(shaders::RESTRIDE, Strides, before, after, total, padding);
    }

    /// Constants of type u32.
    fn constants(shader: Shader) -> HashMap<String, u32> {
        let module = module(shader);
        let value = |c: &naga::Constant| match module.global_expressions[c.init] {
            naga::Expression::Literal(naga::Literal::U32(value)) => Some((c.name.clone()?, value)),
            _ => None,
        };
        module.constants.iter().filter_map(|(_, c)| value(c)).collect()
    }

    #[test]
    fn words_and_purposes_have_one_numbering() {
        let found = constants(shaders::REPORT);
        for (name, value) in [
            ("REPORT_WORDS", report::WORDS),
            ("REPORT_DIFFERENCE", report::DIFFERENCE as u32),
            ("REPORT_DISSIMILARITY", report::DISSIMILARITY as u32),
            ("REPORT_IMAGE_NOT_FINITE", report::IMAGE_NOT_FINITE as u32),
            ("REPORT_NOT_FINITE", report::NOT_FINITE as u32),
            ("REPORT_VISIBLE", report::VISIBLE as u32),
            ("REPORT_ENTRIES", report::ENTRIES as u32),
            ("REPORT_HALTED", report::HALTED as u32),
            ("REPORT_STEP", report::STEP as u32),
        ] {
            assert_eq!(found[name], value, "{name}");
        }
        let found = constants(shaders::RELOCATE);
        for (name, value) in [
            ("PURPOSE_NOISE", Purpose::PositionNoise as u32),
            ("PURPOSE_RELOCATION", Purpose::Relocation as u32),
            ("PURPOSE_GROWTH", Purpose::Growth as u32),
            ("MAX_COPIES", crate::densify::MAX_COPIES),
        ] {
            assert_eq!(found[name], value, "{name}");
        }
        assert_eq!(constants(shaders::LOSS)["TILE"], LOSS_TILE);
        let names = ParameterGroup::ALL.map(ParameterGroup::name);
        let adam = constants(shaders::ADAM);
        assert_eq!(names[adam["LOG_SCALES"] as usize], "log_scales");
        assert_eq!(names[adam["OPACITY_LOGITS"] as usize], "opacity_logits");
    }
}
