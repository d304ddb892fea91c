//! How far two groupings of the same splats agree.

use std::collections::HashMap;

/// The adjusted Rand index (Hubert & Arabie 1985): 1 for the same grouping under any names, about 0 for
/// unrelated ones.
///
/// # Panics
/// When there is not one label each.
#[must_use]
pub fn adjusted_rand_index(a: &[u32], b: &[u32]) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = |n: u64| (n as f64) * (n.saturating_sub(1) as f64) / 2.0;
    let mut both: HashMap<(u32, u32), u64> = HashMap::new();
    let (mut first, mut second) = (HashMap::new(), HashMap::new());
    for (&x, &y) in a.iter().zip(b) {
        *both.entry((x, y)).or_default() += 1;
        *first.entry(x).or_insert(0_u64) += 1;
        *second.entry(y).or_insert(0_u64) += 1;
    }
    let sum = |counts: &HashMap<u32, u64>| counts.values().map(|&n| pairs(n)).sum::<f64>();
    let (first, second) = (sum(&first), sum(&second));
    let expected = first * second / pairs(a.len() as u64).max(1.0);
    let (found, most) = (both.values().map(|&n| pairs(n)).sum::<f64>(), 0.5 * (first + second));
    // One group on either side: nothing could disagree.
    if most == expected { 1.0 } else { (found - expected) / (most - expected) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_index_is_one_for_renamed_and_about_zero_for_unrelated_labels() {
        let a: Vec<u32> = (0..1000).map(|i| i % 4).collect();
        let renamed: Vec<u32> = a.iter().map(|label| 9 - label).collect();
        assert_eq!(adjusted_rand_index(&a, &renamed), 1.0);
        let unrelated: Vec<u32> = (0..1000).map(|i| i / 250).collect();
        assert!(adjusted_rand_index(&a, &unrelated).abs() < 0.01);
        assert_eq!(adjusted_rand_index(&[1; 5], &[2; 5]), 1.0);
    }

    #[test]
    fn a_known_case_has_its_known_value() {
        // Pairs together: 6 in a, 3 in b, 2 in both; 6 · 3 / 15 = 1.2 expected, (6 + 3) / 2 at most.
        let index = adjusted_rand_index(&[0, 0, 0, 1, 1, 1], &[0, 0, 1, 1, 2, 2]);
        assert!((index - (2.0 - 1.2) / (4.5 - 1.2)).abs() < 1e-12, "{index}");
    }
}
