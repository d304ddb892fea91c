//! What each kernel of the network takes on the GPU.

use std::ops::AddAssign;
use std::time::Duration;

use super::kernels::STAGES;

/// Time of each kernel, all layers together. Dispatches are timed one by one, so what one of them
/// could begin before another has ended is not in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeformationTimes {
    /// γ.
    pub encode: Duration,
    /// Hidden layers forward.
    pub layers: Duration,
    /// Heads, and deformed splats.
    pub apply: Duration,
    /// Splats that rest.
    pub hold: Duration,
    /// Their gradients.
    pub hold_backward: Duration,
    /// Gradients by the outputs.
    pub apply_backward: Duration,
    /// Gradients by weights and biases, in parts.
    pub weights_backward: Duration,
    /// Sums of these parts.
    pub weights_sum: Duration,
    /// Gradients by the layers' inputs.
    pub layers_backward: Duration,
}

impl DeformationTimes {
    pub(super) fn of_stages(times: [Duration; STAGES]) -> Self {
        let [
            encode,
            layers,
            apply,
            hold,
            hold_backward,
            apply_backward,
            weights_backward,
            weights_sum,
            layers_backward,
        ] = times;
        Self {
            encode,
            layers,
            apply,
            hold,
            hold_backward,
            apply_backward,
            weights_backward,
            weights_sum,
            layers_backward,
        }
    }

    /// γ, hidden layers and heads, also where the backward pass evaluates them again.
    #[must_use]
    pub fn forward(&self) -> Duration {
        self.encode + self.layers + self.apply + self.hold
    }

    /// The rest.
    #[must_use]
    pub fn backward(&self) -> Duration {
        let weights = self.weights_backward + self.weights_sum;
        self.apply_backward + self.hold_backward + weights + self.layers_backward
    }

    /// The sum.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.forward() + self.backward()
    }
}

impl AddAssign for DeformationTimes {
    fn add_assign(&mut self, other: Self) {
        self.encode += other.encode;
        self.layers += other.layers;
        self.apply += other.apply;
        self.hold += other.hold;
        self.hold_backward += other.hold_backward;
        self.apply_backward += other.apply_backward;
        self.weights_backward += other.weights_backward;
        self.weights_sum += other.weights_sum;
        self.layers_backward += other.layers_backward;
    }
}
