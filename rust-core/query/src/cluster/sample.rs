//! A sample that is the same for the same scene.

/// At most `count` of the indices `0..n` for which `usable` holds, ascending: one from each of `count`
/// runs of equal length, so that a file that is sorted by object is sampled evenly.
pub(super) fn stratified(n: usize, count: usize, usable: impl Fn(usize) -> bool) -> Vec<usize> {
    let candidates: Vec<usize> = (0..n).filter(|&i| usable(i)).collect();
    let (all, count) = (candidates.len(), count.min(candidates.len()));
    (0..count)
        .map(|run| {
            let (start, end) = (run * all / count, (run + 1) * all / count);
            candidates[start + (scrambled(run as u64) % (end - start) as u64) as usize]
        })
        .collect()
}

/// A number without visible order (the finaliser of SplitMix64, Steele et al. 2014).
fn scrambled(i: u64) -> u64 {
    let mut z = i.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_covers_the_range_and_leaves_out_what_is_not_usable() {
        let sample = stratified(1000, 50, |i| i % 2 == 0);
        assert_eq!(sample.len(), 50);
        assert!(sample.iter().all(|i| i % 2 == 0) && sample.is_sorted());
        assert!(sample[0] < 20 && sample[49] >= 980);
        assert_eq!(stratified(3, 50, |_| true), [0, 1, 2]);
        assert!(stratified(0, 5, |_| true).is_empty());
    }
}
