//! Which view a step looks at.

use super::{Purpose, Stream};

/// Shuffled epochs: every view is seen once before any is seen again, in an order that is a
/// function of (seed, epoch), so that a run resumes from its step number alone.
#[derive(Clone, Debug)]
pub struct ViewOrder {
    seed: u64,
    views: u32,
    epoch: u32,
    order: Vec<u32>,
}

impl ViewOrder {
    /// The order over `views` views.
    ///
    /// # Panics
    /// When there are no views: there is nothing to train on, which the caller reports by name.
    #[must_use]
    pub fn new(seed: u64, views: u32) -> Self {
        assert!(views > 0, "a view order needs at least one view");
        Self { seed, views, epoch: 0, order: shuffled(seed, 0, views) }
    }

    /// The view of `step`. Steps may be asked for in any order; consecutive ones are cheap.
    pub fn view(&mut self, step: u32) -> u32 {
        let (epoch, place) = (step / self.views, step % self.views);
        if epoch != self.epoch {
            self.order = shuffled(self.seed, epoch, self.views);
            self.epoch = epoch;
        }
        self.order[place as usize]
    }
}

/// A permutation of 0..views: sorted by a random 64-bit key per view, so each of the orders is
/// equally likely (two keys are equal with probability views²·2⁻⁶⁵; the view number decides then).
fn shuffled(seed: u64, epoch: u32, views: u32) -> Vec<u32> {
    let stream = Stream::new(seed, Purpose::ViewOrder, epoch);
    let mut order: Vec<u32> = (0..views).collect();
    order.sort_by_cached_key(|&view| {
        let [high, low, ..] = stream.words(view);
        (high, low, view)
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_epoch_shows_every_view_once_and_in_another_order() {
        let mut order = ViewOrder::new(5, 17);
        let mut epochs = Vec::new();
        for epoch in 0..20 {
            let seen: Vec<u32> = (0..17).map(|place| order.view(epoch * 17 + place)).collect();
            let mut sorted = seen.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..17));
            epochs.push(seen);
        }
        epochs.sort();
        epochs.dedup();
        assert_eq!(epochs.len(), 20);
    }

    #[test]
    fn a_resumed_run_sees_what_the_uninterrupted_one_sees() {
        let mut whole = ViewOrder::new(9, 23);
        let views: Vec<u32> = (0..200).map(|step| whole.view(step)).collect();
        for start in [0, 1, 22, 23, 100, 199] {
            let mut resumed = ViewOrder::new(9, 23);
            let tail: Vec<u32> = (start..200).map(|step| resumed.view(step)).collect();
            assert_eq!(tail, views[start as usize..]);
        }
    }

    #[test]
    fn all_orders_of_three_views_are_about_equally_likely() {
        let mut counts = std::collections::BTreeMap::new();
        for epoch in 0..6000 {
            *counts.entry(shuffled(1, epoch, 3)).or_insert(0u32) += 1;
        }
        assert_eq!(counts.len(), 6);
        // Binomial(6000, 1/6): σ ≈ 28.9; six σ.
        assert!(counts.values().all(|&c| (827..=1173).contains(&c)), "{counts:?}");
    }
}
