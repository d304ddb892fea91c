//! Sparse points of a reconstruction.

/// Points with colours, from which training starts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointCloud {
    /// n positions relative to the dataset's origin.
    pub positions: Vec<[f32; 3]>,
    /// n colours in display space.
    pub colors: Vec<[u8; 3]>,
}

impl PointCloud {
    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }
}

/// Points as a file has them: in world coordinates, in double precision.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct WorldPoints {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) colors: Vec<[u8; 3]>,
}

impl WorldPoints {
    /// Makes the points mid grey if all of them are black: COLMAP writes that when it was told not
    /// to extract colours. Whether it did so.
    ///
    /// Black would be the worst start for training: a colour that is clamped at zero has no
    /// gradient.
    pub(super) fn replace_absent_colors(&mut self) -> bool {
        let is_absent = !self.colors.is_empty() && self.colors.iter().all(|c| *c == [0; 3]);
        if is_absent {
            self.colors.fill([128; 3]);
        }
        is_absent
    }
}
