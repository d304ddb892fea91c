//! Errors of scene data that does not fit together.

use thiserror::Error;

/// Why scene data was refused. The messages name the field, what was found and what was expected.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SceneError {
    /// An array does not have one entry per splat.
    #[error("{field}: expected {expected} values, found {found}")]
    Length {
        /// Name of the array.
        field: &'static str,
        /// Values that the number of splats asks for.
        expected: usize,
        /// Values present.
        found: usize,
    },
    /// More splats than a 32-bit index can name.
    #[error("splats: expected at most 4294967295, found {found}")]
    TooManySplats {
        /// Splats present.
        found: usize,
    },
    /// SH degree outside 0–3.
    #[error("SH degree: expected 0 to 3, found {found}")]
    ShDegree {
        /// The degree asked for.
        found: u32,
    },
    /// A camera that cannot project.
    #[error("camera {field}: expected {expected}, found {found}")]
    Camera {
        /// Name of the field.
        field: &'static str,
        /// What would have been accepted.
        expected: &'static str,
        /// The value.
        found: String,
    },
}

/// Why a set of tensors is not a deformation network that this program can evaluate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ArchitectureError {
    /// A tensor that the architecture needs is absent.
    #[error("deformation network: tensor {name} is missing")]
    Missing {
        /// Name in the state dict.
        name: String,
    },
    /// A tensor belongs to no architecture that is known.
    #[error("deformation network: tensor {name} is not part of a known architecture")]
    Unknown {
        /// Name in the state dict.
        name: String,
    },
    /// A tensor has another shape than its neighbours ask for.
    #[error("deformation network: tensor {name}: expected shape {expected}, found {found:?}")]
    Shape {
        /// Name in the state dict.
        name: String,
        /// The shape asked for, as `[out, in]` or a description.
        expected: String,
        /// The shape present.
        found: Vec<usize>,
    },
}
