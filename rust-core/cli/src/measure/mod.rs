//! Timing, and what machine it was done on.

mod machine;
mod timing;

pub(crate) use machine::{Machine, level_name, simd_levels};
pub(crate) use timing::{Timing, time_runs, warm_up_gpu};
