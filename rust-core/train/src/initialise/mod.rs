//! The splats before the first step, and the size of the scene by which steps are measured.

mod extent;
mod points;
mod volume;

pub use extent::scene_extent;
pub use points::splats_from_points;
pub use volume::{random_points, viewed_volume};
