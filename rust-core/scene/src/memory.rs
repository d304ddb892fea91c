//! What a scene costs in memory.

use crate::Scene;

/// Bytes that a scene holds, by part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryEstimate {
    /// Positions, scales, rotations, opacities and band 0.
    pub geometry: u64,
    /// SH bands above 0.
    pub sh_rest: u64,
    /// Deformation network weights.
    pub deformation: u64,
    /// Cluster labels and motion values.
    pub labels: u64,
    /// Per-splat features kept from the file.
    pub features: u64,
}

impl MemoryEstimate {
    /// Sum of all parts.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.geometry + self.sh_rest + self.deformation + self.labels + self.features
    }
}

/// Bytes per splat of everything but the higher SH bands: 3 + 3 + 4 + 1 + 3 floats.
pub const GEOMETRY_BYTES_PER_SPLAT: u64 = 56;

impl Scene {
    /// Bytes that the scene's arrays take.
    #[must_use]
    pub fn memory(&self) -> MemoryEstimate {
        let n = self.splats.len() as u64;
        let per_splat = |present: bool| if present { 4 * n } else { 0 };
        MemoryEstimate {
            geometry: n * GEOMETRY_BYTES_PER_SPLAT,
            sh_rest: n * self.splats.sh_rest_stride() as u64 * 4,
            deformation: self.deformation.as_ref().map_or(0, |d| d.parameter_count() as u64 * 4),
            labels: per_splat(self.clusters.is_some()) + per_splat(self.motion.is_some()),
            features: self.features.as_ref().map_or(0, |f| f.values.len() as u64 * 4),
        }
    }
}
