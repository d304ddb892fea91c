//! From arguments to the settings of a run.

use std::path::PathBuf;

use clap::Args;
use trapeze_formats::dataset::Dataset;
use trapeze_scene::ShDegree;
use trapeze_train::config::{Background, TrainingConfig};
use trapeze_train::{
    background_for_training, deformation_for_training, prepare_for_motion, search_for_training,
};

use super::settings::overridden;
use crate::dataset_input::{DatasetArguments, parse_color};
use crate::error::CliError;

/// The settings that a user may want to choose.
#[derive(Debug, Args)]
pub(crate) struct TrainingArguments {
    /// Optimisation steps, one view each.
    #[arg(long, default_value_t = 7_000, value_parser = clap::value_parser!(u32).range(1..))]
    steps: u32,
    /// Grow to at most N splats; `auto` grows only while training views that are set aside for it say
    /// that it pays, and then drops the splats that they would not miss.
    #[arg(long, value_name = "N|auto", default_value = "auto", value_parser = parse_budget)]
    max_splats: SplatBudget,
    /// With `--max-splats auto`: what a doubling of the scene's numbers has to bring, in dB of PSNR on
    /// the training views that judge it.
    #[arg(long, value_name = "DB", conflicts_with = "fixed")]
    least_gain: Option<f64>,
    /// Train the initial splats and no others: no growth, no relocation, no noise.
    #[arg(long, conflicts_with = "max_splats")]
    fixed: bool,
    /// Highest SH degree; with `--max-splats auto` the highest that is tried.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(0..=3))]
    sh_degree: u32,
    /// What is behind the splats: black, white, r,g,b, or random for another colour at each step. By
    /// default random where photographs have transparency, else black.
    #[arg(long, value_parser = parse_background)]
    background: Option<Background>,
    /// Train a static scene, whatever the times of the photographs. By default a scene of photographs
    /// with more than one time moves.
    #[arg(long = "static")]
    is_static: bool,
    /// Steps that a scene that moves is trained as if it did not, before its deformation network
    /// takes part; by default one in 20, at most 300.
    #[arg(long, value_name = "N", conflicts_with = "is_static")]
    warm_up: Option<u32>,
    /// Random splats to start from where a dataset has no points.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    random_splats: Option<u32>,
    /// Seed of every random choice.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Any setting of a run as a JSON object, nested as in a run's summary; goes over the other
    /// arguments.
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
}

/// The number of splats that a run may grow to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SplatBudget {
    Auto,
    Most(u32),
}

impl TrainingArguments {
    /// The settings for a dataset, in `memory` bytes.
    pub(super) fn configuration(
        &self,
        dataset: &Dataset,
        arguments: &DatasetArguments,
        memory: u64,
    ) -> Result<TrainingConfig, CliError> {
        let mut config = match self.max_splats {
            _ if self.fixed => TrainingConfig::fixed(self.steps),
            SplatBudget::Most(splats) => TrainingConfig::growing(self.steps, splats),
            SplatBudget::Auto => {
                let degree = ShDegree::try_from(self.sh_degree)?;
                search_for_training(dataset, self.steps, memory, degree)
            }
        };
        if let (Some(search), Some(least_gain)) = (&mut config.search, self.least_gain) {
            search.least_gain = least_gain;
        }
        config.sh_degree = self.sh_degree;
        config.seed = self.seed;
        config.holdout = arguments.holdout().map(|every| every as u32);
        config.background = match self.background {
            Some(background) => background,
            None => background_for_training(dataset)?,
        };
        if !self.is_static {
            config.deformation = deformation_for_training(dataset, self.steps)?;
        }
        if config.deformation.is_some() {
            prepare_for_motion(&mut config);
        }
        match (self.warm_up, &mut config.deformation) {
            (None, _) => {}
            (Some(steps), Some(deformation)) => deformation.warm_up = steps,
            (Some(_), None) => {
                let expected = "photographs of more than one time";
                return Err(CliError::argument("--warm-up", expected, "one"));
            }
        }
        if let Some(count) = self.random_splats {
            config.initial.random_count = count;
        }
        match &self.settings {
            Some(path) => overridden(&config, path),
            None => Ok(config),
        }
    }
}

fn parse_budget(text: &str) -> Result<SplatBudget, String> {
    match text.parse() {
        _ if text == "auto" => Ok(SplatBudget::Auto),
        Ok(splats @ 1..) => Ok(SplatBudget::Most(splats)),
        _ => Err("expected a number from 1, or auto".into()),
    }
}

fn parse_background(text: &str) -> Result<Background, String> {
    if text == "random" {
        return Ok(Background::Random);
    }
    parse_color(text).map(Background::Fixed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_numbers_or_auto() {
        assert_eq!(parse_budget("auto"), Ok(SplatBudget::Auto));
        assert_eq!(parse_budget("10091"), Ok(SplatBudget::Most(10_091)));
        for bad in ["0", "-1", "many", "5000000000"] {
            assert!(parse_budget(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_background_may_be_random() {
        assert_eq!(parse_background("random"), Ok(Background::Random));
        assert_eq!(parse_background("white"), Ok(Background::Fixed([1.0; 3])));
        assert!(parse_background("green").is_err());
    }
}
