//! Clusters from where splats are, how they move and what colour they have.

use glam::DVec3;
use kdtree::KdTree;
use kdtree::distance::squared_euclidean;
use rayon::prelude::*;
use trapeze_scene::{SH_C0, Scene};

use super::sample::stratified;
use super::{ClusterError, ClusterOptions, Grouping, UNASSIGNED, group_sample};

/// Neighbours that make a place dense.
const MIN_SAMPLES: usize = 5;
/// Weight of the way from the mean place, against the mean place itself: what moves differently is
/// another object, however near.
const MOTION_WEIGHT: f64 = 6.0;
/// Weight of colour in 0–1, against places in extents of the scene.
const COLOR_WEIGHT: f64 = 0.1;
/// Of the sample's nearest places, how many are compared by everything.
const CANDIDATES: usize = 8;
/// Splats further than this from any grouped one, in the space of descriptors, belong to none.
const FAR: f32 = 0.15;
/// Share of the splats at each end of each axis that does not count for the scene's extent.
const TRIM: f64 = 0.02;

/// Groups splats by place, motion and colour. `positions` are those of all splats at some times (one
/// for a scene that does not move); every splat follows the nearest one of a sample.
///
/// Without motion this separates what stands apart, and what touches only by its colour.
///
/// # Errors
/// [`ClusterError`] when there are too few splats with finite positions.
///
/// # Panics
/// When there is no time, or one with another number of splats.
pub fn by_geometry(
    scene: &Scene,
    positions: &[Vec<[f32; 3]>],
    options: &ClusterOptions,
) -> Result<Grouping, ClusterError> {
    assert!(!positions.is_empty() && positions.iter().all(|p| p.len() == scene.len()));
    let space = DescriptorSpace { scene, positions, extent: extent(scene, positions) };
    let sample = stratified(scene.len(), options.sample, |i| space.is_finite(i));
    let descriptors: Vec<Vec<f32>> = sample.iter().map(|&i| space.descriptor(i)).collect();
    let (labels, count) = group_sample(&descriptors, options, MIN_SAMPLES)?;
    let grouped: Vec<Grouped> = descriptors
        .into_iter()
        .zip(labels)
        .filter(|&(_, label)| label != UNASSIGNED)
        .map(|(descriptor, group)| Grouped { descriptor, group })
        .collect();
    let mut tree = KdTree::new(3);
    for (i, sample) in grouped.iter().enumerate() {
        // Only places that are not finite are refused, and the sample has none.
        let added = tree.add([sample.descriptor[0], sample.descriptor[1], sample.descriptor[2]], i);
        added.map_err(|error| ClusterError::Grouping(error.to_string()))?;
    }
    let groups = (0..scene.len())
        .into_par_iter()
        .map(|i| {
            if space.is_finite(i) {
                nearest(&tree, &grouped, &space.descriptor(i))
            } else {
                UNASSIGNED
            }
        })
        .collect();
    Ok(Grouping::ordered(groups, count))
}

/// A splat of the sample that a group took.
struct Grouped {
    descriptor: Vec<f32>,
    group: u32,
}

/// The group of the nearest of the nearest places.
fn nearest(tree: &KdTree<f32, usize, [f32; 3]>, grouped: &[Grouped], descriptor: &[f32]) -> u32 {
    let places = tree.nearest(&descriptor[..3], CANDIDATES, &squared_euclidean).unwrap_or_default();
    let best = places
        .into_iter()
        .map(|(_, &i)| (squared_euclidean(&grouped[i].descriptor, descriptor), grouped[i].group))
        .min_by(|(a, _), (b, _)| a.total_cmp(b));
    best.filter(|(squared, _)| *squared <= FAR * FAR).map_or(UNASSIGNED, |(_, group)| group)
}

/// Makes descriptors: mean place, the way from there at each time, colour; places in extents of the
/// scene.
struct DescriptorSpace<'a> {
    scene: &'a Scene,
    positions: &'a [Vec<[f32; 3]>],
    extent: f64,
}

impl DescriptorSpace<'_> {
    fn is_finite(&self, i: usize) -> bool {
        let color = &self.scene.splats.sh_dc[i];
        self.positions.iter().map(|p| &p[i]).chain([color]).flatten().all(|c| c.is_finite())
    }

    fn descriptor(&self, i: usize) -> Vec<f32> {
        let places = || self.positions.iter().map(|p| DVec3::from(p[i].map(f64::from)));
        let times = self.positions.len() as f64;
        let mean = places().sum::<DVec3>() / times;
        let mut descriptor = Vec::with_capacity(6 + 3 * self.positions.len());
        descriptor.extend((mean / self.extent).as_vec3().to_array());
        let motion_scale = MOTION_WEIGHT / (times.sqrt() * self.extent);
        if self.positions.len() > 1 {
            for place in places() {
                descriptor.extend(((place - mean) * motion_scale).as_vec3().to_array());
            }
        }
        let color = self.scene.splats.sh_dc[i]
            .map(|c| (0.5 + SH_C0 * f64::from(c)).clamp(0.0, 1.0) * COLOR_WEIGHT);
        descriptor.extend(color.map(|c| c as f32));
        descriptor
    }
}

/// Diagonal of the box around the splats at the first time, without the outermost ones.
fn extent(scene: &Scene, positions: &[Vec<[f32; 3]>]) -> f64 {
    let sample = stratified(scene.len(), 20_000, |i| positions[0][i].iter().all(|c| c.is_finite()));
    let Some(last) = sample.len().checked_sub(1) else { return 1.0 };
    let trim = (last as f64 * TRIM) as usize;
    let sides = [0, 1, 2].map(|axis| {
        let mut values: Vec<f32> = sample.iter().map(|&i| positions[0][i][axis]).collect();
        values.sort_unstable_by(f32::total_cmp);
        f64::from(values[last - trim]) - f64::from(values[trim])
    });
    // A scene that is one point has no extent to measure in.
    DVec3::from(sides).length().max(1e-9)
}
