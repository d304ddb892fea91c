//! What a Gaussian-splat scene is: pure data and the maths that belongs to it.
//!
//! # The model
//!
//! A scene is a set of anisotropic 3-D Gaussians, *splats* ([`Splats`]), each with a position,
//! a covariance Σ = R S Sᵀ Rᵀ given by a quaternion and three log-scales, an opacity logit and a
//! colour that depends on the view direction through spherical harmonics ([`ShDegree`]).
//! A deformable scene adds one network ([`DeformationNetwork`]) that moves, turns and scales every
//! splat as a function of its own position and the time. [`Clusters`] say which object a splat
//! belongs to, [`Motion`] how far it ever moves, a [`Selection`] which objects are drawn.
//! [`Camera`], [`FrameSettings`] and [`Frame`] are the contract between a scene and a renderer.
//!
//! # Why it is arranged like this
//!
//! Everything here is what files store and optimisers update: logarithms, logits, raw quaternions.
//! The activated values (covariances, opacities) are made once, by the stage that needs them, so
//! there is one place where `exp` is applied and it cannot be applied twice.
//!
//! Per-splat data are flat arrays of plain numbers. Parsers fill them column by column, kernels on
//! CPU and GPU read them with unit stride, and a part that a scene lacks (`None`, or zero SH bands)
//! occupies nothing.
//!
//! This crate depends on none of the others and opens no file; of its functions only the search
//! for nearest neighbours ([`Neighbours`]) runs on more than the caller's thread. Conventions
//! (axes, pixel centres, thresholds, orders of blending) are stated in `docs/numerics.md` and
//! specified by the f64 reference renderer in the `cpu` crate.

mod bounds;
mod camera;
mod clusters;
mod comparison;
pub mod deformation;
pub mod edit;
mod error;
mod frame;
mod memory;
mod motion;
mod neighbours;
mod picture;
mod scene;
mod selection;
mod spherical_harmonics;
mod splats;

pub use bounds::{Bounds, Orbit};
pub use camera::{Camera, MAX_IMAGE_SIDE};
pub use clusters::{Cluster, Clusters};
pub use comparison::{ImageError, psnr};
pub use deformation::DeformationNetwork;
pub use error::{ArchitectureError, SceneError};
pub use frame::{ColorSource, DepthRange, Frame, FrameSettings, NO_SPLAT, depth_grey, motion_heat};
pub use memory::{GEOMETRY_BYTES_PER_SPLAT, MemoryEstimate};
pub use motion::{Motion, MotionMeasure, is_dynamic};
pub use neighbours::{NO_NEIGHBOUR, Neighbours, nearest_neighbour_distances};
pub use picture::Rgba8;
pub use scene::{Features, Scene};
pub use selection::{ClusterSet, Selection};
pub use spherical_harmonics::{SH_C0, SH_C1, SH_C2, SH_C3, ShDegree, sh_basis, sh_basis_gradient};
pub use splats::{Splats, sigmoid};
