//! What a search tries, and what came of it.

use serde::{Deserialize, Serialize};

/// What a trial changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Proposal {
    /// To this many splats.
    Splats(u32),
    /// To this SH degree.
    ShDegree(u32),
}

/// A trial and its evidence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The step from which both branches went.
    pub step: u32,
    /// Steps of each branch.
    pub steps: u32,
    /// Splats at the start.
    pub splats: u32,
    /// SH degree at the start.
    pub sh_degree: u32,
    /// What was tried.
    pub proposal: Proposal,
    /// PSNR of the validation views, dB, of the branch that stayed as it was.
    pub psnr_without: f64,
    /// PSNR of the validation views, dB, of the branch with the change.
    pub psnr_with: f64,
    /// What the change had to bring, dB.
    pub required_gain: f64,
    /// Whether it was kept.
    pub kept: bool,
}

impl Trial {
    /// What the change brought, dB.
    #[must_use]
    pub fn gain(&self) -> f64 {
        self.psnr_with - self.psnr_without
    }

    pub(super) fn is_growth(&self) -> bool {
        matches!(self.proposal, Proposal::Splats(splats) if splats > self.splats)
    }

    pub(super) fn is_thinning(&self) -> bool {
        matches!(self.proposal, Proposal::Splats(splats) if splats < self.splats)
    }

    pub(super) fn is_band(&self) -> bool {
        matches!(self.proposal, Proposal::ShDegree(_))
    }
}
