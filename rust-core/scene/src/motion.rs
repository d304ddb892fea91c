//! Motion values: how far each splat ever gets from where it starts, and the mask made of them.

use crate::SceneError;

/// How motion values were measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MotionMeasure {
    /// max over ≥ 64 times of max(‖x(t) − x(0)‖, √‖Σ(t) − Σ(0)‖_F), world units: a splat that
    /// only turns or grows also moves.
    #[default]
    PositionAndCovariance,
    /// The original app's: max over 11 times of ‖x(t) − x(0)‖.
    PositionOnly,
    /// Read from a file that does not say.
    Unknown,
}

/// Motion value of every splat. A splat is static ⇔ its value ≤ the threshold of the frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// World units, one per splat, never negative.
    pub values: Vec<f32>,
    /// What was measured.
    pub measure: MotionMeasure,
    /// Share of static splats (0–100) that the scene's maker recommends.
    pub recommended_percentile: Option<f32>,
}

impl Motion {
    /// The threshold at which `percentile` percent of the splats are static: linear interpolation
    /// between the sorted values, as `numpy.percentile` does by default. NaN values count as
    /// moving without bound. No splats give 0.
    /// A percentile outside 0–100 is clamped, NaN counts as 0.
    #[must_use]
    pub fn threshold_at_percentile(&self, percentile: f32) -> f32 {
        let mut sorted: Vec<f32> =
            self.values.iter().map(|&v| if v.is_nan() { f32::INFINITY } else { v }).collect();
        let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
        sorted.sort_unstable_by(f32::total_cmp);
        let share = if percentile.is_nan() { 0.0 } else { f64::from(percentile.clamp(0.0, 100.0)) };
        let rank = share / 100.0 * last as f64;
        let (below, above) = (rank.floor() as usize, rank.ceil() as usize);
        let (low, high) = (f64::from(sorted[below]), f64::from(sorted[above]));
        if below == above { sorted[below] } else { (low + (high - low) * rank.fract()) as f32 }
    }

    /// Indices of the splats that move by more than `threshold`, ascending. NaN values move.
    #[must_use]
    pub fn dynamic_indices(&self, threshold: f32) -> Vec<u32> {
        (0u32..)
            .zip(&self.values)
            .filter(|&(_, &value)| is_dynamic(value, threshold))
            .map(|(i, _)| i)
            .collect()
    }

    /// Checks that there is one value per splat.
    ///
    /// # Errors
    /// [`SceneError::Length`] when there is not.
    pub fn validate(&self, splats: usize) -> Result<(), SceneError> {
        if self.values.len() == splats {
            return Ok(());
        }
        Err(SceneError::Length {
            field: "motion values",
            expected: splats,
            found: self.values.len(),
        })
    }
}

/// Whether a splat with this motion value takes part in a masked frame's network evaluation.
#[must_use]
pub fn is_dynamic(value: f32, threshold: f32) -> bool {
    value.is_nan() || value > threshold
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(values: &[f32]) -> Motion {
        Motion { values: values.to_vec(), ..Motion::default() }
    }

    #[test]
    fn percentile_interpolates_between_sorted_values() {
        let m = motion(&[3.0, 0.0, 1.0, 2.0]);
        assert_eq!(m.threshold_at_percentile(0.0), 0.0);
        assert_eq!(m.threshold_at_percentile(50.0), 1.5);
        assert_eq!(m.threshold_at_percentile(100.0), 3.0);
        assert_eq!(m.threshold_at_percentile(250.0), 3.0);
        assert_eq!(motion(&[]).threshold_at_percentile(50.0), 0.0);
    }

    #[test]
    fn at_the_hundredth_percentile_nothing_moves_and_at_zero_the_ties_rest() {
        let m = motion(&[0.0, 0.0, 0.5, 1.0]);
        assert!(m.dynamic_indices(m.threshold_at_percentile(100.0)).is_empty());
        assert_eq!(m.dynamic_indices(m.threshold_at_percentile(0.0)), [2, 3]);
    }

    #[test]
    fn a_value_that_is_not_a_number_counts_as_moving() {
        let m = motion(&[f32::NAN, 1.0]);
        assert_eq!(m.dynamic_indices(2.0), [0]);
        assert!(m.threshold_at_percentile(100.0).is_infinite());
    }
}
