//! The state before the first step.

use trapeze_formats::dataset::Dataset;
use trapeze_scene::{Camera, Splats};

use super::TrainError;
use crate::config::TrainingConfig;
use crate::initialise::{random_points, splats_from_points, viewed_volume};
use crate::random::{Purpose, Stream};

/// Splats in the places of the dataset's points, at most the cap of the run; without points, at
/// random in what the cameras see.
pub(super) fn initial_splats(
    dataset: &Dataset,
    cameras: &[Camera],
    config: &TrainingConfig,
    extent: f64,
) -> Result<Splats, TrainError> {
    let cap = config.densification.map_or(u32::MAX, |densification| densification.max_splats);
    let (positions, colors) = match &dataset.points {
        Some(points) if !points.is_empty() => {
            let kept = chosen(points.len() as u32, cap, config.seed);
            let color = |i: &u32| points.colors[*i as usize].map(|c| f32::from(c) / 255.0);
            let positions = kept.iter().map(|&i| points.positions[i as usize]).collect();
            (positions, kept.iter().map(color).collect())
        }
        _ => {
            let volume = viewed_volume(cameras)
                .ok_or_else(|| TrainError::dataset("training views", "at least one", "none"))?;
            random_points(&volume, config.initial.random_count.min(cap), config.seed)
        }
    };
    let splats = splats_from_points(&positions, &colors, &config.initial, extent);
    if splats.is_empty() {
        return Err(TrainError::dataset("points", "at least one finite position", "none"));
    }
    Ok(splats)
}

/// `cap` of `count` indices, evenly likely, in order.
fn chosen(count: u32, cap: u32, seed: u64) -> Vec<u32> {
    let mut indices: Vec<u32> = (0..count).collect();
    if count > cap {
        let stream = Stream::new(seed, Purpose::Initialisation, 1);
        indices.sort_by_cached_key(|&i| (stream.words(i), i));
        indices.truncate(cap as usize);
        indices.sort_unstable();
    }
    indices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cap_takes_some_of_the_points_and_the_same_each_time() {
        assert_eq!(chosen(4, 9, 1), [0, 1, 2, 3]);
        let some = chosen(1000, 100, 1);
        assert!(some.len() == 100 && some.is_sorted_by(|a, b| a < b));
        assert_eq!(some, chosen(1000, 100, 1));
        assert_ne!(some, chosen(1000, 100, 2));
        // Spread over the whole list: 100 draws in ten bins of mean 10, σ = 3.
        assert!((0..10).all(|bin| some.iter().filter(|&&i| i / 100 == bin).count() < 28));
    }
}
