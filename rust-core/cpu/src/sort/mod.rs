//! Stage 3: drawing order. View depth ascending, ties by splat index.

use rayon::prelude::*;
use rdst::RadixSort;

use crate::project::{ProjectedSplat, ProjectedSplats};

/// Puts projected splats into drawing order.
///
/// The key is (depth, place in the input) in one 64-bit integer: depths are positive, so their
/// bits order as they do, and no two keys are equal, so the unstable radix sort has one possible
/// result for any number of threads. The input is in the order of the scene, so its places break
/// ties by splat index.
#[derive(Debug, Default)]
pub struct SortStage {
    keys: Vec<u64>,
}

impl SortStage {
    /// Writes the splats of `input` to `sorted`, nearest first.
    pub fn sort(&mut self, input: &ProjectedSplats, sorted: &mut Vec<ProjectedSplat>) {
        self.keys.clear();
        self.keys
            .extend(input.iter().map(|(at, s)| u64::from(s.depth.to_bits()) << 32 | u64::from(at)));
        self.keys.radix_sort_unstable();
        self.order_near_ties(input);
        // Later stages walk the splats in drawing order; moving them now turns those walks into
        // sequential reads.
        self.keys
            .par_iter()
            .with_min_len(4096)
            .map(|&key| *input.at(key as u32))
            .collect_into_vec(sorted);
    }

    /// Orders runs of equal f32 depths by what rounding took from them, then by splat index.
    fn order_near_ties(&mut self, input: &ProjectedSplats) {
        let same_depth = |a: &u64, b: &u64| a >> 32 == b >> 32;
        for run in self.keys.chunk_by_mut(same_depth).filter(|run| run.len() > 1) {
            run.sort_unstable_by(|&a, &b| {
                let low = |key: u64| input.at(key as u32).depth_low;
                low(a).total_cmp(&low(b)).then(a.cmp(&b))
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn orders_by_depth_and_then_by_splat(depths in prop::collection::vec(0.01f32..4.0, 0..3000), step in 0.0f32..0.5) {
            // Rounding depths to a step makes many exact ties.
            let quantised = |d: f32| if step > 0.0 { (d / step).ceil() * step + 0.01 } else { d };
            let input: Vec<_> = (0u32..)
                .zip(&depths)
                .map(|(index, &d)| ProjectedSplat {
                    depth: quantised(d),
                    depth_low: (index % 3) as f32 * 1e-9 - 1e-9,
                    index,
                    ..Default::default()
                })
                .collect();
            let mut projected = ProjectedSplats::default();
            // Every third place is left out.
            projected.fill(input.len() * 3 / 2 + 1, |i| input.get(i / 3 * 2 + i % 3).copied().filter(|_| i % 3 < 2));
            let mut sorted = Vec::new();
            SortStage::default().sort(&projected, &mut sorted);
            let mut expected = input.clone();
            expected.sort_by(|a, b| {
                let low = a.depth_low.total_cmp(&b.depth_low);
                a.depth.total_cmp(&b.depth).then(low).then(a.index.cmp(&b.index))
            });
            prop_assert_eq!(sorted, expected);
        }
    }
}
