//! A scene: splats and everything that may come with them.

use glam::DVec3;

use crate::splats::gather;
use crate::{Bounds, Clusters, DeformationNetwork, Motion, SceneError, Splats};

/// Per-splat feature vectors kept from the file (TRASE's `gaussian_feats_*`).
#[derive(Clone, Debug, PartialEq)]
pub struct Features {
    /// Length of one vector.
    pub dimensions: usize,
    /// n × `dimensions`, one splat's vector contiguous.
    pub values: Vec<f32>,
}

/// Splats, and what is known about them. Parts that a scene does not have are `None`, and then
/// nothing runs for them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The splats, with `origin` subtracted from their positions.
    pub splats: Splats,
    /// World position of the coordinate zero that `splats` use. Not zero for captures in
    /// geographic coordinates, whose positions would not fit in single precision.
    pub origin: DVec3,
    /// The network that moves the splats; its input are world coordinates (position + origin).
    pub deformation: Option<DeformationNetwork>,
    /// Instance clusters.
    pub clusters: Option<Clusters>,
    /// Motion values.
    pub motion: Option<Motion>,
    /// Feature vectors.
    pub features: Option<Features>,
    /// The splats were trained with the 2-D Mip filter, which this program does not apply.
    pub antialiased: bool,
}

impl Scene {
    /// A static scene with nothing but splats.
    #[must_use]
    pub fn from_splats(splats: Splats) -> Self {
        Self { splats, ..Self::default() }
    }

    /// Number of splats.
    #[must_use]
    pub fn len(&self) -> usize {
        self.splats.len()
    }

    /// Whether there are no splats.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.splats.is_empty()
    }

    /// Checks that every part describes the same splats.
    ///
    /// # Errors
    /// [`SceneError`] names the first part that does not fit.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.splats.validate()?;
        let n = self.len();
        if let Some(clusters) = &self.clusters {
            expect_length("cluster ids", n, clusters.labels.len())?;
            let highest = clusters.labels.iter().copied().max().map_or(0, |l| l as usize + 1);
            if highest > clusters.table.len() {
                return Err(SceneError::Length {
                    field: "cluster table",
                    expected: highest,
                    found: clusters.table.len(),
                });
            }
        }
        if let Some(motion) = &self.motion {
            motion.validate(n)?;
        }
        if let Some(features) = &self.features {
            expect_length("gaussian_feats", n * features.dimensions, features.values.len())?;
        }
        Ok(())
    }

    /// The scene that is left when only the splats at `indices` stay, in that order: every
    /// per-splat part follows, the network stays as it is.
    #[must_use]
    pub fn gather(&self, indices: &[u32]) -> Self {
        Self {
            splats: self.splats.gather(indices),
            origin: self.origin,
            deformation: self.deformation.clone(),
            clusters: self.clusters.as_ref().map(|c| c.gather(indices)),
            motion: self
                .motion
                .as_ref()
                .map(|m| Motion { values: gather(&m.values, indices), ..m.clone() }),
            features: self.features.as_ref().map(|f| Features {
                dimensions: f.dimensions,
                values: indices
                    .iter()
                    .flat_map(|&i| &f.values[i as usize * f.dimensions..][..f.dimensions])
                    .copied()
                    .collect(),
            }),
            antialiased: self.antialiased,
        }
    }

    /// Box around all finite centres, in world coordinates.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        self.splats.bounds().map(|b| self.to_world(b))
    }

    /// Box for auto-framing (far floaters left out), in world coordinates.
    #[must_use]
    pub fn framing_bounds(&self) -> Option<Bounds> {
        self.splats.framing_bounds().map(|b| self.to_world(b))
    }

    fn to_world(&self, bounds: Bounds) -> Bounds {
        Bounds { min: bounds.min + self.origin, max: bounds.max + self.origin }
    }
}

fn expect_length(field: &'static str, expected: usize, found: usize) -> Result<(), SceneError> {
    if expected == found { Ok(()) } else { Err(SceneError::Length { field, expected, found }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Scene {
        let splats = Splats {
            positions: vec![[0.0; 3], [1.0; 3], [2.0; 3]],
            log_scales: vec![[0.0; 3]; 3],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; 3],
            opacity_logits: vec![0.0; 3],
            sh_dc: vec![[0.0; 3]; 3],
            ..Splats::default()
        };
        Scene {
            clusters: Some(Clusters::from_ids(&[1, 2, 1], &[[0.0; 3]; 3]).unwrap()),
            motion: Some(Motion { values: vec![0.0, 0.5, 1.0], ..Motion::default() }),
            features: Some(Features { dimensions: 2, values: vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0] }),
            origin: DVec3::new(10.0, 0.0, 0.0),
            ..Scene::from_splats(splats)
        }
    }

    #[test]
    fn gather_keeps_clusters_motion_and_features_with_their_splats() {
        let kept = scene().gather(&[2, 1]);
        kept.validate().unwrap();
        assert_eq!(kept.motion.unwrap().values, [1.0, 0.5]);
        assert_eq!(kept.features.unwrap().values, [4.0, 5.0, 2.0, 3.0]);
        assert_eq!(kept.clusters.unwrap().labels, [0, 1]);
    }

    #[test]
    fn parts_of_another_length_are_refused_by_name() {
        let mut broken = scene();
        broken.motion.as_mut().unwrap().values.pop();
        assert!(broken.validate().unwrap_err().to_string().contains("motion"));
        let mut broken = scene();
        broken.clusters.as_mut().unwrap().labels.push(0);
        assert!(broken.validate().unwrap_err().to_string().contains("cluster ids"));
        let mut broken = scene();
        broken.features.as_mut().unwrap().values.pop();
        assert!(broken.validate().unwrap_err().to_string().contains("gaussian_feats"));
    }

    #[test]
    fn bounds_are_in_world_coordinates() {
        let bounds = scene().bounds().unwrap();
        assert_eq!(bounds.min.x, 10.0);
        assert_eq!(bounds.max.x, 12.0);
    }
}
