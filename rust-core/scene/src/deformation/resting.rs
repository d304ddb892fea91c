//! Splats that a network need not be asked about.

use crate::SceneError;

/// What a network gives a splat: displacement (x y z, world units), addition to the unit quaternion
/// (w x y z), addition to the standard deviations (x y z, world units).
pub type DeformationOutputs = [f32; 10];

/// Which splats a network moves, and what the others keep of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestingSplats {
    moving: Vec<u32>,
    held: Vec<DeformationOutputs>,
}

impl RestingSplats {
    /// `moving`: the splats that move, ascending; `held`: the outputs that each of the others keeps,
    /// ascending by splat.
    ///
    /// # Errors
    /// [`SceneError::Length`] when the indices are not ascending or name a splat that is not there.
    pub fn new(moving: Vec<u32>, held: Vec<DeformationOutputs>) -> Result<Self, SceneError> {
        let splats = moving.len() + held.len();
        let ascending = moving.windows(2).all(|pair| pair[0] < pair[1]);
        let inside = moving.last().is_none_or(|&last| (last as usize) < splats);
        if !(ascending && inside) {
            let found = moving.last().map_or(0, |&last| last as usize + 1);
            return Err(SceneError::Length { field: "moving splats", expected: splats, found });
        }
        Ok(Self { moving, held })
    }

    /// The splats that move, ascending.
    #[must_use]
    pub fn moving(&self) -> &[u32] {
        &self.moving
    }

    /// The outputs that the others keep, in the order of [`resting`](Self::resting).
    #[must_use]
    pub fn held(&self) -> &[DeformationOutputs] {
        &self.held
    }

    /// Number of splats, moving and resting.
    #[must_use]
    pub fn splats(&self) -> usize {
        self.moving.len() + self.held.len()
    }

    /// The splats that rest, ascending.
    pub fn resting(&self) -> impl Iterator<Item = u32> {
        let mut moving = self.moving.iter().copied().peekable();
        (0..self.splats() as u32).filter(move |&i| moving.next_if_eq(&i).is_none())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_does_not_move_rests() {
        let resting = RestingSplats::new(vec![1, 4], vec![[0.0; 10]; 3]).unwrap();
        assert_eq!(resting.resting().collect::<Vec<_>>(), [0, 2, 3]);
        assert_eq!((resting.splats(), resting.moving()), (5, &[1, 4][..]));
        let all = RestingSplats::new(Vec::new(), vec![[0.0; 10]; 2]).unwrap();
        assert_eq!(all.resting().collect::<Vec<_>>(), [0, 1]);
        assert_eq!(RestingSplats::default().resting().count(), 0);
    }

    #[test]
    fn indices_out_of_order_or_range_are_refused() {
        for moving in [vec![4, 1], vec![1, 1], vec![1, 5]] {
            let error = RestingSplats::new(moving, vec![[0.0; 10]; 3]).unwrap_err();
            assert!(error.to_string().starts_with("moving splats: expected 5"), "{error}");
        }
    }
}
