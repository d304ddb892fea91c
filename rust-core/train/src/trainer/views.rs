//! The views of a run: which are trained on, which validate, and which one a step looks at.

use trapeze_formats::dataset::Dataset;
use trapeze_scene::Camera;

use super::TrainError;
use crate::backend::TrainingView;
use crate::config::TrainingConfig;
use crate::random::ViewOrder;

/// Views that a search needs: below this, setting one aside would cost more than it tells.
const LEAST_SEARCHED: usize = 4;

/// The training views of a dataset. The held-out ones are not in here at all.
pub(super) struct Views {
    seed: u64,
    all: Vec<TrainingView>,
    /// Index in the dataset, by view.
    dataset_indices: Vec<usize>,
    /// Views that judge the trials of a search.
    validation: Vec<u32>,
    /// Views that steps look at.
    shown: Vec<u32>,
    order: ViewOrder,
}

impl Views {
    /// The training views, all of them shown.
    pub(super) fn new(dataset: &Dataset, config: &TrainingConfig) -> Result<Self, TrainError> {
        let dataset_indices: Vec<usize> = dataset.training_views().collect();
        if dataset_indices.is_empty() {
            let found = format!("none of {} (all held out)", dataset.views.len());
            return Err(TrainError::dataset("training views", "at least one", found));
        }
        let view = |(id, &index): (usize, &usize)| TrainingView {
            id: id as u32,
            camera: dataset.local_camera(index),
            time: dataset.views[index].time.unwrap_or(0.0),
        };
        let all: Vec<TrainingView> = dataset_indices.iter().enumerate().map(view).collect();
        let validation = match config.search {
            Some(_) if all.len() < LEAST_SEARCHED => {
                let expected = format!("at least {LEAST_SEARCHED} for a search");
                return Err(TrainError::dataset("training views", expected, all.len()));
            }
            Some(search) => validation_views(all.len() as u32, search.validation),
            None => Vec::new(),
        };
        let shown: Vec<u32> = (0..all.len() as u32).collect();
        let order = ViewOrder::new(config.seed, shown.len() as u32);
        Ok(Self { seed: config.seed, all, dataset_indices, validation, shown, order })
    }

    /// Sets the validation views aside, or shows them again.
    pub(super) fn set_validation_aside(&mut self, aside: bool) {
        let all = 0..self.all.len() as u32;
        self.shown = all.filter(|id| !(aside && self.validation.contains(id))).collect();
        self.order = ViewOrder::new(self.seed, self.shown.len() as u32);
    }

    /// The view of a step.
    pub(super) fn at_step(&mut self, step: u32) -> u32 {
        self.shown[self.order.view(step) as usize]
    }

    pub(super) fn view(&self, id: u32) -> &TrainingView {
        &self.all[id as usize]
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// Number of views in an epoch.
    pub(super) fn epoch(&self) -> u32 {
        self.shown.len() as u32
    }

    pub(super) fn validation(&self) -> &[u32] {
        &self.validation
    }

    /// The views that steps look at.
    pub(super) fn shown(&self) -> &[u32] {
        &self.shown
    }

    /// Times of the training views, at most `count`, from the middle of as many equal parts.
    pub(super) fn moments(&self, count: usize) -> Vec<f32> {
        let mut times: Vec<f32> = self.all.iter().map(|view| view.time).collect();
        times.sort_unstable_by(f32::total_cmp);
        times.dedup();
        let count = count.min(times.len());
        (0..count).map(|k| times[(2 * k + 1) * times.len() / (2 * count)]).collect()
    }

    pub(super) fn dataset_indices(&self) -> &[usize] {
        &self.dataset_indices
    }

    pub(super) fn cameras(&self) -> Vec<Camera> {
        self.all.iter().map(|view| view.camera.clone()).collect()
    }

    /// Pixels of the largest view.
    pub(super) fn largest(&self) -> u64 {
        let pixels =
            |view: &TrainingView| u64::from(view.camera.width) * u64::from(view.camera.height);
        self.all.iter().map(pixels).max().unwrap_or(0)
    }

    /// Pixels of all views.
    pub(super) fn pixels(&self) -> u64 {
        let pixels =
            |view: &TrainingView| u64::from(view.camera.width) * u64::from(view.camera.height);
        self.all.iter().map(pixels).sum()
    }
}

/// Every `every`-th view, from the middle of the first group; at least one.
fn validation_views(views: u32, every: u32) -> Vec<u32> {
    let first = (every / 2).min(views / 2);
    (first..views).step_by(every as usize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn validation_views_are_spread_and_there_is_always_one() {
        assert_eq!(validation_views(17, 8), [4, 12]);
        assert_eq!(validation_views(4, 8), [2]);
        assert_eq!(validation_views(200, 50), [25, 75, 125, 175]);
    }
}
