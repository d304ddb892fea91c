//! Arguments that name photographs: which dataset, read how.

use std::path::PathBuf;

use clap::Args;
use trapeze_formats::dataset::{Dataset, DatasetOptions, load_dataset};

use crate::error::CliError;

/// The photographs to work on.
#[derive(Debug, Args)]
pub(crate) struct DatasetArguments {
    /// A folder with COLMAP, LLFF, transforms.json, Polycam or Record3D data, or a transforms*.json.
    pub(crate) dataset: PathBuf,
    /// Leave lens distortion in the images, as tools do that know only pinhole cameras.
    #[arg(long)]
    ignore_distortion: bool,
    /// Use images of 1/N the full size: images_N where it exists, else reduced by averaging.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    downscale: Option<u32>,
    /// Folder of the images inside the dataset; found by itself by default.
    #[arg(long, value_name = "FOLDER")]
    images: Option<String>,
    /// Folder of masks inside the dataset: pixels that are black there do not count.
    #[arg(long, value_name = "FOLDER")]
    masks: Option<String>,
    /// Hold out every N-th view, from the first; 0 holds out none. A dataset that names its own test
    /// views keeps them.
    #[arg(long, value_name = "N", default_value_t = 8)]
    holdout: usize,
}

impl DatasetArguments {
    /// Reads the dataset and shows what was guessed.
    pub(crate) fn load(&self) -> Result<Dataset, CliError> {
        if self.holdout == 1 {
            return Err(CliError::argument("--holdout", "0, or 2 and more", self.holdout));
        }
        let dataset = load_dataset(
            &self.dataset,
            &DatasetOptions {
                format: None,
                ignore_distortion: self.ignore_distortion,
                image_folder: self.images.clone(),
                downscale: self.downscale,
                mask_folder: self.masks.clone(),
                holdout: self.holdout(),
            },
        )?;
        for warning in &dataset.warnings {
            tracing::warn!("{warning}");
        }
        Ok(dataset)
    }

    /// Every how many-th view is held out.
    pub(crate) fn holdout(&self) -> Option<usize> {
        (self.holdout > 0).then_some(self.holdout)
    }
}

/// A colour name or three numbers from 0 to 1.
pub(crate) fn parse_color(text: &str) -> Result<[f32; 3], String> {
    match text {
        "black" => return Ok([0.0; 3]),
        "white" => return Ok([1.0; 3]),
        _ => {}
    }
    let numbers: Option<Vec<f32>> = text
        .split(',')
        .map(|part| part.trim().parse().ok().filter(|n| (0.0..=1.0).contains(n)))
        .collect();
    match numbers.as_deref() {
        Some(&[r, g, b]) => Ok([r, g, b]),
        _ => Err("expected black, white or three numbers from 0 to 1, as in 0.5,0.5,1".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_names_or_three_numbers() {
        assert_eq!(parse_color("white"), Ok([1.0; 3]));
        assert_eq!(parse_color("0, 0.5,1"), Ok([0.0, 0.5, 1.0]));
        for bad in ["red", "1,2,3", "0,0", "nan,0,0"] {
            assert!(parse_color(bad).unwrap_err().contains("0.5,0.5,1"));
        }
    }
}
