//! Stage 1: splats at the time of the frame.

mod deformed;

pub use deformed::{Deformed, MAX_SCALE};
