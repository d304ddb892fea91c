//! What happens at which step. A plan is a function of (configuration, step), nothing else: not of
//! the wall time, not of what the steps before it found.

use trapeze_scene::ShDegree;

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

impl TrainingConfig {
    /// The plan of step `step` in a scene of size `extent`, with all rates times `rate_factor`
    /// (1, until a run has diverged).
    #[must_use]
    pub fn step_plan(&self, step: u32, extent: f64, rate_factor: f64) -> StepPlan {
        StepPlan {
            step,
            seed: self.seed,
            sh_degree: self.sh_degree_at(step),
            background: self.background_at(step),
            ssim_weight: self.ssim_weight as f32,
            rates: self.rates.at(step, self.steps, extent).scaled(rate_factor),
            adam: self.adam.at_step(step.saturating_add(1)),
            regularisers: self.regularisers,
            noise: self.densification.map(|densification| densification.noise),
        }
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
    fn is_due(&self, step: u32) -> bool {
        step >= self.start && step < self.stop && step > 0 && step.is_multiple_of(self.interval)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_lowered_rate_lowers_every_group() {
        let config = TrainingConfig::fixed(100);
        let (full, half) = (config.step_plan(7, 2.0, 1.0), config.step_plan(7, 2.0, 0.5));
        assert_eq!(half.rates, full.rates.scaled(0.5));
        assert_eq!(half.adam, full.adam);
    }
}
