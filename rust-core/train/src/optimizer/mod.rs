//! What happens to the parameters once their gradients are known.

mod adam;
mod rates;
mod regularisers;
mod update;

pub use adam::{AdamConstants, AdamStep, adam_step, adam_step_of_network};
pub use rates::{RateSchedule, Rates};
pub use regularisers::Regularisers;
pub use update::apply_update;
