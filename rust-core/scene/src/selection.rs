//! Which clusters are shown: a bitset over any number of clusters.

/// A set of cluster labels.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ClusterSet {
    words: Vec<u64>,
}

impl ClusterSet {
    /// Adds a label.
    pub fn insert(&mut self, label: u32) {
        let word = label as usize / 64;
        if word >= self.words.len() {
            self.words.resize(word + 1, 0);
        }
        self.words[word] |= 1 << (label % 64);
    }

    /// Takes a label out.
    pub fn remove(&mut self, label: u32) {
        if let Some(word) = self.words.get_mut(label as usize / 64) {
            *word &= !(1 << (label % 64));
        }
        // Trailing empty words would make equal sets compare unequal.
        while self.words.last() == Some(&0) {
            self.words.pop();
        }
    }

    /// Whether the label is in the set.
    #[must_use]
    pub fn contains(&self, label: u32) -> bool {
        self.words.get(label as usize / 64).is_some_and(|word| word >> (label % 64) & 1 == 1)
    }

    /// Whether the set is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Number of labels in the set.
    #[must_use]
    pub fn len(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The labels, ascending.
    pub fn iter(&self) -> impl Iterator<Item = u32> {
        (0u32..).zip(&self.words).flat_map(|(i, &word)| {
            (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| i * 64 + bit)
        })
    }

    /// The set as 64-bit words, lowest label in the lowest bit, for upload.
    #[must_use]
    pub fn words(&self) -> &[u64] {
        &self.words
    }
}

impl FromIterator<u32> for ClusterSet {
    fn from_iter<I: IntoIterator<Item = u32>>(labels: I) -> Self {
        let mut set = Self::default();
        labels.into_iter().for_each(|label| set.insert(label));
        set
    }
}

/// What a frame shows of the clusters.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// Everything.
    #[default]
    All,
    /// Only these clusters.
    Isolate(ClusterSet),
    /// Everything but these clusters.
    Hide(ClusterSet),
}

impl Selection {
    /// Whether splats of the cluster with this label are drawn.
    #[must_use]
    pub fn shows(&self, label: u32) -> bool {
        match self {
            Self::All => true,
            Self::Isolate(set) => set.contains(label),
            Self::Hide(set) => !set.contains(label),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn behaves_like_a_set(operations in prop::collection::vec((any::<bool>(), 0u32..5000), 0..200)) {
            let mut set = ClusterSet::default();
            let mut model = BTreeSet::new();
            for (insert, label) in operations {
                if insert {
                    set.insert(label);
                    model.insert(label);
                } else {
                    set.remove(label);
                    model.remove(&label);
                }
            }
            prop_assert!(set.iter().eq(model.iter().copied()));
            prop_assert_eq!(set.len(), model.len());
            prop_assert_eq!(set.is_empty(), model.is_empty());
            prop_assert_eq!(&set, &model.iter().copied().collect::<ClusterSet>());
            prop_assert!((0..5000).all(|label| set.contains(label) == model.contains(&label)));
        }
    }

    #[test]
    fn isolate_and_hide_are_complements_beyond_64_clusters() {
        let set: ClusterSet = [3, 64, 1000].into_iter().collect();
        let (isolate, hide) = (Selection::Isolate(set.clone()), Selection::Hide(set));
        for label in 0..2000 {
            assert_ne!(isolate.shows(label), hide.shows(label));
            assert!(Selection::All.shows(label));
        }
    }
}
