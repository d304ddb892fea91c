//! Learning rates by group and step.

use serde::{Deserialize, Serialize};

use crate::parameters::ParameterGroup;

/// The learning rate of every group at one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// World units.
    pub positions: f64,
    /// Natural-log units.
    pub log_scales: f64,
    /// Of a quaternion of about unit length.
    pub rotations: f64,
    /// Logit units.
    pub opacity_logits: f64,
    /// SH band 0.
    pub sh_dc: f64,
    /// SH bands 1 and up.
    pub sh_rest: f64,
}

impl Rates {
    /// The rate of `group`.
    #[must_use]
    pub fn of(&self, group: ParameterGroup) -> f64 {
        match group {
            ParameterGroup::Positions => self.positions,
            ParameterGroup::LogScales => self.log_scales,
            ParameterGroup::Rotations => self.rotations,
            ParameterGroup::OpacityLogits => self.opacity_logits,
            ParameterGroup::ShDc => self.sh_dc,
            ParameterGroup::ShRest => self.sh_rest,
        }
    }

    /// All rates times `factor`: what a roll-back lowers.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            positions: self.positions * factor,
            log_scales: self.log_scales * factor,
            rotations: self.rotations * factor,
            opacity_logits: self.opacity_logits * factor,
            sh_dc: self.sh_dc * factor,
            sh_rest: self.sh_rest * factor,
        }
    }
}

/// Learning rates and how they change. The defaults are those of Kerbl et al. 2023.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RateSchedule {
    /// Positions at the first step, as a share of the scene's extent.
    pub positions_start: f64,
    /// Positions at the last step, as a share of the scene's extent.
    pub positions_end: f64,
    /// Log-scales.
    pub log_scales: f64,
    /// Quaternions.
    pub rotations: f64,
    /// Opacity logits.
    pub opacity_logits: f64,
    /// SH band 0.
    pub sh_dc: f64,
    /// SH bands 1 and up: a twentieth of band 0.
    pub sh_rest: f64,
}

impl Default for RateSchedule {
    fn default() -> Self {
        Self {
            positions_start: 1.6e-4,
            positions_end: 1.6e-6,
            log_scales: 5e-3,
            rotations: 1e-3,
            opacity_logits: 5e-2,
            sh_dc: 2.5e-3,
            sh_rest: 2.5e-3 / 20.0,
        }
    }
}

impl RateSchedule {
    /// The rates of step `step` of `steps` in a scene of size `extent` (world units). The rate of
    /// positions falls exponentially from its start to its end, the others stay.
    #[must_use]
    pub fn at(&self, step: u32, steps: u32, extent: f64) -> Rates {
        let progress = f64::from(step.min(steps)) / f64::from(steps.max(1));
        let decay = (self.positions_end / self.positions_start).powf(progress);
        Rates {
            positions: extent * self.positions_start * decay,
            log_scales: self.log_scales,
            rotations: self.rotations,
            opacity_logits: self.opacity_logits,
            sh_dc: self.sh_dc,
            sh_rest: self.sh_rest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_of_positions_falls_by_equal_factors_from_start_to_end() {
        let schedule = RateSchedule::default();
        let rate = |step| schedule.at(step, 1000, 2.5).positions;
        assert!((rate(0) - 4e-4).abs() < 1e-18 && (rate(1000) - 4e-6).abs() < 1e-18);
        assert!((rate(500) - 4e-5).abs() < 1e-16);
        assert_eq!(rate(5000), rate(1000));
        assert_eq!(schedule.at(0, 0, 1.0).positions, 1.6e-4);
    }

    #[test]
    fn every_group_has_its_own_rate() {
        let rates = RateSchedule::default().at(0, 100, 1.0).scaled(0.5);
        let found = ParameterGroup::ALL.map(|group| rates.of(group));
        assert_eq!(found, [0.8e-4, 2.5e-3, 0.5e-3, 2.5e-2, 1.25e-3, 6.25e-5]);
    }
}
