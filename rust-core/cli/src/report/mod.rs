//! The speed-against-error report: what is compared, measured, and how it is shown.

mod engine;
mod markdown;
mod measure;
mod plot;
mod variant;

use serde::{Deserialize, Serialize};

pub(crate) use markdown::markdown;
pub(crate) use measure::{Moment, measure};
pub(crate) use plot::plot;
pub(crate) use variant::{cpu_variants, gpu_variants};

/// The report as it is stored; tables and plots are made of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Report {
    pub(crate) scene: String,
    pub(crate) splats: usize,
    pub(crate) size: [u32; 2],
    pub(crate) views: usize,
    pub(crate) times: Vec<f32>,
    pub(crate) machine: serde_json::Value,
    /// The GPU, where it took part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) device: Option<serde_json::Value>,
    pub(crate) rows: Vec<Row>,
}

/// One variant: what it costs and what it errs.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) variant: String,
    pub(crate) backend: String,
    pub(crate) median_ms: f64,
    pub(crate) p10_ms: f64,
    pub(crate) p90_ms: f64,
    pub(crate) frames: usize,
    /// Times faster than the f64 reference.
    pub(crate) speed_up: f64,
    /// Over all frames together against the reference; absent when equal.
    pub(crate) psnr: Option<f64>,
    pub(crate) max: f64,
    pub(crate) p999: f64,
    /// Splats that the network moved.
    pub(crate) deformed_splats: usize,
    /// Kernel of the network, on the GPU.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) network_kernel: Option<String>,
    /// Bytes on the GPU.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) device_bytes: Option<u64>,
}
