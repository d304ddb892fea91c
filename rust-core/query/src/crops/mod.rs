//! Pictures of a cluster for the image tower, rendered for that purpose and never taken from a screen.
//!
//! Where a cluster is seen from is chosen by trial: small renders of the whole scene from around it
//! say from which directions most of it shows ([`viewpoints`]). From the best of them it is rendered
//! twice ([`cut`]): alone, and in the whole scene with every pixel that belongs to something else
//! replaced by grey. Both are cut to a square around what is seen.

mod cut;
mod viewpoints;

use std::error::Error;

use glam::DVec3;
use image::RgbImage;
use trapeze_scene::{Camera, Clusters, Frame, FrameSettings};

pub use cut::crops_from;
pub(crate) use viewpoints::choose;
pub use viewpoints::{Viewpoint, choose_viewpoints, extent, moves};

/// Mid grey, what a crop shows where its cluster is not.
pub const BACKGROUND: u8 = 128;

/// A backend that renders the scene that is searched. Frames of one time are asked for one after the
/// other, so that a deformation network is evaluated once for all of them.
pub trait CropRenderer {
    /// Centres of all splats at a time, relative to the scene's origin.
    fn positions(&mut self, time: f32) -> Vec<[f32; 3]>;

    /// One frame.
    ///
    /// # Errors
    /// What the backend says.
    fn render(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Frame, Box<dyn Error + Send + Sync>>;
}

/// How clusters are looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct CropOptions {
    /// Views of a cluster, all times together.
    pub views: usize,
    /// Side of a rendered view in pixels; crops are a little smaller.
    pub size: u32,
    /// Times at which clusters that move are looked at; the others at the first alone.
    pub times: Vec<f32>,
    /// The scene's up direction: clusters are looked at from above the horizon.
    pub up: DVec3,
}

impl Default for CropOptions {
    fn default() -> Self {
        Self { views: 4, size: 256, times: vec![0.0, 1.0 / 3.0, 2.0 / 3.0], up: DVec3::Z }
    }
}

impl CropOptions {
    /// A number that differs between options whose features cannot be mixed.
    #[must_use]
    pub fn key(&self) -> u32 {
        let mut hasher = crc32fast::Hasher::new();
        hasher.update(&(self.views as u64).to_le_bytes());
        hasher.update(&self.size.to_le_bytes());
        self.times.iter().for_each(|time| hasher.update(&time.to_le_bytes()));
        self.up.to_array().iter().for_each(|up| hasher.update(&up.to_le_bytes()));
        hasher.finalize()
    }
}

/// What a crop shows beside its cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CropKind {
    /// Nothing: the cluster's splats were rendered alone.
    Isolated,
    /// What is in front of it: the whole scene was rendered, and pixels of others are grey.
    InContext,
}

/// A picture of a cluster.
#[derive(Clone, Debug)]
pub struct Crop {
    /// The square.
    pub image: RgbImage,
    /// How it was made.
    pub kind: CropKind,
    /// How much its feature counts: the share of the view that the cluster fills, times, in context,
    /// the share of it that nothing hides. 0–1.
    pub weight: f32,
}

/// Labels of splats, as crops need them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Member<'a> {
    pub(crate) clusters: &'a Clusters,
    pub(crate) label: u32,
}

impl Member<'_> {
    /// Whether a pixel whose top contributor is this splat shows the cluster.
    pub(crate) fn owns(&self, splat: u32) -> bool {
        self.clusters.labels.get(splat as usize) == Some(&self.label)
    }
}
