//! Timing, and what machine it was done on.

mod machine;
mod timing;

pub(crate) use machine::{Machine, level_name, simd_levels};
pub(crate) use timing::{GPU_WARM_UP, Timing, time_runs};
