//! How a scene is kept on the GPU.

use trapeze_scene::ShDegree;

use crate::{HarmonicsStorage, NetworkPrecision};

/// How a scene is kept on the GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RendererOptions {
    /// Storage of SH coefficients.
    pub harmonics: HarmonicsStorage,
    /// Highest SH band to keep.
    pub max_sh_degree: ShDegree,
    /// Arithmetic of the deformation network.
    pub precision: NetworkPrecision,
    /// Tile entries to make room for at first; the buffers grow when a frame needs more.
    pub initial_entries: Option<u32>,
    /// Tile entries to make room for at most, when fewer than the device allows; frames that need
    /// more are drawn in regions.
    pub max_entries: Option<u32>,
    /// Splats to keep when the scene has more: those that contribute most.
    pub max_splats: Option<u32>,
}

impl Default for RendererOptions {
    fn default() -> Self {
        Self {
            harmonics: HarmonicsStorage::default(),
            max_sh_degree: ShDegree::Three,
            precision: NetworkPrecision::default(),
            initial_entries: None,
            max_entries: None,
            max_splats: None,
        }
    }
}
