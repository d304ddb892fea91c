//! Dead splats move onto living ones, and new splats join them ("3D Gaussian Splatting as Markov
//! Chain Monte Carlo", Kheradmand et al. 2024, §4.3 and §4.4).
//!
//! Both are the same act: a splat of a living place, drawn by opacity, is replaced by several
//! copies that together look like it. No splat is ever removed, so the number of splats after
//! every step is known without looking at them: a backend on the GPU need not be asked.

use trapeze_scene::{Splats, sigmoid};

use super::correction::{logit, relocation_correction};
use super::sampling::{OpacityDistribution, OpacityUnits};
use crate::TrainingState;
use crate::parameters::{ParameterGroup, clear, copy_within, push_copy, push_zero};
use crate::random::{Purpose, Stream};

/// Moves every dead splat onto a living one, drawn by opacity. A splat is dead when its opacity is
/// at most `dead_opacity` or any of its parameters is not finite. The copies share the opacity and
/// scale of [`relocation_correction`]; the optimiser forgets both the moved and the receiving.
///
/// Draw i of the stream of [`Purpose::Relocation`] decides where dead splat i goes. Returns how
/// many moved; none do when none live.
pub fn relocate_dead(state: &mut TrainingState, dead_opacity: f64, seed: u64) -> u32 {
    let living = Living::of(&state.splats, dead_logit(dead_opacity));
    let Some(distribution) = OpacityDistribution::new(living.units()) else { return 0 };
    let dead: Vec<usize> = (0..state.splats.len()).filter(|&i| living.0[i].is_none()).collect();
    let stream = Stream::new(seed, Purpose::Relocation, state.step);
    let hosts: Vec<u32> = dead.iter().map(|&i| distribution.draw(&stream, i as u32)).collect();
    correct_hosts(state, &hosts, dead_opacity);
    for (&to, &from) in dead.iter().zip(&hosts) {
        copy_within(&mut state.splats, from as usize, to);
        forget(state, to);
    }
    dead.len() as u32
}

/// Grows to `count` splats: each new one is a copy of a splat drawn by opacity, with the correction
/// of [`relocation_correction`] for all that share a place. A count that is not larger changes
/// nothing; where nothing is visible, places are drawn evenly, so that the count is always reached.
///
/// Draw i of the stream of [`Purpose::Growth`] decides where the splat that becomes number i goes.
pub fn grow(state: &mut TrainingState, count: u32, dead_opacity: f64, seed: u64) {
    let n = state.splats.len();
    if n == 0 || count as usize <= n {
        return;
    }
    let living = Living::of(&state.splats, f32::MIN);
    let distribution =
        OpacityDistribution::new(living.units()).or_else(|| OpacityDistribution::even(n as u32));
    let Some(distribution) = distribution else { return };
    let stream = Stream::new(seed, Purpose::Growth, state.step);
    let hosts: Vec<u32> = (n as u32..count).map(|i| distribution.draw(&stream, i)).collect();
    correct_hosts(state, &hosts, dead_opacity);
    for &from in &hosts {
        push_copy(&mut state.splats, from as usize);
        push_zero(&mut state.first_moments);
        push_zero(&mut state.second_moments);
    }
}

/// The highest logit that is dead. Whether a splat lives is decided on its logit: a comparison of
/// stored bits, which every backend makes alike.
pub(crate) fn dead_logit(dead_opacity: f64) -> f32 {
    logit(dead_opacity.max(f64::MIN_POSITIVE)) as f32
}

/// The lowest logit that is alive.
pub(crate) fn lowest_logit(dead_opacity: f64) -> f32 {
    dead_logit(dead_opacity).next_up()
}

/// The opacity, in units, of every splat that is alive.
struct Living(Vec<Option<u32>>);

impl Living {
    /// Those whose logit is above `threshold` and whose parameters are all finite.
    fn of(splats: &Splats, threshold: f32) -> Self {
        let mut finite = vec![true; splats.len()];
        for group in ParameterGroup::ALL {
            let values = group.of(splats);
            let width = values.len() / splats.len().max(1);
            if width > 0 {
                for (finite, values) in finite.iter_mut().zip(values.chunks_exact(width)) {
                    *finite &= values.iter().all(|v| v.is_finite());
                }
            }
        }
        let units = OpacityUnits::new();
        let logits = splats.opacity_logits.iter().zip(finite);
        let alive = |(&logit, finite)| (finite && logit > threshold).then(|| units.of(logit));
        Self(logits.map(alive).collect())
    }

    fn units(&self) -> impl ExactSizeIterator<Item = u32> {
        self.0.iter().map(|units| units.unwrap_or(0))
    }
}

/// Gives each distinct host the opacity and scale of one of the copies that will stand there: one
/// for every time it was drawn, and itself. Opacities stay above the one that counts as dead.
fn correct_hosts(state: &mut TrainingState, hosts: &[u32], dead_opacity: f64) {
    let mut sorted = hosts.to_vec();
    sorted.sort_unstable();
    for group in sorted.chunk_by(|a, b| a == b) {
        let host = group[0] as usize;
        let opacity = sigmoid(f64::from(state.splats.opacity_logits[host]));
        let (new_opacity, scale) = relocation_correction(opacity, group.len() as u32 + 1);
        let new_logit = (logit(new_opacity) as f32).max(lowest_logit(dead_opacity));
        state.splats.opacity_logits[host] = new_logit;
        for log_scale in &mut state.splats.log_scales[host] {
            *log_scale = (f64::from(*log_scale) + scale.ln()) as f32;
        }
        forget(state, host);
    }
}

/// The optimiser's memory of a splat belongs to where it was.
fn forget(state: &mut TrainingState, i: usize) {
    clear(&mut state.first_moments, i);
    clear(&mut state.second_moments, i);
}

/// The number of splats after one growth of `share` under a hard `cap`: ⌊(1 + share)·n⌋, never
/// fewer than there are.
#[must_use]
pub fn grown_count(splats: u32, share: f64, cap: u32) -> u32 {
    let grown = (f64::from(splats) * (1.0 + share)).floor();
    (grown.min(f64::from(cap)) as u32).max(splats)
}

#[cfg(test)]
mod tests {
    use trapeze_scene::ShDegree;

    use super::*;
    use crate::parameters::tests::random_splats;

    const DEAD: f64 = 0.005;

    /// 200 splats with moments at every parameter; splats 10, 20, … are dead.
    fn state() -> TrainingState {
        let mut state = TrainingState::new(random_splats(1, 200, ShDegree::One));
        for i in (10..200).step_by(10) {
            state.splats.opacity_logits[i] = -8.0;
        }
        state.first_moments = random_splats(2, 200, ShDegree::One);
        state.second_moments = random_splats(3, 200, ShDegree::One);
        state.step = 700;
        state
    }

    fn opacity(state: &TrainingState, i: usize) -> f64 {
        sigmoid(f64::from(state.splats.opacity_logits[i]))
    }

    fn is_forgotten(state: &TrainingState, i: usize) -> bool {
        let zero = crate::zeros_like(&state.splats.gather(&[0]));
        state.first_moments.gather(&[i as u32]) == zero
            && state.second_moments.gather(&[i as u32]) == zero
    }

    #[test]
    fn every_dead_splat_becomes_a_copy_of_a_living_one() {
        let (mut state, before) = (state(), state());
        assert_eq!(relocate_dead(&mut state, DEAD, 5), 19);
        state.validate().unwrap();
        for i in (10..200).step_by(10) {
            let host = (0..200)
                .find(|&j| j % 10 != 0 && before.splats.positions[j] == state.splats.positions[i])
                .expect("a host among the living");
            let pair = state.splats.gather(&[i as u32, host as u32]);
            assert_eq!(pair.gather(&[0]), pair.gather(&[1]));
            assert!(is_forgotten(&state, i) && is_forgotten(&state, host));
            assert!(opacity(&state, host) < opacity(&before, host));
            assert!(state.splats.log_scales[host][0] < before.splats.log_scales[host][0]);
        }
    }

    #[test]
    fn what_is_not_involved_keeps_its_parameters_and_moments() {
        let (mut state, before) = (state(), state());
        relocate_dead(&mut state, DEAD, 5);
        let untouched: Vec<u32> = (0..200).filter(|&i| !is_forgotten(&state, i as usize)).collect();
        assert!(untouched.len() >= 200 - 2 * 19);
        assert_eq!(state.splats.gather(&untouched), before.splats.gather(&untouched));
        assert_eq!(state.first_moments.gather(&untouched), before.first_moments.gather(&untouched));
    }

    #[test]
    fn a_splat_that_is_not_finite_is_dead_and_is_never_a_host() {
        let mut state = state();
        state.splats.positions[3] = [f32::NAN, 0.0, 0.0];
        state.splats.sh_rest[4 * 9] = f32::INFINITY;
        state.splats.opacity_logits[5] = f32::NAN;
        assert_eq!(relocate_dead(&mut state, DEAD, 5), 19 + 3);
        let finite = |splats: &Splats| {
            ParameterGroup::ALL.iter().all(|group| group.of(splats).iter().all(|v| v.is_finite()))
        };
        assert!(finite(&state.splats));
        state.splats.positions[3] = [f32::NAN, 0.0, 0.0];
        grow(&mut state, 260, DEAD, 5);
        assert!(state.splats.positions[200..].as_flattened().iter().all(|v| v.is_finite()));
    }

    #[test]
    fn growth_appends_copies_at_rest_and_reaches_the_count() {
        let mut state = state();
        grow(&mut state, 260, DEAD, 5);
        state.validate().unwrap();
        assert_eq!(state.splats.len(), 260);
        assert!((200..260).all(|i| is_forgotten(&state, i)));
        grow(&mut state, 100, DEAD, 5);
        assert_eq!(state.splats.len(), 260);
    }

    #[test]
    fn no_copy_is_born_dead() {
        let mut state = state();
        state.splats.opacity_logits.fill(logit(0.0052) as f32);
        grow(&mut state, 2000, DEAD, 1);
        assert!((0..2000).all(|i| opacity(&state, i) > DEAD));
        assert_eq!(relocate_dead(&mut state, DEAD, 1), 0);
    }

    #[test]
    fn with_nothing_alive_nothing_moves_and_growth_still_reaches_its_count() {
        for poison in [f32::NAN, f32::NEG_INFINITY] {
            let mut state = state();
            state.splats.opacity_logits.fill(poison);
            assert_eq!(relocate_dead(&mut state, DEAD, 1), 0);
            grow(&mut state, 210, DEAD, 1);
            assert_eq!(state.splats.len(), 210);
        }
        let mut empty = TrainingState::default();
        assert_eq!(relocate_dead(&mut empty, DEAD, 1), 0);
        grow(&mut empty, 10, DEAD, 1);
        assert!(empty.splats.is_empty());
    }

    #[test]
    fn the_choice_depends_on_seed_and_step_alone() {
        let run = |seed: u64, step: u32| {
            let mut state = TrainingState { step, ..state() };
            relocate_dead(&mut state, DEAD, seed);
            grow(&mut state, 230, DEAD, seed);
            state.splats
        };
        assert_eq!(run(5, 700), run(5, 700));
        assert_ne!(run(5, 700), run(6, 700));
        assert_ne!(run(5, 700), run(5, 800));
    }

    #[test]
    fn growth_is_five_percent_up_to_the_cap() {
        assert_eq!(grown_count(1000, 0.05, 100_000), 1050);
        assert_eq!(grown_count(99_000, 0.05, 100_000), 100_000);
        assert_eq!(grown_count(120_000, 0.05, 100_000), 120_000);
        assert_eq!(grown_count(10, 0.05, 100), 10);
        assert_eq!(grown_count(u32::MAX, 0.05, u32::MAX), u32::MAX);
    }
}
