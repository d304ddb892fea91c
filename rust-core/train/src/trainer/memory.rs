//! What a run will need, before it starts.

use serde::{Deserialize, Serialize};
use trapeze_scene::ShDegree;

use super::views::Views;
use super::{TrainError, TrainerOptions};
use crate::backend::TrainingBackend;
use crate::config::{BudgetSearch, TrainingConfig};
use crate::{TrainedNetwork, TrainingState};

const MEGABYTE: u64 = 1 << 20;

/// Bytes that a run takes at its largest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrainingMemory {
    /// Parameters, moments and gradients.
    pub parameters: u64,
    /// Copies of the state: one while it is saved or taken up, where the backend cannot do without,
    /// and, where there is no folder for them, the good state and the branch that a search compares
    /// with.
    pub copies: u64,
    /// Photographs, decoded.
    pub photographs: u64,
    /// The backend's working memory.
    pub working: u64,
}

impl TrainingMemory {
    /// The estimate for a run that starts from `initial` splats.
    pub(super) fn of(
        config: &TrainingConfig,
        views: &Views,
        backend: &impl TrainingBackend,
        initial: u32,
        options: &TrainerOptions,
    ) -> Self {
        let cap = config.densification.map_or(0, |densification| densification.max_splats);
        let most = searched(config).map_or(u32::MAX, |search| search.most_splats());
        let splats = cap.min(most).max(initial);
        let degree = ShDegree::try_from(config.sh_degree).unwrap_or(ShDegree::Three);
        let is_moving = config.deformation.is_some();
        let network = if is_moving { TrainedNetwork::bytes() } else { 0 };
        let state = Self::of_state(config, splats, degree) + network;
        let kept = match options.checkpoints {
            Some(_) => 0,
            None => 1 + u64::from(searched(config).is_some()),
        };
        // Three bytes a pixel, in the backend; what is decoded ahead comes on top.
        let photographs = 3 * views.pixels();
        Self {
            parameters: state + state / 3,
            copies: state * (1 + kept),
            photographs: photographs.min(backend.target_budget())
                + photographs.min(options.photograph_budget as u64),
            working: backend.working_bytes(splats, views.largest())
                + if is_moving { backend.network_working_bytes(splats) } else { 0 },
        }
    }

    /// Bytes of a state of `splats` splats, the most there will be. A search gives bands only to as many
    /// of them as describe the scene with no more numbers than it may have; those that a run begins with
    /// it may have in any case, without bands.
    fn of_state(config: &TrainingConfig, splats: u32, degree: ShDegree) -> u64 {
        let with_bands = TrainingState::bytes(splats.into(), degree);
        let Some(most) = searched(config).and_then(|search| search.most_numbers) else {
            return with_bands;
        };
        let without_bands = TrainingState::bytes(splats.into(), ShDegree::Zero);
        with_bands.min(without_bands.max(most.saturating_mul(TrainingState::BYTES_BY_NUMBER)))
    }

    /// Sum of all parts.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.parameters + self.copies + self.photographs + self.working
    }

    /// Refuses what does not fit into `limit` bytes.
    pub(super) fn check(&self, limit: u64) -> Result<(), TrainError> {
        if self.total() <= limit {
            return Ok(());
        }
        let megabytes = |bytes: u64| bytes.div_ceil(MEGABYTE);
        let detail = format!(
            "parameters {}, copies {}, photographs {}, working memory {}",
            megabytes(self.parameters),
            megabytes(self.copies),
            megabytes(self.photographs),
            megabytes(self.working),
        );
        Err(TrainError::Memory { needed: megabytes(self.total()), detail, limit: limit / MEGABYTE })
    }
}

/// How the budget is searched for, if it is: only a set that changes can be searched.
fn searched(config: &TrainingConfig) -> Option<BudgetSearch> {
    config.search.filter(|_| config.densification.is_some())
}
