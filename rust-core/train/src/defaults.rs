//! Settings that follow from a dataset and a machine, where nobody states them.

use trapeze_formats::ReadError;
use trapeze_formats::dataset::{Dataset, load_image};
use trapeze_scene::ShDegree;

use crate::TrainingState;
use crate::config::Background;

/// The most splats that a search tries, if the memory allows.
const CEILING: u64 = 2_000_000;
/// Share of the memory that the state of the splats may take; the rest is for photographs and
/// working memory.
const STATE_SHARE: u64 = 8;

/// Up to how many splats a search may go in `memory` bytes.
#[must_use]
pub fn splat_ceiling(memory: u64, sh_degree: ShDegree) -> u32 {
    let fitting = memory / STATE_SHARE / TrainingState::bytes(1, sh_degree);
    // In powers of two: the same on machines that differ by a few megabytes.
    let power = fitting.max(1).ilog2();
    (1u64 << power).min(CEILING) as u32
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
    fn the_ceiling_grows_with_the_memory_up_to_what_is_ever_tried() {
        let at = |memory| splat_ceiling(memory, ShDegree::Three);
        assert_eq!(at(0), 1);
        assert!(at(1 << 30).is_power_of_two());
        assert_eq!(at(1 << 31), 2 * at(1 << 30));
        assert_eq!(at(u64::MAX), 2_000_000);
        assert!(splat_ceiling(1 << 30, ShDegree::Zero) > at(1 << 30));
    }
}
