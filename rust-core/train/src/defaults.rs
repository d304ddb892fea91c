//! Settings that follow from a dataset and a machine, where nobody states them.

use trapeze_formats::ReadError;
use trapeze_formats::dataset::{Dataset, load_image};
use trapeze_scene::ShDegree;

use crate::TrainingState;
use crate::config::{Background, BudgetSearch, DeformationTraining, InitialSplats, TrainingConfig};

/// The most splats that a search tries, if the memory allows.
const CEILING: u64 = 2_000_000;
/// Share of the memory that the state of the splats may take; the rest is for photographs and
/// working memory.
const STATE_SHARE: u64 = 8;

/// The settings of a run of `steps` steps that finds how many splats and bands of up to `sh_degree`
/// the photographs are worth, in `memory` bytes.
///
/// With as many numbers as the photographs have values there are scenes for any photographs at all; what
/// is tried has at most two thirds of those values that a search trains on.
#[must_use]
pub fn search_for_training(
    dataset: &Dataset,
    steps: u32,
    memory: u64,
    sh_degree: ShDegree,
) -> TrainingConfig {
    let values = |index: usize| {
        let camera = &dataset.views[index].camera;
        3 * u64::from(camera.width) * u64::from(camera.height)
    };
    let values: u64 = dataset.training_views().map(values).sum();
    let search = BudgetSearch::default();
    let trained = values - values / u64::from(search.validation);
    let most_numbers = Some(trained / 3 * 2);
    TrainingConfig {
        search: Some(BudgetSearch { most_numbers, ..search }),
        sh_degree: sh_degree as u32,
        ..TrainingConfig::automatic(steps, splat_ceiling(memory, sh_degree))
    }
}

/// Up to how many splats a search may go in `memory` bytes.
fn splat_ceiling(memory: u64, sh_degree: ShDegree) -> u32 {
    let fitting = memory / STATE_SHARE / TrainingState::bytes(1, sh_degree);
    // In powers of two: the same on machines that differ by a few megabytes.
    let power = fitting.max(1).ilog2();
    (1u64 << power).min(CEILING) as u32
}

/// Share of a run in which a scene that moves warms up without time; see [`prepare_for_motion`].
const WARM_UP_SHARE: f64 = 1.0 / 20.0;
/// Share of a run in which the noise of the time fades: 20 000 of 40 000 steps (Yang et al. 2023),
/// which are also the most.
const NOISY_SHARE: f64 = 0.5;
/// Share of a run before anything but the photographs acts on the splats of a scene that moves, and
/// before the first of them moves to another's place.
const UNDISTURBED_SHARE: f64 = 3.0 / 20.0;
/// Share of a run before splats that do not move leave the network: by then it knows what moves.
const REST_SHARE: f64 = 0.5;
/// Adam's β₂ in a scene that moves: it looks back over a hundred steps, not a thousand.
const BETA2_IN_MOTION: f64 = 0.99;
/// Random splats that a scene that moves begins with, at most.
const RANDOM_SPLATS_IN_MOTION: u32 = 15_000;
/// Noise of the time at its first step, by the time between two photographs.
const NOISE_OF_INTERVAL: f64 = 0.1;

/// How a run of `steps` steps trains what moves: `None` where the training views show one moment.
///
/// Photographs with transparency are taken for rendered ones, whose times are exact. The others are
/// frames of a video, each at a time of its own: what the network sees is that time with some noise,
/// so that it cannot learn a pose by heart for each frame.
///
/// # Errors
/// [`ReadError`] when the first photograph cannot be read.
pub fn deformation_for_training(
    dataset: &Dataset,
    steps: u32,
) -> Result<Option<DeformationTraining>, ReadError> {
    let times = distinct_times(dataset);
    let [first, .., last] = times[..] else { return Ok(None) };
    let is_captured = background_for_training(dataset)? != Background::Random;
    let interval = f64::from(last - first) / (times.len() - 1) as f64;
    let default = DeformationTraining::default();
    let share_of_run = |share: f64, most: u32| ((f64::from(steps) * share) as u32).min(most);
    Ok(Some(DeformationTraining {
        warm_up: share_of_run(WARM_UP_SHARE, default.warm_up),
        time_noise: if is_captured { (NOISE_OF_INTERVAL * interval).min(1.0) } else { 0.0 },
        noisy_steps: share_of_run(NOISY_SHARE, default.noisy_steps).max(1),
        rest_from: share_of_run(REST_SHARE, steps),
        undisturbed: share_of_run(UNDISTURBED_SHARE, default.undisturbed),
        ..default
    }))
}

/// Changes the settings of a run into those for a scene that moves.
///
/// Gradients change their size within few steps there, those of the network's first layers a
/// thousandfold when these begin to take part. As long as the second moment lags behind, Adam's steps are
/// up to (1 − β₁)/√(1 − β₂) times the rate: three times with the usual β₂, once with this one.
///
/// What moves is in each place for a short time only. Without time, every splat there turns
/// transparent, and relocation takes it away; with nothing there the network has nothing to move, and
/// nothing brings it back, since new splats come where opaque ones are. So the splats begin
/// everywhere, large and faint (Kerbl et al. 2023), time takes part almost at once, and until each had
/// the chance to be taken along none is relocated, and nothing but the photographs acts on it: under
/// Adam, which looks at the sign of a gradient more than at its size, the pressure on opacities is
/// enough to make a splat vanish that most photographs say nothing about
/// ([`DeformationTraining::undisturbed`]). On a scene of five objects the usual settings lost both
/// balls that bounce through it. And a search grows by a little at a time. The figures are in
/// docs/negative-results.md.
pub fn prepare_for_motion(config: &mut TrainingConfig) {
    config.adam.beta2 = BETA2_IN_MOTION;
    let Some(densification) = &mut config.densification else { return };
    let undisturbed = (f64::from(config.steps) * UNDISTURBED_SHARE) as u32;
    densification.start = densification.start.max(undisturbed);
    let random_count = RANDOM_SPLATS_IN_MOTION.min(densification.max_splats);
    config.initial = InitialSplats { random_count, opacity: 0.1, scale: 1.0 };
    if let Some(search) = &mut config.search {
        search.gradual = true;
    }
}

/// The times of the training views, ascending, each once. Views without a time are at 0.
pub(crate) fn distinct_times(dataset: &Dataset) -> Vec<f32> {
    let times = dataset.training_views().map(|index| dataset.views[index].time.unwrap_or(0.0));
    let mut times: Vec<f32> = times.collect();
    times.sort_unstable_by(f32::total_cmp);
    times.dedup();
    times
}

/// Random where the first photograph has transparency: nothing may stand in for the background;
/// else black.
///
/// # Errors
/// [`ReadError`] when that photograph cannot be read.
pub fn background_for_training(dataset: &Dataset) -> Result<Background, ReadError> {
    let has_alpha = match dataset.training_views().next() {
        Some(index) => load_image(&dataset.views[index])?.has_alpha(),
        None => false,
    };
    Ok(if has_alpha { Background::Random } else { Background::Fixed([0.0; 3]) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_that_moves_begins_everywhere_and_keeps_its_splats_in_place_for_a_while() {
        let mut config = TrainingConfig::growing(20_000, 25_000);
        prepare_for_motion(&mut config);
        config.validate().unwrap();
        assert_eq!(config.densification.unwrap().start, 3_000);
        assert_eq!((config.initial.random_count, config.initial.opacity), (15_000, 0.1));
        assert_eq!(config.adam.beta2, 0.99);
        let mut fixed = TrainingConfig::fixed(20_000);
        prepare_for_motion(&mut fixed);
        let adam = config.adam;
        assert_eq!(fixed, TrainingConfig { adam, ..TrainingConfig::fixed(20_000) });
    }

    #[test]
    fn the_ceiling_grows_with_the_memory_up_to_what_is_ever_tried() {
        let at = |memory| splat_ceiling(memory, ShDegree::Three);
        assert_eq!(at(0), 1);
        assert!(at(1 << 30).is_power_of_two());
        assert_eq!(at(1 << 31), 2 * at(1 << 30));
        assert_eq!(at(u64::MAX), 2_000_000);
        assert!(splat_ceiling(1 << 30, ShDegree::Zero) > at(1 << 30));
    }
}
