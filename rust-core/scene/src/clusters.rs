//! Instance clusters (TRASE): which object each splat belongs to.

use std::collections::HashMap;

use crate::SceneError;
use crate::splats::gather;

/// One instance cluster.
#[derive(Clone, Debug, PartialEq)]
pub struct Cluster {
    /// The number in the file; any 32-bit value.
    pub id: u32,
    /// Display colour, r g b in 0–1.
    pub color: [f32; 3],
    /// A person's name for it, when there is one.
    pub name: Option<String>,
}

/// Cluster membership of every splat.
///
/// Ids in files are arbitrary, so splats refer to clusters by their position in `table`; every
/// per-cluster array in the program (selection, features, masks) is dense and has `table.len()`
/// entries, however large the ids are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clusters {
    /// Per splat: index into `table`.
    pub labels: Vec<u32>,
    /// The clusters, ordered by id.
    pub table: Vec<Cluster>,
}

impl Clusters {
    /// Builds clusters from per-splat ids and colours; a cluster takes the colour of its first splat.
    ///
    /// # Errors
    /// [`SceneError::Length`] when there is not one colour per id.
    pub fn from_ids(ids: &[u32], colors: &[[f32; 3]]) -> Result<Self, SceneError> {
        if ids.len() != colors.len() {
            return Err(SceneError::Length {
                field: "cluster colours",
                expected: ids.len(),
                found: colors.len(),
            });
        }
        let mut first_color: HashMap<u32, [f32; 3]> = HashMap::new();
        for (&id, &color) in ids.iter().zip(colors) {
            first_color.entry(id).or_insert(color);
        }
        let mut table: Vec<Cluster> =
            first_color.into_iter().map(|(id, color)| Cluster { id, color, name: None }).collect();
        table.sort_unstable_by_key(|cluster| cluster.id);
        let label_of: HashMap<u32, u32> =
            table.iter().enumerate().map(|(label, cluster)| (cluster.id, label as u32)).collect();
        Ok(Self { labels: ids.iter().map(|id| label_of[id]).collect(), table })
    }

    /// Position of the cluster with this id in `table`.
    #[must_use]
    pub fn label_of(&self, id: u32) -> Option<u32> {
        self.table.binary_search_by_key(&id, |cluster| cluster.id).ok().map(|i| i as u32)
    }

    /// Splats of each cluster.
    #[must_use]
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.table.len()];
        for &label in &self.labels {
            sizes[label as usize] += 1;
        }
        sizes
    }

    /// The clusters of the splats at `indices`; clusters that lose all their splats leave the table.
    #[must_use]
    pub fn gather(&self, indices: &[u32]) -> Self {
        let labels = gather(&self.labels, indices);
        let mut used = vec![false; self.table.len()];
        for &label in &labels {
            used[label as usize] = true;
        }
        let mut new_label = vec![0; self.table.len()];
        let mut table = Vec::new();
        for (old, cluster) in self.table.iter().enumerate().filter(|&(old, _)| used[old]) {
            new_label[old] = table.len() as u32;
            table.push(cluster.clone());
        }
        Self { labels: labels.into_iter().map(|label| new_label[label as usize]).collect(), table }
    }

    /// A display colour for the n-th cluster: golden-angle steps of hue, two levels of lightness.
    #[must_use]
    pub fn palette(n: u32) -> [f32; 3] {
        let hue = (f64::from(n) * 0.618_033_988_749_895).fract();
        let (saturation, value) = if n.is_multiple_of(2) { (0.65, 0.95) } else { (0.8, 0.75) };
        let channel = |offset: f64| {
            let k = (offset + hue * 6.0) % 6.0;
            (value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0)) as f32
        };
        [channel(5.0), channel(3.0), channel(1.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sparse_ids_become_dense_labels() {
        let ids = [4_000_000_000, 7, 7, 0];
        let colors = [[0.1; 3], [0.2; 3], [0.9; 3], [0.3; 3]];
        let clusters = Clusters::from_ids(&ids, &colors).unwrap();
        assert_eq!(clusters.labels, [2, 1, 1, 0]);
        assert_eq!(clusters.table[1].color, [0.2; 3], "the first splat's colour");
        assert_eq!(clusters.label_of(4_000_000_000), Some(2));
        assert_eq!(clusters.label_of(1), None);
        assert_eq!(clusters.sizes(), [1, 2, 1]);
    }

    #[test]
    fn gathering_drops_clusters_that_became_empty() {
        let clusters = Clusters::from_ids(&[1, 5, 9], &[[0.0; 3]; 3]).unwrap();
        let kept = clusters.gather(&[2, 0]);
        assert_eq!(kept.table.iter().map(|c| c.id).collect::<Vec<_>>(), [1, 9]);
        assert_eq!(kept.labels, [1, 0]);
    }

    #[test]
    fn palette_colours_are_valid_and_neighbours_differ() {
        for n in 0..1000 {
            let (a, b) = (Clusters::palette(n), Clusters::palette(n + 1));
            assert!(a.iter().all(|c| (0.0..=1.0).contains(c)), "{a:?}");
            let distance: f32 = a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum();
            assert!(distance > 0.2, "{n}: {a:?} {b:?}");
        }
    }
}
