//! An order of the splats in which neighbours in space are neighbours in memory.

use super::group::GROUP;

/// Subtrees of more splats than this are ordered in parallel.
const PARALLEL_SPLATS: usize = 16_384;

/// Splat indices in the order of a k-d tree whose leaves are groups: each run of [`GROUP`] splats
/// fills a small box. The same positions give the same order on any number of threads.
pub(super) fn spatial_order(positions: &[[f32; 3]]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    split(positions, &mut order);
    order
}

fn split(positions: &[[f32; 3]], order: &mut [u32]) {
    let groups = order.len().div_ceil(GROUP);
    if groups < 2 {
        return;
    }
    let axis = longest_axis(positions, order);
    let middle = groups / 2 * GROUP;
    // Equal coordinates are ordered by index, so that the two sides are always the same sets.
    order.select_nth_unstable_by(middle, |&a, &b| {
        positions[a as usize][axis].total_cmp(&positions[b as usize][axis]).then(a.cmp(&b))
    });
    let (low, high) = order.split_at_mut(middle);
    if low.len() > PARALLEL_SPLATS {
        rayon::join(|| split(positions, low), || split(positions, high));
    } else {
        split(positions, low);
        split(positions, high);
    }
}

/// The axis along which the finite coordinates spread most.
fn longest_axis(positions: &[[f32; 3]], order: &[u32]) -> usize {
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &i in order {
        for (c, &x) in positions[i as usize].iter().enumerate().filter(|(_, x)| x.is_finite()) {
            min[c] = min[c].min(x);
            max[c] = max[c].max(x);
        }
    }
    let extent = |c: usize| max[c] - min[c];
    (1..3).fold(0, |longest, c| if extent(c) > extent(longest) { c } else { longest })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scattered(n: usize) -> Vec<[f32; 3]> {
        (0..n).map(|i| std::array::from_fn(|c| ((i * (7 + 4 * c) * 7919) % 1009) as f32)).collect()
    }

    #[test]
    fn every_splat_appears_once() {
        for n in [0, 1, 7, 8, 9, 1000] {
            let mut positions = scattered(n);
            if n > 8 {
                positions[3] = [f32::NAN; 3];
                positions[5] = [f32::INFINITY, 0.0, f32::NEG_INFINITY];
            }
            let mut order = spatial_order(&positions);
            order.sort_unstable();
            assert!(order.iter().copied().eq(0..n as u32));
        }
    }

    #[test]
    fn groups_are_much_smaller_than_the_scene() {
        let positions = scattered(4096);
        let order = spatial_order(&positions);
        let boxes = order.chunks(GROUP).map(|group| {
            let x = group.iter().map(|&i| positions[i as usize][0]);
            x.clone().fold(f32::MIN, f32::max) - x.fold(f32::MAX, f32::min)
        });
        let mean = boxes.sum::<f32>() / (4096 / GROUP) as f32;
        // 512 boxes in a cube of 1009 units: 126 units wide if all were cubes.
        assert!(mean < 200.0, "{mean}");
    }
}
