//! Everything that decides how a run goes, as one serialisable value.

mod validation;

pub use validation::ConfigError;

use serde::{Deserialize, Serialize};
use trapeze_scene::ShDegree;

use crate::densify::PositionNoise;
use crate::optimizer::{AdamConstants, RateSchedule, Regularisers};

/// What is behind the splats while training.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Background {
    /// One colour.
    Fixed([f32; 3]),
    /// Another uniform colour at every step, so that no splat can stand in for the background.
    Random,
}

/// How the first splats look.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InitialSplats {
    /// Opacity of every splat.
    pub opacity: f64,
    /// Standard deviation, as a multiple of the mean distance to the nearest neighbours.
    pub scale: f64,
    /// Number of random splats for datasets without points, at least 1.
    pub random_count: u32,
}

impl Default for InitialSplats {
    /// Kerbl et al. 2023.
    fn default() -> Self {
        Self { opacity: 0.1, scale: 1.0, random_count: 10_000 }
    }
}

/// When and how the set of splats changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Densification {
    /// Hard cap on the number of splats; of more initial points this many are taken.
    pub max_splats: u32,
    /// Steps between two changes.
    pub interval: u32,
    /// The first step that may change the set.
    pub start: u32,
    /// From this step on the set stays as it is.
    pub stop: u32,
    /// Growth at each change, as a share of the splats.
    pub growth: f64,
    /// At most this opacity is dead.
    pub dead_opacity: f64,
    /// Exploration.
    pub noise: PositionNoise,
}

impl Default for Densification {
    /// Kheradmand et al. 2024, for a run of 30 000 steps.
    fn default() -> Self {
        Self {
            max_splats: 1_000_000,
            interval: 100,
            start: 500,
            stop: 25_000,
            growth: 0.05,
            dead_opacity: 0.005,
            noise: PositionNoise::default(),
        }
    }
}

/// How the network of a scene that moves is trained.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DeformationTraining {
    /// Steps before the first of the network: the splats find their places as if nothing moved.
    pub warm_up: u32,
    /// Learning rate of the network at its first step.
    pub rate_start: f64,
    /// And at its last; in between it falls exponentially.
    pub rate_end: f64,
    /// Standard deviation of the noise of the time at the network's first step, in the time of the
    /// scene (0 to 1).
    pub time_noise: f64,
    /// Steps of the network after which that noise has faded, linearly.
    pub noisy_steps: u32,
    /// The first step in which splats may rest: see [`rest`](crate::rest).
    pub rest_from: u32,
    /// How far a splat may be seen to move that rests, pixels; 0 lets none rest.
    pub rest_within: f64,
    /// Steps in which nothing but the difference to the photographs acts on the splats: no pressure
    /// on opacities and scales, no noise, no SSIM.
    pub undisturbed: u32,
}

impl Default for DeformationTraining {
    /// Yang et al. 2023 for synthetic scenes, whose times are exact: no noise. But for two numbers. In
    /// their warm-up of 3 000 steps what moves would be gone. And their rate falls to 1.6e-6 over
    /// 40 000 steps; a run of half their length that falls as deep ends before what turns has found
    /// its pose (docs/negative-results.md).
    fn default() -> Self {
        Self {
            warm_up: 300,
            rate_start: 8e-4,
            rate_end: 3e-5,
            time_noise: 0.0,
            noisy_steps: 20_000,
            rest_from: 10_000,
            rest_within: 0.5,
            undisturbed: 3_000,
        }
    }
}

/// How the number of splats and the SH degree are found where nobody states them: see
/// [`trainer::search`](crate::trainer::search).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BudgetSearch {
    /// What a doubling of the scene's numbers has to bring on the validation views within one
    /// trial, dB of PSNR.
    pub least_gain: f64,
    /// Growth that is tried first, as a share of the splats.
    pub growth: f64,
    /// Whether a branch grows over the first half of its trial, and not at once: for what moves.
    pub gradual: bool,
    /// Whether splats leave that are not worth keeping.
    pub thinning: bool,
    /// Steps of a trial, as a share of the run.
    pub trial: f64,
    /// Every how many-th training view is set aside to judge the trials, until nothing is added any more.
    pub validation: u32,
    /// Nothing is tried that describes the scene with more numbers than this; `None` tries whatever
    /// `densification.max_splats` allows.
    pub most_numbers: Option<u64>,
}

impl Default for BudgetSearch {
    fn default() -> Self {
        Self {
            least_gain: 0.05,
            growth: 0.4,
            gradual: false,
            thinning: true,
            trial: 1.0 / 14.0,
            validation: 8,
            most_numbers: None,
        }
    }
}

/// The settings of a run. The defaults train a static scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrainingConfig {
    /// Optimisation steps, one view each.
    pub steps: u32,
    /// Seed of every random choice.
    pub seed: u64,
    /// Every how many-th view is held out for evaluation, the first included; `None` trains on all.
    pub holdout: Option<u32>,
    /// What is behind the splats while training.
    pub background: Background,
    /// λ of (1 − λ)·L1 + λ·(1 − SSIM).
    pub ssim_weight: f64,
    /// Highest SH degree, 0 to 3.
    pub sh_degree: u32,
    /// Steps between two SH degrees; 0 starts with the highest.
    pub sh_interval: u32,
    /// Learning rates.
    pub rates: RateSchedule,
    /// Adam's constants.
    pub adam: AdamConstants,
    /// Pressure on opacities and scales.
    pub regularisers: Regularisers,
    /// How the set of splats changes; `None` keeps the initial set.
    pub densification: Option<Densification>,
    /// How the network that moves the splats is trained; `None` trains a static scene.
    pub deformation: Option<DeformationTraining>,
    /// How the first splats look.
    pub initial: InitialSplats,
    /// Finds the number of splats and the SH degree, up to `densification.max_splats` and
    /// `sh_degree`; `None` goes to these. Without densification nothing is searched.
    pub search: Option<BudgetSearch>,
    /// Steps between two states that a run can return to: after a fault, or when it is killed.
    pub checkpoint_interval: u32,
}

impl Default for TrainingConfig {
    fn default() -> Self {
        Self::growing(7_000, 100_000)
    }
}

impl TrainingConfig {
    /// The initial splats and no others: the settings of Kerbl et al. 2023 without densification.
    #[must_use]
    pub fn fixed(steps: u32) -> Self {
        Self {
            steps,
            seed: 0,
            holdout: None,
            background: Background::Fixed([0.0; 3]),
            ssim_weight: 0.2,
            sh_degree: 3,
            sh_interval: 1_000,
            rates: RateSchedule::default(),
            adam: AdamConstants::default(),
            regularisers: Regularisers::default(),
            densification: None,
            deformation: None,
            initial: InitialSplats::default(),
            search: None,
            checkpoint_interval: 500,
        }
    }

    /// Growth to at most `max_splats` by Kheradmand et al. 2024, over the first five sixths of the
    /// run, as their 25 000 of 30 000 steps: they start from small, half-opaque splats and press on
    /// opacities and scales.
    #[must_use]
    pub fn growing(steps: u32, max_splats: u32) -> Self {
        Self {
            regularisers: Regularisers { opacity: 0.01, scale: 0.01 },
            densification: Some(Densification {
                max_splats,
                stop: steps - steps / 6,
                ..Densification::default()
            }),
            initial: InitialSplats { opacity: 0.5, scale: 0.1, ..InitialSplats::default() },
            ..Self::fixed(steps)
        }
    }

    /// As [`growing`](Self::growing), but only to what the scene needs; `ceiling` bounds the search.
    #[must_use]
    pub fn automatic(steps: u32, ceiling: u32) -> Self {
        Self { search: Some(BudgetSearch::default()), ..Self::growing(steps, ceiling) }
    }

    /// The highest SH degree.
    ///
    /// # Errors
    /// [`ConfigError`] when it is above 3.
    pub fn max_sh_degree(&self) -> Result<ShDegree, ConfigError> {
        ShDegree::try_from(self.sh_degree)
            .map_err(|_| ConfigError::new("sh_degree", "0 to 3", self.sh_degree))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_valid_and_survive_json() {
        for config in
            [TrainingConfig::default(), TrainingConfig::fixed(1), TrainingConfig::growing(7, 1)]
        {
            config.validate().unwrap();
            let json = serde_json::to_string(&config).unwrap();
            assert_eq!(serde_json::from_str::<TrainingConfig>(&json).unwrap(), config);
        }
    }

    #[test]
    fn missing_settings_take_their_defaults_and_unknown_ones_are_refused() {
        let config: TrainingConfig = serde_json::from_str(r#"{"steps": 12}"#).unwrap();
        assert_eq!(config, TrainingConfig { steps: 12, ..TrainingConfig::default() });
        let error = serde_json::from_str::<TrainingConfig>(r#"{"stepz": 12}"#).unwrap_err();
        assert!(error.to_string().contains("stepz"), "{error}");
    }
}
