//! Instances that were split in parts.

use trapeze_scene::{NO_NEIGHBOUR, Neighbours};

use crate::models::dot;

/// Neighbours that are asked for each splat.
const NEIGHBOURS: usize = 12;

/// When two clusters count as parts of one instance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MergeLimits {
    /// Least cosine of their features.
    pub similarity: f32,
    /// Least overlap: the share of the smaller one's splats that have a splat of the other among
    /// their nearest.
    pub overlap: f32,
}

impl Default for MergeLimits {
    /// Two halves of a solid that is cut by a plane touch with some percent of their splats.
    fn default() -> Self {
        Self { similarity: 0.9, overlap: 0.02 }
    }
}

/// Two clusters that may be one instance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MergeSuggestion {
    /// Labels, the lower first.
    pub labels: (u32, u32),
    /// Cosine of their features.
    pub similarity: f32,
    /// Share of the smaller one's splats that have a splat of the other among their nearest.
    pub overlap: f32,
}

/// Pairs of clusters that look alike and touch, the most alike first. `labels` has one entry per splat,
/// `features` one per label; clusters without a feature are never part of a pair.
///
/// # Panics
/// When there is a label without an entry in `features`.
#[must_use]
pub fn suggest_merges(
    positions: &[[f32; 3]],
    labels: &[u32],
    features: &[Option<&[f32]>],
    limits: MergeLimits,
) -> Vec<MergeSuggestion> {
    let alike = similar_pairs(features, limits.similarity);
    if alike.is_empty() {
        return alike;
    }
    let mut sizes = vec![0_u32; features.len()];
    labels.iter().for_each(|&label| sizes[label as usize] += 1);
    let touching = touches(positions, labels);
    let mut suggestions: Vec<MergeSuggestion> = alike
        .into_iter()
        .map(|pair| {
            let (a, b) = pair.labels;
            let (small, large) =
                if sizes[a as usize] <= sizes[b as usize] { (a, b) } else { (b, a) };
            let count = touching.get(&(small, large)).copied().unwrap_or(0);
            let overlap = count as f32 / sizes[small as usize].max(1) as f32;
            MergeSuggestion { overlap, ..pair }
        })
        .filter(|pair| pair.overlap >= limits.overlap)
        .collect();
    suggestions.sort_by(|a, b| b.similarity.total_cmp(&a.similarity).then(a.labels.cmp(&b.labels)));
    suggestions
}

fn similar_pairs(features: &[Option<&[f32]>], least: f32) -> Vec<MergeSuggestion> {
    let labels = 0..features.len();
    labels
        .clone()
        .flat_map(|a| labels.clone().skip(a + 1).map(move |b| (a, b)))
        .filter_map(|(a, b)| {
            let similarity = dot(features[a]?, features[b]?);
            let labels = (a as u32, b as u32);
            (similarity >= least).then_some(MergeSuggestion { labels, similarity, overlap: 0.0 })
        })
        .collect()
}

/// For (a, b): how many splats of a have one of b among their nearest.
fn touches(positions: &[[f32; 3]], labels: &[u32]) -> std::collections::HashMap<(u32, u32), u32> {
    let neighbours = Neighbours::of(positions, NEIGHBOURS);
    let mut counts = std::collections::HashMap::new();
    let mut others = Vec::with_capacity(NEIGHBOURS);
    for (i, &label) in labels.iter().enumerate() {
        others.clear();
        others.extend(
            neighbours
                .indices(i)
                .iter()
                .filter(|&&index| index != NO_NEIGHBOUR)
                .map(|&index| labels[index as usize])
                .filter(|&other| other != label),
        );
        others.sort_unstable();
        others.dedup();
        for &other in &others {
            *counts.entry((label, other)).or_insert(0) += 1;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three bars of 100 points side by side along x: 0 and 1 touch, 2 is far away.
    fn bars() -> (Vec<[f32; 3]>, Vec<u32>) {
        let mut positions = Vec::new();
        let mut labels = Vec::new();
        for (bar, offset) in [(0_u32, 0.0_f32), (1, 1.0), (2, 50.0)] {
            for i in 0..100_u8 {
                let (x, y) = (f32::from(i % 10) / 10.0, f32::from(i / 10) / 10.0);
                positions.push([x + offset, y, 0.0]);
                labels.push(bar);
            }
        }
        (positions, labels)
    }

    #[test]
    fn parts_that_look_alike_and_touch_are_suggested_and_no_others() {
        let (positions, labels) = bars();
        let (same, other) = ([1.0, 0.0], [0.0, 1.0]);
        let suggest = |features: [Option<&[f32]>; 3]| -> Vec<(u32, u32)> {
            suggest_merges(&positions, &labels, &features, MergeLimits::default())
                .iter()
                .map(|suggestion| suggestion.labels)
                .collect()
        };
        assert_eq!(suggest([Some(&same), Some(&same), Some(&same)]), [(0, 1)]);
        assert!(suggest([Some(&same), Some(&other), Some(&same)]).is_empty());
        assert!(suggest([Some(&same), None, Some(&same)]).is_empty());
    }
}
