//! Working memory of the network: the activations of a few neighbouring splats.

/// Splats that go through the network together. Their activations share one list of features that
/// are not zero: the fewer splats, the shorter the list; the more, the more often a weight that
/// was loaded is used. With eight, all sums of two vectors of outputs fit into 32 registers.
pub(super) const GROUP: usize = 8;

/// Features of one block of activations. A feature's index in its block is a `u8`, so that the
/// kernel needs no bounds check; layers of any width are a sequence of blocks, the last padded.
pub(super) const BLOCK: usize = 256;

/// One splat's features of one block.
pub(super) type Row = [f32; BLOCK];

/// One block of features of all splats of a group.
pub(super) type Group = [Row; GROUP];

/// Number of blocks that hold `width` features.
pub(super) const fn blocks(width: usize) -> usize {
    width.div_ceil(BLOCK)
}

/// Copies `values` into rows, padded with zeros.
pub(super) fn to_rows(values: &[f32]) -> Vec<Row> {
    let mut rows = vec![[0.0; BLOCK]; blocks(values.len())];
    for (row, chunk) in rows.iter_mut().zip(values.chunks(BLOCK)) {
        row[..chunk.len()].copy_from_slice(chunk);
    }
    rows
}

/// Indices of the features of one block that are not zero for every splat of the group, ascending.
#[derive(Clone, Debug)]
pub(super) struct Active {
    count: usize,
    features: [u8; BLOCK],
}

impl Active {
    /// The first `count` features.
    fn first(count: usize) -> Self {
        Self { count, features: std::array::from_fn(|i| i as u8) }
    }

    pub(super) fn features(&self) -> &[u8] {
        &self.features[..self.count]
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Appends the features `first + i` for which bit i is set.
    #[inline(always)]
    pub(super) fn push_bits(&mut self, mut bits: u64, first: usize) {
        while bits != 0 {
            self.features[self.count] = (first + bits.trailing_zeros() as usize) as u8;
            self.count += 1;
            bits &= bits - 1;
        }
    }
}

/// Activations of one group.
#[derive(Clone, Debug)]
pub(super) struct Activations {
    /// One per block of features.
    pub(super) rows: Vec<Group>,
    /// The features in use, one list per block.
    pub(super) active: Vec<Active>,
}

impl Activations {
    /// `width` features, all zero and all in use.
    pub(super) fn new(width: usize) -> Self {
        let active = (0..blocks(width)).map(|b| Active::first((width - b * BLOCK).min(BLOCK)));
        Self { rows: vec![[[0.0; BLOCK]; GROUP]; blocks(width)], active: active.collect() }
    }
}
