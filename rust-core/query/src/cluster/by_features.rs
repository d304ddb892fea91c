//! Clusters from a feature vector per splat.

use rayon::prelude::*;
use trapeze_scene::Features;

use super::sample::stratified;
use super::{ClusterError, ClusterOptions, Grouping, UNASSIGNED, group_sample};
use crate::models::{dot, normalised};
use crate::ranking::{MergeLimits, suggest_merges};

/// Neighbours that make a place dense.
const MIN_SAMPLES: usize = 10;
/// Of the sample's members of a cluster, the share that lies outside the cone that its splats have to be in.
const OUTSIDE_CONE: f64 = 0.01;
/// How much wider than its sample a cone is, as a cosine: the sample does not reach the edge.
const CONE_MARGIN: f32 = 0.05;
/// No cone is wider than this.
const LEAST_COSINE: f32 = 0.5;

/// Groups splats by the direction of their features: a sample by density, its groups' mean directions,
/// and every splat to the nearest of them whose cone it is in. Groups whose directions agree and whose
/// splats touch are one.
///
/// # Errors
/// [`ClusterError`] when there are too few vectors with a direction.
pub fn by_features(
    features: &Features,
    positions: &[[f32; 3]],
    options: &ClusterOptions,
) -> Result<Grouping, ClusterError> {
    let of = |i: usize| &features.values[i * features.dimensions..][..features.dimensions];
    let sample = stratified(positions.len(), options.sample, |i| normalised(of(i)).is_some());
    let directions: Vec<Vec<f32>> = sample.iter().filter_map(|&i| normalised(of(i))).collect();
    let (labels, count) = group_sample(&directions, options, MIN_SAMPLES)?;
    let cones = cones(&directions, &labels, count);
    let groups: Vec<u32> = (0..positions.len())
        .into_par_iter()
        .map(|i| normalised(of(i)).map_or(UNASSIGNED, |direction| nearest(&direction, &cones)))
        .collect();
    Ok(merged(&Grouping::ordered(groups, cones.len()), positions, of))
}

/// A group's mean direction, and the least cosine to it.
struct Cone {
    axis: Vec<f32>,
    least_cosine: f32,
}

fn cones(directions: &[Vec<f32>], labels: &[u32], count: usize) -> Vec<Cone> {
    (0..count as u32)
        .filter_map(|group| {
            let members: Vec<&Vec<f32>> = directions
                .iter()
                .zip(labels)
                .filter(|&(_, &label)| label == group)
                .map(|(direction, _)| direction)
                .collect();
            let axis = mean_direction(members.iter().map(|member| &member[..]))?;
            let mut cosines: Vec<f32> = members.iter().map(|member| dot(&axis, member)).collect();
            cosines.sort_unstable_by(f32::total_cmp);
            let edge = cosines[(cosines.len() as f64 * OUTSIDE_CONE) as usize];
            Some(Cone { axis, least_cosine: (edge - CONE_MARGIN).max(LEAST_COSINE) })
        })
        .collect()
}

fn mean_direction<'a>(directions: impl Iterator<Item = &'a [f32]>) -> Option<Vec<f32>> {
    let mut sum: Vec<f32> = Vec::new();
    for direction in directions {
        sum.resize(direction.len(), 0.0);
        sum.iter_mut().zip(direction).for_each(|(sum, value)| *sum += value);
    }
    normalised(&sum)
}

fn nearest(direction: &[f32], cones: &[Cone]) -> u32 {
    let cosines = cones.iter().map(|cone| dot(&cone.axis, direction));
    (0..)
        .zip(cosines.zip(cones))
        .filter(|(_, (cosine, cone))| *cosine >= cone.least_cosine)
        .max_by(|(_, (a, _)), (_, (b, _))| a.total_cmp(b))
        .map_or(UNASSIGNED, |(group, _)| group)
}

/// Joins groups that are parts of one instance.
pub(super) fn merged<'a>(
    grouping: &Grouping,
    positions: &[[f32; 3]],
    of: impl Fn(usize) -> &'a [f32],
) -> Grouping {
    let count = grouping.count;
    let directions: Vec<Option<Vec<f32>>> = (0..count as u32)
        .map(|group| {
            let members = (0..).zip(&grouping.groups).filter(|&(_, &other)| other == group);
            mean_direction(members.map(|(i, _)| of(i)))
        })
        .collect();
    let mut axes: Vec<Option<&[f32]>> = directions.iter().map(|axis| axis.as_deref()).collect();
    // What is not assigned stands behind the groups, without a direction.
    axes.push(None);
    let labels: Vec<u32> = grouping.groups.iter().map(|&group| group.min(count as u32)).collect();
    let mut root: Vec<u32> = (0..count as u32).collect();
    for pair in suggest_merges(positions, &labels, &axes, MergeLimits::default()) {
        let (a, b) = (root[pair.labels.0 as usize], root[pair.labels.1 as usize]);
        root.iter_mut().filter(|root| **root == b).for_each(|root| *root = a);
    }
    let groups = grouping
        .groups
        .iter()
        .map(|&group| if group == UNASSIGNED { UNASSIGNED } else { root[group as usize] })
        .collect();
    Grouping::ordered(groups, count)
}
