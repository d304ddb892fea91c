//! What a scene takes on a device, known before anything is uploaded, and what to leave out when
//! there is less.

mod contribution;
mod plan;
mod tiers;

pub(crate) use contribution::{kept_splats, part_of};
pub(crate) use plan::initial_entries;
pub use plan::{MemoryPlan, PlannedBuffer, SceneSize};
pub use tiers::MemoryRequest;

#[cfg(test)]
mod tests;
