//! What happens at which step. A plan is a function of (configuration, step), nothing else: not of
//! the wall time, not of what the steps before it found.

use trapeze_scene::ShDegree;

use crate::backend::TrainingView;
use crate::config::{Background, Densification, TrainingConfig};
use crate::densify::{PositionNoise, grown_count};
use crate::optimizer::{AdamStep, Rates, Regularisers};
use crate::random::{Purpose, Stream};

/// One optimisation step, as numbers: what a kernel needs as its uniform.
#[derive(Clone, Debug, PartialEq)]
pub struct StepPlan {
    /// Number of the step, from 0. Adam counts it from 1.
    pub step: u32,
    /// Seed of the run.
    pub seed: u64,
    /// Highest SH degree that is evaluated and trained.
    pub sh_degree: ShDegree,
    /// Colour behind the splats and behind a transparent target.
    pub background: [f32; 3],
    /// λ of the loss.
    pub ssim_weight: f32,
    /// Learning rates.
    pub rates: Rates,
    /// Adam's constants.
    pub adam: AdamStep,
    /// Pressure on opacities and scales.
    pub regularisers: Regularisers,
    /// Noise of the positions after the update.
    pub noise: Option<PositionNoise>,
    /// The step of the deformation network; `None` in a static scene and while a deformable one
    /// warms up: then no network is evaluated, and none is trained.
    pub network: Option<NetworkStep>,
}

/// What a step does with the deformation network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkStep {
    /// Added to the time of the view: noise against times that are seen too exactly.
    pub time_offset: f32,
    /// Learning rate of all weights and biases.
    pub rate: f64,
    /// Adam's constants, whose steps count from the network's first one.
    pub adam: AdamStep,
}

/// A change of the set of splats between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DensifyPlan {
    /// Seed of the run.
    pub seed: u64,
    /// At most this opacity is dead, and moves.
    pub dead_opacity: f64,
    /// Number of splats afterwards.
    pub count: u32,
}

impl StepPlan {
    /// The time at which the step renders a view.
    #[must_use]
    pub fn time_of(&self, view: &TrainingView) -> f32 {
        view.time + self.network.map_or(0.0, |network| network.time_offset)
    }
}

impl TrainingConfig {
    /// The plan of step `step` in a scene of size `extent`, with all rates times `rate_factor`
    /// (1, until a run has diverged).
    #[must_use]
    pub fn step_plan(&self, step: u32, extent: f64, rate_factor: f64) -> StepPlan {
        let undisturbed = self.deformation.is_some_and(|motion| step < motion.undisturbed);
        let pressing = |value: f64| if undisturbed { 0.0 } else { value };
        StepPlan {
            step,
            seed: self.seed,
            sh_degree: self.sh_degree_at(step),
            background: self.background_at(step),
            ssim_weight: pressing(self.ssim_weight) as f32,
            rates: self.rates.at(step, self.steps, extent).scaled(rate_factor),
            adam: self.adam.at_step(step.saturating_add(1)),
            regularisers: Regularisers {
                opacity: pressing(self.regularisers.opacity),
                scale: pressing(self.regularisers.scale),
            },
            noise: self.densification.filter(|_| !undisturbed).map(|set| set.noise),
            network: self.network_step(step, rate_factor),
        }
    }

    /// What step `step` does with the deformation network, if anything.
    fn network_step(&self, step: u32, rate_factor: f64) -> Option<NetworkStep> {
        let deformation = self.deformation.as_ref()?;
        let trained = step.checked_sub(deformation.warm_up)?;
        let steps = self.steps.saturating_sub(deformation.warm_up).max(1);
        let progress = f64::from(trained.min(steps)) / f64::from(steps);
        let decay = (deformation.rate_end / deformation.rate_start).powf(progress);
        let annealed =
            (1.0 - f64::from(trained) / f64::from(deformation.noisy_steps.max(1))).max(0.0);
        let [normal, ..] = Stream::new(self.seed, Purpose::TimeNoise, step).normals(0);
        Some(NetworkStep {
            time_offset: (deformation.time_noise * annealed) as f32 * normal,
            rate: rate_factor * deformation.rate_start * decay,
            adam: self.adam.at_step(trained.saturating_add(1)),
        })
    }

    /// The change of the set after `step` steps have been taken with `splats` splats, if any.
    #[must_use]
    pub fn densify_plan(&self, step: u32, splats: u32) -> Option<DensifyPlan> {
        let densification = self.densification.as_ref()?;
        densification.is_due(step).then(|| DensifyPlan {
            seed: self.seed,
            dead_opacity: densification.dead_opacity,
            count: grown_count(splats, densification.growth, densification.max_splats),
        })
    }

    /// The SH degree of step `step`: one more every `sh_interval` steps.
    #[must_use]
    pub fn sh_degree_at(&self, step: u32) -> ShDegree {
        let grown = step.checked_div(self.sh_interval).unwrap_or(u32::MAX);
        ShDegree::try_from(grown.min(self.sh_degree)).unwrap_or(ShDegree::Three)
    }

    /// The background of step `step`.
    #[must_use]
    pub fn background_at(&self, step: u32) -> [f32; 3] {
        match self.background {
            Background::Fixed(color) => color,
            Background::Random => {
                let [r, g, b, _] = Stream::new(self.seed, Purpose::Background, step).uniforms(0);
                [r, g, b]
            }
        }
    }
}

impl Densification {
    /// Whether the set changes before step `step`.
    pub(crate) fn is_due(&self, step: u32) -> bool {
        step >= self.start && step < self.stop && step > 0 && step.is_multiple_of(self.interval)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::DeformationTraining;

    #[test]
    fn the_sh_degree_grows_one_band_at_a_time() {
        let config = TrainingConfig { sh_degree: 2, sh_interval: 100, ..TrainingConfig::default() };
        let degrees: Vec<u32> =
            [0, 99, 100, 199, 200, 5000].map(|step| config.sh_degree_at(step) as u32).to_vec();
        assert_eq!(degrees, [0, 0, 1, 1, 2, 2]);
        let at_once = TrainingConfig { sh_interval: 0, ..config };
        assert_eq!(at_once.sh_degree_at(0), ShDegree::Two);
    }

    #[test]
    fn the_set_changes_every_interval_between_start_and_stop_up_to_the_cap() {
        let config = TrainingConfig::growing(3000, 12_000);
        let mut count = 10_000;
        let mut changes = Vec::new();
        for step in 0..3000 {
            if let Some(plan) = config.densify_plan(step, count) {
                count = plan.count;
                changes.push((step, count));
            }
        }
        assert_eq!(changes[..4], [(500, 10_500), (600, 11_025), (700, 11_576), (800, 12_000)]);
        assert_eq!(changes.last(), Some(&(2400, 12_000)));
        assert!(TrainingConfig::fixed(3000).densify_plan(500, 10).is_none());
    }

    #[test]
    fn random_backgrounds_differ_by_step_and_are_reproducible() {
        let config = TrainingConfig { background: Background::Random, ..TrainingConfig::fixed(10) };
        assert_eq!(config.background_at(3), config.background_at(3));
        assert_ne!(config.background_at(3), config.background_at(4));
        assert!(config.background_at(3).iter().all(|c| (0.0..1.0).contains(c)));
    }

    #[test]
    fn the_network_rests_while_warming_up_and_then_learns_at_a_falling_rate() {
        let deformation = DeformationTraining { warm_up: 100, ..DeformationTraining::default() };
        let config =
            TrainingConfig { deformation: Some(deformation), ..TrainingConfig::fixed(1_100) };
        assert_eq!(config.step_plan(99, 1.0, 1.0).network, None);
        let at = |step| config.step_plan(step, 1.0, 1.0).network.unwrap();
        assert_eq!((at(100).rate, at(100).adam), (deformation.rate_start, config.adam.at_step(1)));
        assert!((at(1_100).rate / deformation.rate_end - 1.0).abs() < 1e-12);
        let middle = (deformation.rate_start * deformation.rate_end).sqrt();
        assert!((at(600).rate / middle - 1.0).abs() < 1e-12);
        let slower = config.step_plan(600, 1.0, 0.5).network.unwrap();
        assert_eq!(slower.rate, 0.5 * at(600).rate);
        assert_eq!(TrainingConfig::fixed(10).step_plan(5, 1.0, 1.0).network, None);
    }

    #[test]
    fn at_first_nothing_but_the_photographs_acts_on_what_moves() {
        let deformation =
            DeformationTraining { undisturbed: 100, ..DeformationTraining::default() };
        let moving =
            TrainingConfig { deformation: Some(deformation), ..TrainingConfig::growing(1_000, 10) };
        let early = moving.step_plan(99, 1.0, 1.0);
        assert_eq!((early.ssim_weight, early.noise), (0.0, None));
        assert_eq!(early.regularisers, Regularisers { opacity: 0.0, scale: 0.0 });
        let usual = TrainingConfig::growing(1_000, 10);
        for (config, step) in [(&moving, 100), (&usual, 99)] {
            let plan = config.step_plan(step, 1.0, 1.0);
            assert_eq!(plan.ssim_weight, usual.ssim_weight as f32);
            assert_eq!(plan.noise, usual.densification.map(|set| set.noise));
            assert_eq!(plan.regularisers, usual.regularisers);
        }
    }

    #[test]
    fn the_noise_of_time_is_reproducible_and_fades() {
        let noisy = |time_noise| DeformationTraining {
            warm_up: 10,
            time_noise,
            noisy_steps: 1_000,
            ..DeformationTraining::default()
        };
        let offsets = |time_noise| {
            let deformation = Some(noisy(time_noise));
            let config = TrainingConfig { deformation, ..TrainingConfig::fixed(2_000) };
            move |step| config.step_plan(step, 1.0, 1.0).network.unwrap().time_offset
        };
        let at = offsets(0.01);
        assert_eq!(at(20).to_bits(), at(20).to_bits());
        let mean = |range: std::ops::Range<u32>| {
            let n = f64::from(range.len() as u32);
            range.map(|step| f64::from(at(step).abs())).sum::<f64>() / n
        };
        // The mean of |normal| is √(2/π) = 0.80, its deviation over 100 draws 0.06.
        assert!((0.5..1.1).contains(&(mean(10..110) / 0.0095)));
        assert!((0.5..1.1).contains(&(mean(810..910) / 0.0015)));
        assert_eq!(mean(1_010..1_100), 0.0);
        assert_eq!(offsets(0.0)(20), 0.0);
    }

    #[test]
    fn a_lowered_rate_lowers_every_group() {
        let config = TrainingConfig::fixed(100);
        let (full, half) = (config.step_plan(7, 2.0, 1.0), config.step_plan(7, 2.0, 0.5));
        assert_eq!(half.rates, full.rates.scaled(0.5));
        assert_eq!(half.adam, full.adam);
    }
}
