//! Training: from photographs with known cameras to splats.
//!
//! # The model
//!
//! Splats start in the places of points or at random ([`initialise`]). A step renders one view,
//! compares it with its photograph ([`loss`]), carries the gradient back to the parameters (the
//! backend), and updates them ([`optimizer`]). Every hundred steps the set of splats changes
//! ([`densify`]). What happens at which step is a [`schedule`] made from a [`config`]; a run can be
//! stopped and resumed at any step ([`checkpoint`]). [`trainer`] puts all of it together, and
//! [`evaluation`] says how good the result is.
//!
//! # Why it is arranged like this
//!
//! The same trainer drives the CPU and the GPU through one trait, [`backend::TrainingBackend`],
//! whose documentation gives the reasons for its cut. Two properties run through the whole crate:
//!
//! * **A run is a function of (dataset, configuration).** Random numbers are addressed, not
//!   consumed ([`random`]); sums are made in a fixed order, whatever the number of threads; no
//!   decision reads a clock. So a run that is killed and resumed ends with the same bits.
//! * **Nothing that is not finite enters the state.** A poisoned gradient or an exploding rate is
//!   stopped at the single parameter that it reaches, and counted.

pub mod backend;
pub mod checkpoint;
pub mod config;
mod cpu_backend;
mod defaults;
pub mod densify;
pub mod evaluation;
mod exponential;
mod gpu_backend;
pub mod initialise;
pub mod loss;
mod motion;
mod network;
pub mod optimizer;
mod parameters;
pub mod random;
mod reference_backend;
mod report_queue;
pub mod rest;
pub mod schedule;
mod state;
pub mod trainer;

pub use cpu_backend::{CpuBackend, CpuBackendOptions, CpuStepTimes};
pub use defaults::{
    background_for_training, deformation_for_training, prepare_for_motion, search_for_training,
};
pub use gpu_backend::{GpuBackend, GpuBackendOptions, GpuMemoryPlan, GpuStepTimes};
pub use motion::{MotionSummary, with_measured_motion};
pub use network::{TrainedNetwork, network_parameters, set_network_parameters};
pub use parameters::{ParameterGroup, zeros_like};
pub use reference_backend::ReferenceBackend;
pub use state::TrainingState;
pub(crate) use state::numbers_of_splat;
pub use trainer::{TrainError, Trainer, TrainerOptions};
