//! Everything that training changes: what a checkpoint holds and a backend keeps resident.

use trapeze_scene::deformation::RestingSplats;
use trapeze_scene::{SceneError, ShDegree, Splats};

use crate::TrainedNetwork;
use crate::parameters::zeros_like;

/// The splats under training, and the network that moves them, with the state of their optimiser.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrainingState {
    /// Steps that have been taken.
    pub step: u32,
    /// The parameters.
    pub splats: Splats,
    /// Adam's running mean of the gradient, per parameter.
    pub first_moments: Splats,
    /// Adam's running mean of the squared gradient, per parameter.
    pub second_moments: Splats,
    /// What moves the splats in time; `None` in a static scene.
    pub network: Option<TrainedNetwork>,
    /// Which splats the network moves; `None` is all of them. See [`crate::rest`].
    pub resting: Option<RestingSplats>,
}

impl TrainingState {
    /// A state before the first step.
    #[must_use]
    pub fn new(splats: Splats) -> Self {
        let zeros = zeros_like(&splats);
        Self {
            step: 0,
            splats,
            first_moments: zeros.clone(),
            second_moments: zeros,
            network: None,
            resting: None,
        }
    }

    /// Adds the SH bands up to `degree`, zero and at rest. A lower degree changes nothing.
    pub fn raise_sh_degree(&mut self, degree: ShDegree) {
        if degree > self.splats.sh_degree {
            for part in [&mut self.splats, &mut self.first_moments, &mut self.second_moments] {
                *part = std::mem::take(part).with_sh_degree(degree);
            }
        }
    }

    /// Checks that the moments belong to the splats.
    ///
    /// # Errors
    /// [`SceneError`] names the first array of another length.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.splats.validate()?;
        for moments in [&self.first_moments, &self.second_moments] {
            moments.validate()?;
            let (expected, found) = (self.splats.len(), moments.len());
            if found != expected {
                return Err(SceneError::Length { field: "moments", expected, found });
            }
            let (expected, found) = (self.splats.sh_rest.len(), moments.sh_rest.len());
            if found != expected {
                return Err(SceneError::Length { field: "moments of sh_rest", expected, found });
            }
        }
        if let Some(resting) = &self.resting
            && resting.splats() != self.splats.len()
        {
            let (expected, found) = (self.splats.len(), resting.splats());
            return Err(SceneError::Length { field: "resting splats", expected, found });
        }
        let Some(trained) = &self.network else { return Ok(()) };
        let expected = trained.network.parameter_count();
        for moments in [&trained.first_moments, &trained.second_moments] {
            let found = moments.len();
            if found != expected {
                return Err(SceneError::Length {
                    field: "moments of the network",
                    expected,
                    found,
                });
            }
        }
        Ok(())
    }

    /// Bytes that a number of a splat takes: itself and two moments.
    pub const BYTES_BY_NUMBER: u64 = 3 * 4;

    /// Bytes that a state of `splats` splats takes, gradients not counted.
    #[must_use]
    pub fn bytes(splats: u64, degree: ShDegree) -> u64 {
        splats * numbers_of_splat(degree) * Self::BYTES_BY_NUMBER
    }
}

/// Numbers that describe a splat: position, scales, rotation, opacity and colour.
pub(crate) fn numbers_of_splat(degree: ShDegree) -> u64 {
    14 + 3 * degree.rest_coefficients() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::tests::random_splats;

    #[test]
    fn a_raised_degree_leaves_lower_bands_and_their_moments() {
        let mut state = TrainingState::new(random_splats(1, 6, ShDegree::One));
        state.first_moments.sh_rest.fill(0.5);
        let before = state.clone();
        state.raise_sh_degree(ShDegree::Three);
        state.validate().unwrap();
        assert_eq!(&state.first_moments.sh_rest_of(3)[..9], before.first_moments.sh_rest_of(3));
        assert!(state.splats.sh_rest_of(3)[9..].iter().all(|&c| c == 0.0));
        assert_eq!(state.splats.clone().with_sh_degree(ShDegree::One), before.splats);
        state.raise_sh_degree(ShDegree::Zero);
        assert_eq!(state.splats.sh_degree, ShDegree::Three);
    }

    #[test]
    fn moments_of_other_splats_are_refused() {
        let mut state = TrainingState::new(random_splats(1, 6, ShDegree::Zero));
        state.second_moments = zeros_like(&random_splats(1, 5, ShDegree::Zero));
        assert!(state.validate().unwrap_err().to_string().contains("moments"));
    }
}
