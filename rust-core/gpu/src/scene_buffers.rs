//! A scene on the GPU: what does not change from frame to frame.

use trapeze_scene::{ColorSource, FrameSettings, Scene, Selection, ShDegree};

use crate::activate::canonical_poses;
use crate::harmonics::{self, HarmonicsStorage};
use crate::layout::{Cluster, Pose};
use crate::{Gpu, GpuError};

/// Shown for clusters where the scene has none.
const NO_CLUSTER_COLOR: [f32; 3] = [0.5; 3];
/// Largest value of a colour channel.
const MAX_CHANNEL: f32 = 65_504.0;
/// Percentile of the motion values that is white in the heat map.
const HEAT_PERCENTILE: f32 = 99.0;

/// Splats, harmonics, motion values and clusters.
#[derive(Debug)]
pub(crate) struct SceneBuffers {
    /// Number of splats.
    pub count: u32,
    /// As stored, activated.
    pub canonical_poses: wgpu::Buffer,
    /// SH coefficients.
    pub harmonics: wgpu::Buffer,
    /// Degree in `harmonics`.
    pub sh_degree: ShDegree,
    pub harmonics_storage: HarmonicsStorage,
    /// Motion values, one zero where the scene has none.
    pub motion: wgpu::Buffer,
    pub has_motion: bool,
    /// Colour and visibility of each cluster; one row where the scene has none.
    pub clusters: wgpu::Buffer,
    cluster_rows: Vec<Cluster>,
    has_clusters: bool,
    shown: Selection,
    /// 1 / (motion value that is drawn white).
    pub heat_scale: f32,
}

impl SceneBuffers {
    pub(crate) fn upload(
        gpu: &Gpu,
        scene: &Scene,
        max_degree: ShDegree,
        storage: HarmonicsStorage,
    ) -> Result<Self, GpuError> {
        let sh_degree = scene.splats.used_sh_degree().min(max_degree);
        let cluster_rows = cluster_rows(scene);
        let motion: &[f32] = scene.motion.as_ref().map_or(&[0.0], |m| &m.values);
        Ok(Self {
            count: scene.len() as u32,
            canonical_poses: gpu.storage_of("poses", &canonical_poses(scene))?,
            harmonics: gpu
                .storage_of("harmonics", &harmonics::pack(&scene.splats, sh_degree, storage))?,
            sh_degree,
            harmonics_storage: storage,
            motion: gpu.storage_of("motion values", motion)?,
            has_motion: scene.motion.is_some(),
            clusters: gpu.storage_of("clusters", &cluster_rows)?,
            cluster_rows,
            has_clusters: scene.clusters.is_some(),
            shown: Selection::All,
            heat_scale: heat_scale(scene),
        })
    }

    /// Bytes of one splat in each of the buffers that are bound in windows.
    pub(crate) fn bytes_per_splat(&self) -> WindowedBytes {
        let words = self.harmonics_storage.words(self.sh_degree);
        WindowedBytes { pose: size_of::<Pose>() as u64, harmonics: 4 * words as u64 }
    }

    /// Writes the visibility of the clusters, when it has changed.
    pub(crate) fn select(&mut self, gpu: &Gpu, settings: &FrameSettings) {
        if !self.has_clusters || self.shown == settings.selection {
            return;
        }
        for (label, row) in (0u32..).zip(&mut self.cluster_rows) {
            row.shown = u32::from(settings.selection.shows(label));
        }
        gpu.queue().write_buffer(&self.clusters, 0, bytemuck::cast_slice(&self.cluster_rows));
        self.shown = settings.selection.clone();
    }
}

/// Bytes per splat of the buffers that are bound in windows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindowedBytes {
    pub pose: u64,
    pub harmonics: u64,
}

fn cluster_rows(scene: &Scene) -> Vec<Cluster> {
    let limited = |c: f32| c.max(0.0).min(MAX_CHANNEL);
    match &scene.clusters {
        Some(clusters) if !clusters.table.is_empty() => clusters
            .table
            .iter()
            .map(|cluster| Cluster { color: cluster.color.map(limited), shown: 1 })
            .collect(),
        _ => vec![Cluster { color: NO_CLUSTER_COLOR, shown: 1 }],
    }
}

/// 1 / (motion value that is drawn white).
pub(crate) fn heat_scale(scene: &Scene) -> f32 {
    let value = scene.motion.as_ref().map_or(0.0, |m| m.threshold_at_percentile(HEAT_PERCENTILE));
    if value > 0.0 && value.is_finite() { 1.0 / value } else { 1.0 }
}

/// Number of a colour source in the kernels.
pub(crate) fn color_source_number(source: ColorSource) -> u32 {
    match source {
        ColorSource::SphericalHarmonics => 0,
        ColorSource::Clusters => 1,
        ColorSource::Motion => 2,
        ColorSource::Depth(_) => 3,
    }
}
