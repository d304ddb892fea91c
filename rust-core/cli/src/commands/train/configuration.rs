//! From arguments to the settings of a run.

use clap::Args;
use trapeze_formats::dataset::{Dataset, load_image};
use trapeze_scene::ShDegree;
use trapeze_train::TrainingState;
use trapeze_train::config::{Background, TrainingConfig};

use crate::dataset_input::{DatasetArguments, parse_color};
use crate::error::CliError;

/// The settings that a user may want to choose.
#[derive(Debug, Args)]
pub(crate) struct TrainingArguments {
    /// Optimisation steps, one view each.
    #[arg(long, default_value_t = 7_000, value_parser = clap::value_parser!(u32).range(1..))]
    steps: u32,
    /// Grow to at most N splats; `auto` grows only while training views that are set aside for it say
    /// that it pays.
    #[arg(long, value_name = "N|auto", default_value = "auto", value_parser = parse_budget)]
    max_splats: SplatBudget,
    /// With `--max-splats auto`: what a doubling of the scene's numbers has to bring, in dB of PSNR on
    /// the training views that are set aside.
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
    /// Random splats to start from where a dataset has no points.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    random_splats: Option<u32>,
    /// Seed of every random choice.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// The number of splats that a run may grow to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SplatBudget {
    Auto,
    Most(u32),
}

/// The most splats that a search tries, if the memory allows.
const CEILING: u64 = 2_000_000;
/// Share of the memory that the state of the splats may take; the rest is for photographs and
/// working memory.
const STATE_SHARE: u64 = 8;

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
            SplatBudget::Auto => TrainingConfig::automatic(self.steps, self.ceiling(memory)),
        };
        if let (Some(search), Some(least_gain)) = (&mut config.search, self.least_gain) {
            search.least_gain = least_gain;
        }
        config.sh_degree = self.sh_degree;
        config.seed = self.seed;
        config.holdout = arguments.holdout().map(|every| every as u32);
        config.background = match self.background {
            Some(background) => background,
            None => default_background(dataset)?,
        };
        if let Some(count) = self.random_splats {
            config.initial.random_count = count;
        }
        Ok(config)
    }

    fn ceiling(&self, memory: u64) -> u32 {
        let degree = ShDegree::try_from(self.sh_degree).unwrap_or(ShDegree::Three);
        let fitting = memory / STATE_SHARE / TrainingState::bytes(1, degree);
        // In powers of two: the same on machines that differ by a few megabytes.
        let power = fitting.max(1).ilog2();
        (1u64 << power).min(CEILING) as u32
    }
}

/// Random where the first photograph has transparency: nothing may stand in for the background.
fn default_background(dataset: &Dataset) -> Result<Background, CliError> {
    let has_alpha = match dataset.training_views().next() {
        Some(index) => load_image(&dataset.views[index])?.has_alpha(),
        None => false,
    };
    Ok(if has_alpha { Background::Random } else { Background::Fixed([0.0; 3]) })
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
