//! The ranges in which the settings of a run make sense.

use thiserror::Error;

use super::{Background, BudgetSearch, DeformationTraining, Densification, TrainingConfig};

impl TrainingConfig {
    /// Checks every number against the range in which a run makes sense.
    ///
    /// # Errors
    /// [`ConfigError`] names the first field that is outside.
    pub fn validate(&self) -> Result<(), ConfigError> {
        self.max_sh_degree()?;
        if self.steps == 0 {
            return Err(ConfigError::new("steps", "at least 1", self.steps));
        }
        if self.holdout.is_some_and(|k| k < 2) {
            return Err(ConfigError::new("holdout", "at least 2, or none", 0));
        }
        if let Background::Fixed(color) = self.background {
            for c in color {
                in_range("background", f64::from(c), 0.0, 1.0)?;
            }
        }
        in_range("ssim_weight", self.ssim_weight, 0.0, 1.0)?;
        let rates = &self.rates;
        for (field, rate) in [
            ("rates.positions_start", rates.positions_start),
            ("rates.positions_end", rates.positions_end),
            ("rates.log_scales", rates.log_scales),
            ("rates.rotations", rates.rotations),
            ("rates.opacity_logits", rates.opacity_logits),
            ("rates.sh_dc", rates.sh_dc),
            ("rates.sh_rest", rates.sh_rest),
            ("regularisers.opacity", self.regularisers.opacity),
            ("regularisers.scale", self.regularisers.scale),
        ] {
            in_range(field, rate, 0.0, 1e6)?;
        }
        if rates.positions_start > 0.0 && rates.positions_end == 0.0 {
            return Err(ConfigError::new("rates.positions_end", "a number above 0", 0));
        }
        let below_one = 1.0 - f64::EPSILON;
        in_range("adam.beta1", self.adam.beta1, 0.0, below_one)?;
        in_range("adam.beta2", self.adam.beta2, 0.0, below_one)?;
        in_range("adam.epsilon", self.adam.epsilon, f64::from(f32::MIN_POSITIVE), 1.0)?;
        in_range("initial.opacity", self.initial.opacity, 1e-6, below_one)?;
        in_range("initial.scale", self.initial.scale, 1e-6, 1e6)?;
        if self.initial.random_count == 0 {
            return Err(ConfigError::new("initial.random_count", "at least 1", 0));
        }
        if self.checkpoint_interval == 0 {
            return Err(ConfigError::new("checkpoint_interval", "at least 1", 0));
        }
        if let Some(search) = &self.search {
            search.validate()?;
        }
        if let Some(deformation) = &self.deformation {
            deformation.validate()?;
        }
        self.densification.as_ref().map_or(Ok(()), Densification::validate)
    }
}

impl DeformationTraining {
    fn validate(&self) -> Result<(), ConfigError> {
        let least = f64::from(f32::MIN_POSITIVE);
        in_range("deformation.rate_start", self.rate_start, least, 1e6)?;
        in_range("deformation.rate_end", self.rate_end, least, 1e6)?;
        in_range("deformation.time_noise", self.time_noise, 0.0, 1.0)?;
        in_range("deformation.rest_within", self.rest_within, 0.0, 1e3)
    }
}

impl BudgetSearch {
    fn validate(&self) -> Result<(), ConfigError> {
        in_range("search.least_gain", self.least_gain, 0.0, 1e3)?;
        in_range("search.growth", self.growth, 0.01, 10.0)?;
        in_range("search.trial", self.trial, 1e-6, 0.5)?;
        if self.validation < 2 {
            return Err(ConfigError::new("search.validation", "at least 2", self.validation));
        }
        Ok(())
    }
}

impl Densification {
    fn validate(&self) -> Result<(), ConfigError> {
        if self.interval == 0 {
            return Err(ConfigError::new("densification.interval", "at least 1", 0));
        }
        if self.max_splats == 0 {
            return Err(ConfigError::new("densification.max_splats", "at least 1", 0));
        }
        in_range("densification.growth", self.growth, 0.0, 10.0)?;
        in_range("densification.dead_opacity", self.dead_opacity, 0.0, 0.5)?;
        in_range("densification.noise.scale", self.noise.scale, 0.0, 1e12)?;
        in_range("densification.noise.gate_steepness", self.noise.gate_steepness, 0.0, 1e6)?;
        in_range("densification.noise.gate_opacity", self.noise.gate_opacity, 0.0, 1.0)
    }
}

/// A setting outside its range.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{field}: expected {expected}, found {found}")]
pub struct ConfigError {
    /// Path of the setting.
    pub field: &'static str,
    /// What would have been accepted.
    pub expected: String,
    /// The value.
    pub found: f64,
}

impl ConfigError {
    pub(super) fn new(
        field: &'static str,
        expected: impl Into<String>,
        found: impl Into<f64>,
    ) -> Self {
        Self { field, expected: expected.into(), found: found.into() }
    }
}

fn in_range(field: &'static str, value: f64, low: f64, high: f64) -> Result<(), ConfigError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(ConfigError::new(field, format!("{low} to {high}"), value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimizer::{AdamConstants, RateSchedule};

    #[test]
    fn settings_out_of_range_are_refused_by_name() {
        let default = TrainingConfig::default;
        let densification = Densification { interval: 0, ..Densification::default() };
        for (field, config) in [
            ("steps", TrainingConfig { steps: 0, ..default() }),
            ("sh_degree", TrainingConfig { sh_degree: 4, ..default() }),
            ("holdout", TrainingConfig { holdout: Some(1), ..default() }),
            ("ssim_weight", TrainingConfig { ssim_weight: f64::NAN, ..default() }),
            (
                "background",
                TrainingConfig { background: Background::Fixed([0.0, -1.0, 0.0]), ..default() },
            ),
            (
                "rates.positions_end",
                TrainingConfig {
                    rates: RateSchedule { positions_end: 0.0, ..RateSchedule::default() },
                    ..default()
                },
            ),
            (
                "adam.beta2",
                TrainingConfig {
                    adam: AdamConstants { beta2: 1.0, ..AdamConstants::default() },
                    ..default()
                },
            ),
            (
                "densification.interval",
                TrainingConfig { densification: Some(densification), ..default() },
            ),
        ] {
            assert_eq!(config.validate().unwrap_err().field, field);
        }
    }
}
