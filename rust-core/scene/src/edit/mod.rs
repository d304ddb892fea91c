//! Edits of a scene as pure functions.
//!
//! A filter answers with the indices of the splats that stay, ascending;
//! [`Scene::gather`](crate::Scene::gather) makes the scene of them, in which clusters, motion and
//! features follow their splats. So filters compose by applying one after the other.

mod bake;
mod filters;
mod floaters;
mod merge;

use thiserror::Error;

pub use bake::bake;
pub use filters::{crop_box, drop_clusters, keep_clusters, min_opacity};
pub use floaters::{FloaterRule, without_floaters};
pub use merge::{Placement, merge};

/// Why an edit was refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EditError {
    /// Clusters were named in a scene that has none.
    #[error("clusters: expected a scene with clusters, found none")]
    NoClusters,
    /// The scene has no cluster with this id.
    #[error("cluster {id}: expected one of {known}")]
    UnknownCluster {
        /// The id asked for.
        id: u32,
        /// The ids that there are, shortened.
        known: String,
    },
    /// Every cluster id above those of the first scene is beyond 32 bits.
    #[error("cluster ids: expected room for the added clusters, found 4294967295 in use")]
    ClusterIds,
    /// The scene to add has a network of its own; a scene has one.
    #[error("scene to merge: expected one without a deformation network, found one")]
    SecondNetwork,
    /// A placement that puts nothing anywhere.
    #[error("placement: expected finite x, y, z and a scale above 0, found {found}")]
    Placement {
        /// The placement.
        found: String,
    },
    /// Geometry for another number of splats.
    #[error("{field}: expected {expected} values, found {found}")]
    Length {
        /// Name of the array.
        field: &'static str,
        /// Splats in the scene.
        expected: usize,
        /// Values given.
        found: usize,
    },
}
