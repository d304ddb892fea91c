//! Removal of floaters: splats, or small groups of them, that hang far away from everything else.

use crate::Scene;
use crate::bounds::is_finite;
use crate::neighbours::{NO_NEIGHBOUR, Neighbours};

/// What counts as a floater.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloaterRule {
    /// Neighbours over which the distance is averaged.
    pub neighbours: usize,
    /// Standard deviations above the mean from which on a splat is isolated.
    pub sigmas: f64,
    /// Groups of fewer splats that are isolated together are floaters as well.
    pub smallest_group: usize,
}

impl Default for FloaterRule {
    /// The usual choice for point clouds (16 to 50 neighbours, 2 to 3 σ), on the careful side.
    fn default() -> Self {
        Self { neighbours: 16, sigmas: 3.0, smallest_group: 12 }
    }
}

/// The splats that are not floaters.
///
/// Statistical outlier removal (Rusu et al. 2008, "Towards 3D point cloud based object maps")
/// compares each splat's mean distance to its neighbours with those of all. It does so here on the
/// logarithms of the distances: the spacing of splats covers decades, and one splat at 10⁹ would
/// raise the plain standard deviation above every other floater. Then groups that are connected
/// by distances below the same threshold leave when they are smaller than `smallest_group`.
/// Centres that are not finite leave always.
#[must_use]
pub fn without_floaters(scene: &Scene, rule: &FloaterRule) -> Vec<u32> {
    let positions = &scene.splats.positions;
    let neighbours = Neighbours::of(positions, rule.neighbours.max(1));
    let means: Vec<Option<f64>> =
        (0..positions.len()).map(|i| neighbours.mean_distance(i)).collect();
    let threshold = isolation_threshold(&means, rule.sigmas);
    let near = |i: usize| means[i].is_some_and(|mean| mean <= threshold);
    let sizes = group_sizes(&neighbours, positions.len(), |i, distance| {
        near(i) && f64::from(distance) <= threshold
    });
    // Too few splats to say what is usual: nothing is isolated in a scene of one group.
    let smallest = rule.smallest_group.min(positions.len());
    (0..positions.len())
        .filter(|&i| {
            is_finite(&positions[i]) && (positions.len() == 1 || near(i)) && sizes[i] >= smallest
        })
        .map(|i| i as u32)
        .collect()
}

/// A splat less than twice as far from its neighbours as is usual is not isolated, however evenly
/// the others are spaced: the corners of a lattice are its outliers, but no floaters.
const LEAST_RATIO: f64 = 2.0;

/// exp(mean + c·σ) of the logarithms. Distances of 0 (identical splats) have no logarithm and say
/// nothing about the spacing.
fn isolation_threshold(means: &[Option<f64>], sigmas: f64) -> f64 {
    let logs: Vec<f64> = means
        .iter()
        .flatten()
        .filter(|&&mean| mean > 0.0 && mean.is_finite())
        .map(|d| d.ln())
        .collect();
    if logs.is_empty() {
        return f64::INFINITY;
    }
    let count = logs.len() as f64;
    let mean = logs.iter().sum::<f64>() / count;
    let variance = logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / count;
    (mean + (sigmas * variance.sqrt()).max(LEAST_RATIO.ln())).exp()
}

/// For every splat, how many are connected to it through neighbours that `linked` accepts.
fn group_sizes(
    neighbours: &Neighbours,
    n: usize,
    linked: impl Fn(usize, f32) -> bool,
) -> Vec<usize> {
    let mut parents: Vec<u32> = (0..n as u32).collect();
    for i in 0..n {
        for (&j, &distance) in neighbours.indices(i).iter().zip(neighbours.distances(i)) {
            if j != NO_NEIGHBOUR && linked(i, distance) {
                let (a, b) = (root(&mut parents, i as u32), root(&mut parents, j));
                parents[a.max(b) as usize] = a.min(b);
            }
        }
    }
    let roots: Vec<u32> = (0..n as u32).map(|i| root(&mut parents, i)).collect();
    let mut sizes = vec![0; n];
    for &root in &roots {
        sizes[root as usize] += 1;
    }
    roots.into_iter().map(|root| sizes[root as usize]).collect()
}

/// The representative of a group, with path halving.
fn root(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        parents[i as usize] = parents[parents[i as usize] as usize];
        i = parents[i as usize];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Splats;

    fn scene(positions: Vec<[f32; 3]>) -> Scene {
        let n = positions.len();
        Scene::from_splats(Splats {
            positions,
            log_scales: vec![[0.0; 3]; n],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; n],
            opacity_logits: vec![0.0; n],
            sh_dc: vec![[0.0; 3]; n],
            ..Splats::default()
        })
    }

    /// A cube of 1000 splats whose spacing varies a little.
    fn cube() -> Vec<[f32; 3]> {
        (0..1000_u32)
            .map(|i| {
                let jitter = (i.wrapping_mul(2_654_435_761) >> 24) as f32 / 2560.0;
                [i % 10, i / 10 % 10, i / 100].map(|c| c as f32 + jitter)
            })
            .collect()
    }

    #[test]
    fn lone_splats_and_small_far_groups_leave_and_the_object_stays() {
        let mut positions = cube();
        positions.push([1e9, 0.0, 0.0]);
        positions.push([40.0, 40.0, 40.0]);
        positions.push([f32::NAN, 0.0, 0.0]);
        positions.extend((0..5).map(|i| [-60.0, i as f32, 0.0]));
        assert_eq!(
            without_floaters(&scene(positions), &FloaterRule::default()),
            (0..1000).collect::<Vec<_>>()
        );
    }

    #[test]
    fn a_second_object_far_away_stays() {
        let mut positions = cube();
        positions.extend(cube().into_iter().map(|p| p.map(|c| c + 500.0)));
        let kept = without_floaters(&scene(positions), &FloaterRule::default());
        assert_eq!(kept.len(), 2000);
    }

    #[test]
    fn tiny_and_degenerate_scenes_are_left_alone() {
        let rule = FloaterRule::default();
        assert!(without_floaters(&scene(vec![]), &rule).is_empty());
        assert_eq!(without_floaters(&scene(vec![[1.0; 3]]), &rule), [0]);
        assert_eq!(without_floaters(&scene(vec![[1.0; 3], [5.0; 3]]), &rule), [0, 1]);
        assert_eq!(without_floaters(&scene(vec![[1.0; 3]; 100]), &rule).len(), 100);
        let lattice = (0..8000).map(|i| [i % 20, i / 20 % 20, i / 400].map(|c| c as f32)).collect();
        assert_eq!(without_floaters(&scene(lattice), &rule).len(), 8000);
    }
}
