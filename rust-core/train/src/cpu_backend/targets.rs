//! Photographs within a byte budget.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::backend::BackendError;
use crate::loss::TargetImage;

/// The photographs at hand, the latest at the back.
pub(super) struct ResidentTargets {
    budget: usize,
    bytes: usize,
    targets: VecDeque<(u32, Arc<TargetImage>)>,
}

impl ResidentTargets {
    pub(super) fn new(budget: usize) -> Self {
        Self { budget, bytes: 0, targets: VecDeque::new() }
    }

    pub(super) fn get(&self, view: u32) -> Option<&Arc<TargetImage>> {
        self.targets.iter().find(|(id, _)| *id == view).map(|(_, target)| target)
    }

    /// Keeps `target`, and drops the oldest others until it fits.
    pub(super) fn admit(
        &mut self,
        view: u32,
        target: Arc<TargetImage>,
    ) -> Result<(), BackendError> {
        if target.bytes() > self.budget {
            return Err(BackendError::OutOfMemory {
                what: format!("the photograph of view {view}"),
                needed: target.bytes() as u64,
                available: self.budget as u64,
            });
        }
        if let Some(at) = self.targets.iter().position(|(id, _)| *id == view) {
            self.remove(at);
        }
        while self.bytes + target.bytes() > self.budget {
            self.remove(0);
        }
        self.bytes += target.bytes();
        self.targets.push_back((view, target));
        Ok(())
    }

    fn remove(&mut self, at: usize) {
        if let Some((_, target)) = self.targets.remove(at) {
            self.bytes -= target.bytes();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loss::Channels;

    fn target(pixels: u32) -> Arc<TargetImage> {
        let bytes = vec![0; pixels as usize * 3];
        Arc::new(TargetImage::new(pixels, 1, Channels::Rgb, bytes).unwrap())
    }

    #[test]
    fn the_oldest_photographs_make_room_for_new_ones() {
        let mut targets = ResidentTargets::new(29);
        for view in 0..3 {
            targets.admit(view, target(3)).unwrap();
        }
        targets.admit(3, target(4)).unwrap();
        let held: Vec<u32> = (0..4).filter(|&view| targets.get(view).is_some()).collect();
        assert_eq!(held, [2, 3]);
        assert_eq!(targets.bytes, 21);
        targets.admit(2, target(5)).unwrap();
        assert_eq!((targets.bytes, targets.get(2).unwrap().len()), (27, 5));
    }

    #[test]
    fn a_photograph_that_never_fits_is_refused_with_need_and_have() {
        let error = ResidentTargets::new(10).admit(7, target(4)).unwrap_err().to_string();
        assert_eq!(error, "the photograph of view 7: 12 bytes are needed, 10 are available");
    }
}
