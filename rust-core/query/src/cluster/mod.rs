//! Instance clusters for scenes that come without them.
//!
//! Either way the work is done on a sample, which HDBSCAN (Campello et al. 2013) groups by density
//! without being told a number of clusters; the rest follows its sample. With feature vectors per splat
//! (TRASE's `gaussian_feats_*`) a splat follows the nearest direction ([`by_features`]), without them
//! the nearest neighbour in place, motion and colour ([`by_geometry`]).

mod agreement;
mod by_features;
mod by_geometry;
mod sample;

use hdbscan::{DistanceMetric, Hdbscan, HdbscanHyperParams, NnAlgorithm};
use thiserror::Error;
use trapeze_scene::{Cluster, Clusters};

pub use agreement::adjusted_rand_index;
pub use by_features::by_features;
pub use by_geometry::by_geometry;

/// The id of splats that belong to no cluster, and the name that tells it from a cluster 0.
pub const UNASSIGNED_ID: u32 = 0;
/// See [`UNASSIGNED_ID`].
pub const UNASSIGNED_NAME: &str = "unassigned";

/// Splats that no cluster took, in a [`Grouping`].
pub const UNASSIGNED: u32 = u32::MAX;

/// How splats are grouped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusterOptions {
    /// Splats in the sample. Time and memory of the grouping grow with its square.
    pub sample: usize,
    /// The smallest cluster, as a share of the sample.
    pub least_share: f64,
}

impl Default for ClusterOptions {
    fn default() -> Self {
        Self { sample: 4000, least_share: 0.01 }
    }
}

/// A group per splat.
#[derive(Clone, Debug, PartialEq)]
pub struct Grouping {
    /// Per splat: its group, or [`UNASSIGNED`].
    pub groups: Vec<u32>,
    /// Number of groups; group 0 has the most splats.
    pub count: usize,
}

/// Why splats cannot be grouped. One line.
#[derive(Debug, Error)]
pub enum ClusterError {
    /// There is too little to group.
    #[error("{field}: expected at least {expected}, found {found}")]
    TooFew {
        /// Of what.
        field: &'static str,
        /// How many are needed.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// The library refuses the sample.
    #[error("clusters: {0}")]
    Grouping(String),
}

impl Grouping {
    /// Groups in the order of their size.
    fn ordered(mut groups: Vec<u32>, count: usize) -> Self {
        let mut sizes = vec![0_usize; count];
        for &group in groups.iter().filter(|&&group| group != UNASSIGNED) {
            sizes[group as usize] += 1;
        }
        let mut order: Vec<usize> = (0..count).filter(|&group| sizes[group] > 0).collect();
        order.sort_by_key(|&group| std::cmp::Reverse(sizes[group]));
        let mut renamed = vec![UNASSIGNED; count];
        for (new, &old) in (0..).zip(&order) {
            renamed[old] = new;
        }
        for group in groups.iter_mut().filter(|group| **group != UNASSIGNED) {
            *group = renamed[*group as usize];
        }
        Self { groups, count: order.len() }
    }

    /// The scene's clusters: ids from 1 in the order of size, and [`UNASSIGNED_ID`] for the rest.
    #[must_use]
    pub fn into_clusters(self) -> Clusters {
        let rest = self.groups.contains(&UNASSIGNED);
        let shift = u32::from(rest);
        let labels = self
            .groups
            .iter()
            .map(|&group| if group == UNASSIGNED { 0 } else { group + shift })
            .collect();
        let unassigned = rest.then(|| Cluster {
            id: UNASSIGNED_ID,
            color: [0.5; 3],
            name: Some(UNASSIGNED_NAME.into()),
        });
        let groups = (0..self.count as u32).map(|group| Cluster {
            id: group + 1,
            color: Clusters::palette(group),
            name: None,
        });
        Clusters { labels, table: unassigned.into_iter().chain(groups).collect() }
    }
}

/// Whether a cluster is what [`Grouping::into_clusters`] makes of splats that belong to none.
#[must_use]
pub fn is_unassigned(cluster: &Cluster) -> bool {
    cluster.id == UNASSIGNED_ID && cluster.name.as_deref() == Some(UNASSIGNED_NAME)
}

/// Least splats that can be grouped.
const LEAST_SAMPLE: usize = 32;

/// Groups a sample by density; [`UNASSIGNED`] where it is too thin. One group when there are no
/// denser parts.
fn group_sample(
    descriptors: &[Vec<f32>],
    options: &ClusterOptions,
    min_samples: usize,
) -> Result<(Vec<u32>, usize), ClusterError> {
    let found = descriptors.len();
    if found < LEAST_SAMPLE {
        return Err(ClusterError::TooFew { field: "splats", expected: LEAST_SAMPLE, found });
    }
    let least =
        ((options.least_share * found as f64).ceil() as usize).clamp(2 * min_samples, found);
    let parameters = HdbscanHyperParams::builder()
        .min_cluster_size(least)
        .min_samples(min_samples)
        .dist_metric(DistanceMetric::Euclidean)
        .nn_algorithm(NnAlgorithm::BruteForce)
        .build();
    let labels = Hdbscan::new(descriptors, parameters)
        .cluster()
        .map_err(|error| ClusterError::Grouping(error.to_string()))?;
    let count = labels.iter().max().map_or(0, |&highest| (highest + 1).max(0) as usize);
    if count == 0 {
        return Ok((vec![0; found], 1));
    }
    Ok((labels.iter().map(|&label| u32::try_from(label).unwrap_or(UNASSIGNED)).collect(), count))
}

#[cfg(test)]
mod tests;
