//! Looks at which splats rest.

use trapeze_scene::Camera;

use super::{TrainError, Trainer};
use crate::backend::TrainingBackend;
use crate::rest::{MOST_MOMENTS, find_resting};

/// Steps between two looks where the set stays as it is; each of its changes is followed by one.
const INTERVAL: u32 = 500;
/// Cameras that say how large a pixel is, at most.
const MOST_CAMERAS: usize = 32;

impl<B: TrainingBackend> Trainer<B> {
    /// Finds the splats that rest from here to the next look, where one is due: after the set has
    /// changed, or as time goes by.
    pub(super) fn look_for_rest(&mut self, has_changed: bool) -> Result<(), TrainError> {
        let Some(motion) = self.config.deformation else { return Ok(()) };
        let from = motion.rest_from.max(motion.warm_up);
        let is_due = has_changed || self.step.is_multiple_of(INTERVAL);
        if motion.rest_within <= 0.0 || self.step < from || !is_due {
            return Ok(());
        }
        let look = self.backend.look(&self.views.moments(MOST_MOMENTS))?;
        let cameras = self.views.cameras();
        let every = cameras.len().div_ceil(MOST_CAMERAS).max(1);
        let cameras: Vec<Camera> = cameras.into_iter().step_by(every).collect();
        let resting = find_resting(&look, &cameras, motion.rest_within);
        self.progress.rest.resting = resting.held().len() as u32;
        Ok(self.backend.rest(Some(resting))?)
    }
}
