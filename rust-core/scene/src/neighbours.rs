//! Nearest neighbours among points: spacing for initial scales, and isolation for floaters.
//!
//! An exact k-d tree in the implicit form: the points are permuted so that every node is a range
//! split at its middle. Splitting by count keeps the depth at log₂(n / leaf) whatever the points
//! are: a thousand identical ones or one at 10³⁰ cost nothing extra, where a grid would.

use rayon::prelude::*;

use crate::bounds::is_finite;

/// Points in a leaf, which are all looked at.
const LEAF: usize = 16;

/// Ranges longer than this are built on two threads.
const PARALLEL_BUILD: usize = 1 << 14;

/// The k nearest other points of every point.
#[derive(Clone, Debug, PartialEq)]
pub struct Neighbours {
    k: usize,
    distances: Vec<f32>,
    indices: Vec<u32>,
}

/// Index where there is no k-th neighbour.
pub const NO_NEIGHBOUR: u32 = u32::MAX;

impl Neighbours {
    /// Finds the `k` nearest other points of every point. Points that are not finite have no
    /// neighbours and are nobody's; identical points are neighbours at distance 0.
    ///
    /// Runs on rayon's threads; the result does not depend on their number.
    ///
    /// # Panics
    /// When there are 2³² points or more.
    #[must_use]
    pub fn of(points: &[[f32; 3]], k: usize) -> Self {
        assert!(u32::try_from(points.len()).is_ok(), "{} points", points.len());
        let n = points.len();
        let mut found =
            Self { k, distances: vec![f32::INFINITY; n * k], indices: vec![NO_NEIGHBOUR; n * k] };
        if k == 0 {
            return found;
        }
        let tree = Tree::build(points);
        // In the order of the tree, in which points that follow each other share their neighbours.
        let mut rows = vec![Candidate::NONE; tree.points.len() * k];
        rows.par_chunks_mut(k).zip(&tree.points).for_each(|(row, query)| tree.search(query, row));
        for (row, point) in rows.chunks_exact(k).zip(&tree.points) {
            let place = point.index as usize * k;
            for (j, candidate) in row.iter().enumerate() {
                found.distances[place + j] = candidate.squared.sqrt() as f32;
                found.indices[place + j] = candidate.index;
            }
        }
        found
    }

    /// Distances from point `i` to its neighbours, ascending; infinite where there are fewer than k.
    #[must_use]
    pub fn distances(&self, i: usize) -> &[f32] {
        &self.distances[i * self.k..][..self.k]
    }

    /// Indices of the neighbours of point `i`, nearest first; [`NO_NEIGHBOUR`] where there are
    /// fewer than k. Which of equally near ones are among the k is arbitrary, but always the same.
    #[must_use]
    pub fn indices(&self, i: usize) -> &[u32] {
        &self.indices[i * self.k..][..self.k]
    }

    /// Mean distance from point `i` to the neighbours that it has; `None` when it has none.
    #[must_use]
    pub fn mean_distance(&self, i: usize) -> Option<f64> {
        let (count, sum) = self
            .distances(i)
            .iter()
            .zip(self.indices(i))
            .filter(|&(_, &index)| index != NO_NEIGHBOUR)
            .fold((0_u32, 0.0), |(count, sum), (&d, _)| (count + 1, sum + f64::from(d)));
        (count > 0).then(|| sum / f64::from(count))
    }
}

/// Distances from every point to its `k` nearest other points: n × k, ascending in each row,
/// infinite where there are fewer. See [`Neighbours::of`].
#[must_use]
pub fn nearest_neighbour_distances(points: &[[f32; 3]], k: usize) -> Vec<f32> {
    Neighbours::of(points, k).distances
}

#[derive(Clone, Copy)]
struct Point {
    position: [f32; 3],
    index: u32,
}

/// A neighbour that was found. Squared distances are in f64: f32 positions cannot overflow them.
#[derive(Clone, Copy)]
struct Candidate {
    squared: f64,
    index: u32,
}

impl Candidate {
    const NONE: Self = Self { squared: f64::INFINITY, index: NO_NEIGHBOUR };
}

struct Tree {
    points: Vec<Point>,
    /// How each range longer than a leaf is split, at the index of its middle.
    splits: Vec<Split>,
}

/// Points before the middle are not above `value` along `axis`, the others not below.
#[derive(Clone, Copy, Default)]
struct Split {
    value: f32,
    axis: u8,
}

impl Tree {
    fn build(positions: &[[f32; 3]]) -> Self {
        let mut points: Vec<Point> = (0..)
            .zip(positions)
            .filter(|(_, position)| is_finite(position))
            .map(|(index, &position)| Point { position, index })
            .collect();
        let mut splits = vec![Split::default(); points.len()];
        split(&mut points, &mut splits);
        Self { points, splits }
    }

    /// Fills `row`, sorted, with the neighbours nearest to `query`.
    fn search(&self, query: &Point, row: &mut [Candidate]) {
        self.search_range(query, row, 0, self.points.len());
    }

    fn search_range(&self, query: &Point, row: &mut [Candidate], start: usize, end: usize) {
        if end - start <= LEAF {
            for point in &self.points[start..end] {
                if point.index != query.index {
                    let squared = squared_distance(query.position, point.position);
                    insert(row, Candidate { squared, index: point.index });
                }
            }
            return;
        }
        let middle = start.midpoint(end);
        let Split { value, axis } = self.splits[middle];
        let offset = f64::from(query.position[usize::from(axis)]) - f64::from(value);
        let (near, far) = if offset < 0.0 {
            ((start, middle), (middle, end))
        } else {
            ((middle, end), (start, middle))
        };
        self.search_range(query, row, near.0, near.1);
        // Equal distances are not followed: among identical points that would visit all of them.
        if row.last().is_some_and(|worst| offset * offset < worst.squared) {
            self.search_range(query, row, far.0, far.1);
        }
    }
}

/// Arranges the points so that their middle splits the range along its widest axis.
fn split(points: &mut [Point], splits: &mut [Split]) {
    if points.len() <= LEAF {
        return;
    }
    let axis = widest_axis(points);
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |a, b| a.position[axis].total_cmp(&b.position[axis]));
    splits[middle] = Split { value: points[middle].position[axis], axis: axis as u8 };
    let length = points.len();
    let (low, high) = points.split_at_mut(middle);
    // The upper half has more than two points, so its own middle is not this one.
    let (low_splits, high_splits) = splits.split_at_mut(middle);
    if length > PARALLEL_BUILD {
        rayon::join(|| split(low, low_splits), || split(high, high_splits));
    } else {
        split(low, low_splits);
        split(high, high_splits);
    }
}

fn widest_axis(points: &[Point]) -> usize {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for point in points {
        for axis in 0..3 {
            low[axis] = low[axis].min(point.position[axis]);
            high[axis] = high[axis].max(point.position[axis]);
        }
    }
    // In f64, where the difference of two f32 cannot overflow.
    let extent = |axis: usize| f64::from(high[axis]) - f64::from(low[axis]);
    (0..3).max_by(|&a, &b| extent(a).total_cmp(&extent(b))).unwrap_or(0)
}

fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3)
        .map(|axis| {
            let d = f64::from(a[axis]) - f64::from(b[axis]);
            d * d
        })
        .sum()
}

/// Insertion into a short sorted row, the last entry falls out.
fn insert(row: &mut [Candidate], candidate: Candidate) {
    let Some(last) = row.len().checked_sub(1) else { return };
    if candidate.squared >= row[last].squared {
        return;
    }
    let place = row.partition_point(|kept| kept.squared <= candidate.squared);
    row.copy_within(place..last, place + 1);
    row[place] = candidate;
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn brute_force(points: &[[f32; 3]], k: usize) -> Vec<f32> {
        let finite = |p: &[f32; 3]| p.iter().all(|c| c.is_finite());
        let row = |(i, a): (usize, &[f32; 3])| {
            let mut row: Vec<f32> = (0..points.len())
                .filter(|&j| j != i && finite(a) && finite(&points[j]))
                .map(|j| squared_distance(*a, points[j]).sqrt() as f32)
                .collect();
            row.sort_by(f32::total_cmp);
            row.resize(k, f32::INFINITY);
            row
        };
        points.iter().enumerate().flat_map(row).collect()
    }

    /// Coordinates with many ties, and some that no scene should have.
    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            8 => (-4i8..4).prop_map(f32::from),
            8 => -1.0f32..1.0,
            1 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(f32::MAX), Just(-1e30)],
        ]
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_brute_force_finds(
            points in prop::collection::vec(prop::array::uniform3(coordinate()), 0..300),
            k in 0usize..20,
        ) {
            let neighbours = Neighbours::of(&points, k);
            prop_assert_eq!(&neighbours.distances, &brute_force(&points, k));
            for i in 0..points.len() {
                let mut indices = neighbours.indices(i).to_vec();
                indices.retain(|&j| j != NO_NEIGHBOUR);
                for (&j, &distance) in indices.iter().zip(neighbours.distances(i)) {
                    let squared = squared_distance(points[i], points[j as usize]);
                    prop_assert_eq!(squared.sqrt() as f32, distance);
                }
                indices.sort_unstable();
                indices.dedup();
                prop_assert!(!indices.contains(&(i as u32)));
                prop_assert_eq!(
                    indices.len(),
                    neighbours.indices(i).iter().filter(|&&j| j != NO_NEIGHBOUR).count()
                );
            }
        }
    }

    #[test]
    fn identical_points_are_neighbours_at_distance_zero() {
        let neighbours = Neighbours::of(&[[1.5, -2.0, 3.0]; 50_000], 3);
        assert_eq!(neighbours.distances(49_999), [0.0; 3]);
        assert!(!neighbours.indices(7).contains(&7));
    }

    #[test]
    fn a_lattice_has_its_spacing_and_outliers_do_not_disturb_it() {
        let mut points: Vec<[f32; 3]> =
            (0..32_768).map(|i| [i % 32, i / 32 % 32, i / 1024].map(|c| c as f32 * 0.25)).collect();
        points.extend([[1e30, 0.0, 0.0], [f32::NAN; 3], [0.0, -3e38, 3e38]]);
        let neighbours = Neighbours::of(&points, 3);
        assert!((0..32_768).all(|i| neighbours.distances(i) == [0.25; 3]));
        assert_eq!(neighbours.mean_distance(32_769), None);
        assert_eq!(neighbours.mean_distance(0), Some(0.25));
    }

    #[test]
    fn fewer_points_than_neighbours_leave_the_rest_empty() {
        let neighbours = Neighbours::of(&[[0.0; 3], [3.0, 4.0, 0.0]], 3);
        assert_eq!(neighbours.distances(0), [5.0, f32::INFINITY, f32::INFINITY]);
        assert_eq!(neighbours.indices(1), [0, NO_NEIGHBOUR, NO_NEIGHBOUR]);
        assert_eq!(neighbours.mean_distance(0), Some(5.0));
        assert_eq!(Neighbours::of(&[[0.0; 3]], 2).mean_distance(0), None);
        assert!(nearest_neighbour_distances(&[], 3).is_empty());
    }
}
