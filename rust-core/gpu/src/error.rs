//! Why the GPU did not do what it was asked.

use thiserror::Error;
use trapeze_scene::SceneError;

/// Errors of this crate.
#[derive(Debug, Clone, Error)]
pub enum GpuError {
    /// There is no adapter, or none of the name asked for.
    #[error("GPU adapter: expected {expected}, found {found}")]
    NoAdapter {
        /// What was asked for.
        expected: String,
        /// What there is.
        found: String,
    },
    /// The adapter cannot run the kernels.
    #[error("GPU {adapter}: {what}: need {need}, have {have}")]
    TooWeak {
        /// Name of the adapter.
        adapter: String,
        /// The limit.
        what: &'static str,
        /// Value needed.
        need: u64,
        /// Value of the adapter.
        have: u64,
    },
    /// The scene or the frame does not fit.
    #[error("GPU memory: {what}: need {need} bytes, have {have}")]
    OutOfMemory {
        /// Which data.
        what: &'static str,
        /// Bytes needed.
        need: u64,
        /// Bytes that the budget or the adapter's limits leave.
        have: u64,
    },
    /// The deformation network has a form that the kernels do not evaluate.
    #[error("deformation network on the GPU: {what}: expected at most {most}, found {found}")]
    Network {
        /// Which property.
        what: &'static str,
        /// Largest value accepted.
        most: usize,
        /// Value of the network.
        found: usize,
    },
    /// The deformation network has a form that the kernels do not train.
    #[error(
        "training a deformation network on the GPU: {what}: expected {expected}, found {found}"
    )]
    Untrainable {
        /// Which property.
        what: &'static str,
        /// What can be trained.
        expected: &'static str,
        /// Value of the network.
        found: String,
    },
    /// A window cannot be drawn into, or not any more.
    #[error("surface: expected {expected}, found {found}")]
    Surface {
        /// What was needed.
        expected: &'static str,
        /// What there was instead.
        found: String,
    },
    /// The device is gone (unplugged, reset, taken by the system): open another, and make the
    /// renderers and surfaces again on it.
    #[error("GPU device: lost ({0})")]
    DeviceLost(String),
    /// The driver refused something.
    #[error("GPU device: {0}")]
    Device(String),
    /// Scene data that do not fit together, or a camera that cannot project.
    #[error(transparent)]
    Scene(#[from] SceneError),
}
