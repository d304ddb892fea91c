//! Posed photographs to train on.

use std::path::Path;
use std::sync::Arc;

use trapeze_formats::dataset::{self, DatasetFormat, DatasetOptions, load_dataset};
use trapeze_scene::Camera;

use crate::failure::{Code, Failure, guarded};
use crate::ffi::{DatasetFigures, Lens};
use crate::frame::{lens_of, rows_of};

/// A dataset, read but with no photograph decoded.
#[derive(Debug)]
pub(crate) struct Dataset {
    dataset: Arc<dataset::Dataset>,
    holdout: Option<u32>,
}

/// Reads the poses, points and image headers of a folder or a `transforms.json`.
pub(crate) fn inspect_dataset(
    path: String,
    downscale: u32,
    holdout: u32,
) -> Result<Dataset, Failure> {
    guarded(|| {
        if !(1..=64).contains(&downscale) {
            return Err(Failure::argument("downscale", "1 to 64", downscale));
        }
        if holdout == 1 {
            return Err(Failure::argument("holdout", "0, or 2 and more", holdout));
        }
        let options = DatasetOptions {
            downscale: (downscale > 1).then_some(downscale),
            holdout: (holdout > 0).then_some(holdout as usize),
            ..DatasetOptions::default()
        };
        let dataset = load_dataset(Path::new(&path), &options)?;
        if dataset.views.is_empty() {
            let message = format!("{path}: views: expected at least one, found none");
            return Err(Failure::new(Code::UnusableDataset, message));
        }
        let holdout = (holdout > 0).then_some(holdout);
        Ok(Dataset { dataset: Arc::new(dataset), holdout })
    })
}

impl Dataset {
    pub(crate) fn shared(&self) -> &Arc<dataset::Dataset> {
        &self.dataset
    }

    /// Every how many-th view is held out.
    pub(crate) fn holdout(&self) -> Option<u32> {
        self.holdout
    }

    pub(crate) fn figures(&self) -> DatasetFigures {
        let first = self.dataset.views.first();
        DatasetFigures {
            views: self.dataset.views.len(),
            width: first.map_or(0, |view| view.camera.width),
            height: first.map_or(0, |view| view.camera.height),
            points: self.dataset.points.as_ref().map_or(0, |points| points.len() as u64),
        }
    }

    pub(crate) fn format_name(&self) -> String {
        match self.dataset.format {
            DatasetFormat::Colmap => "COLMAP",
            DatasetFormat::Llff => "LLFF",
            DatasetFormat::Transforms => "transforms.json",
            DatasetFormat::Polycam => "Polycam",
            DatasetFormat::Record3d => "Record3D",
        }
        .into()
    }

    pub(crate) fn warnings(&self) -> Vec<String> {
        self.dataset.warnings.clone()
    }

    pub(crate) fn view_lens(&self, index: usize) -> Lens {
        let nothing = Lens { width: 0, height: 0, fx: 0.0, fy: 0.0, cx: 0.0, cy: 0.0 };
        self.camera(index).map_or(nothing, lens_of)
    }

    pub(crate) fn view_world_to_camera(&self, index: usize) -> Vec<f64> {
        self.camera(index).map_or_else(Vec::new, rows_of)
    }

    pub(crate) fn view_time(&self, index: usize) -> f32 {
        self.dataset.views.get(index).and_then(|view| view.time).unwrap_or(0.0)
    }

    fn camera(&self, index: usize) -> Option<&Camera> {
        self.dataset.views.get(index).map(|view| &view.camera)
    }
}
